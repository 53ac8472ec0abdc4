# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A node that forwards each message unchanged, to measure the cost of rclpy itself."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray


class Relay(Node):
    """Subscribes to one topic, and publishes on another."""

    def __init__(self):
        super().__init__('relay')
        publisher = self.create_publisher(Float64MultiArray, 'pos_in_robot_base_frame', 10)
        self.create_subscription(
            Float64MultiArray, 'pos_in_cam_frame', publisher.publish, 10)


if __name__ == '__main__':
    rclpy.init()
    rclpy.spin(Relay())
