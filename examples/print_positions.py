# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Prints where the largest object is, in the base frame: the least that a node of yours needs."""

from geometry_msgs.msg import PointStamped
import rclpy
from rclpy.executors import ExternalShutdownException


def on_point(message):
    point = message.point
    print(f'x {point.x:.3f} m, y {point.y:.3f} m in {message.header.frame_id}', flush=True)


rclpy.init()
node = rclpy.create_node('print_positions')
node.create_subscription(PointStamped, 'pos_in_robot_base_frame/point', on_point, 1)
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
except RuntimeError:  # ended between two waits
    if rclpy.ok():
        raise
