# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Node: applies the homogeneous matrix to each position that the camera node publishes."""

from typing import List, Optional

from camera_to_base.errors import CameraToBaseError
from camera_to_base.lifetime import run
from camera_to_base.messages import position_from_message, position_message
from camera_to_base.parameters import NodeParameters
from camera_to_base.transform_parameters import transform_settings, TRANSFORM_SPECS
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import Float64MultiArray


class RobotBasePublisher(Node):
    """Subscribes to positions in the camera frame, publishes them in the base frame."""

    def __init__(self, **node_options) -> None:
        super().__init__('robot_base_publisher', **node_options)
        self._node_parameters = NodeParameters(self, TRANSFORM_SPECS, transform_settings)
        self._dropped_count = 0
        self._publisher = self.create_publisher(
            Float64MultiArray, 'pos_in_robot_base_frame', 10,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        subscription = self.create_subscription(
            Float64MultiArray, 'pos_in_cam_frame', self._on_position, 10,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        self.get_logger().info(
            f'publishing on {self._publisher.topic_name} what comes on {subscription.topic_name}')

    @property
    def dropped_count(self) -> int:
        """How many messages were no position and were dropped."""
        return self._dropped_count

    def _on_position(self, message: Float64MultiArray) -> None:
        try:
            x, y = position_from_message(message)
            base_x, base_y, _ = self._node_parameters.current.convert_surface_point(x, y)
        except CameraToBaseError as error:
            self._drop(error)
        else:
            self._publisher.publish(position_message(base_x, base_y))

    def _drop(self, error: CameraToBaseError) -> None:
        self._dropped_count += 1
        self.get_logger().warning(
            f'dropped a message on the topic pos_in_cam_frame: {error} '
            f'({self._dropped_count} dropped so far)', throttle_duration_sec=5.0)


def main(args: Optional[List[str]] = None) -> int:
    """Run the node until it is told to end."""
    return run('robot_base_publisher', RobotBasePublisher, args)
