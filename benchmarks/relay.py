# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Nodes that do nothing with what they receive, to measure the cost of rclpy itself.

relay.py forwards each message unchanged; relay.py silhouettes receives what `camera_fusion` does,
and publishes as many poses.
"""

import sys

from geometry_msgs.msg import Pose, PoseArray
import rclpy
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from std_msgs.msg import Float64MultiArray, Header
from visualization_msgs.msg import MarkerArray


class Relay(Node):
    """Subscribes to one topic, and publishes on another."""

    def __init__(self):
        super().__init__('relay')
        publisher = self.create_publisher(Float64MultiArray, 'pos_in_robot_base_frame', 10)
        self.create_subscription(
            Float64MultiArray, 'pos_in_cam_frame', publisher.publish, 10)


class SilhouettesRelay(Node):
    """Receives bytes of two cameras, and publishes five poses for each second message."""

    def __init__(self):
        super().__init__('relay')
        self._count, topic = 0, 'objects_in_robot_base_frame'
        self._publisher = self.create_publisher(
            PoseArray, topic, 10, event_callbacks=PublisherEventCallbacks(
                use_default_callbacks=False))
        self._poses = PoseArray(poses=[Pose() for _ in range(5)])
        for camera in ('left', 'right'):
            self.create_subscription(
                MarkerArray, f'{camera}/{topic}/silhouettes', self._on_bytes, 10, raw=True,
                event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False))

    def _on_bytes(self, raw):
        self._count += 1
        if self._count % 2 == 0:
            # The first marker's header follows how many markers there are.
            self._poses.header = deserialize_message(raw[:4] + raw[8:40], Header)
            self._publisher.publish(self._poses)


if __name__ == '__main__':
    rclpy.init()
    rclpy.spin(SilhouettesRelay() if sys.argv[1:] == ['silhouettes'] else Relay())
