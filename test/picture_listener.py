# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Listens to the camera node, says how many pictures came in some s, and waits to be killed."""

import sys
import time

from geometry_msgs.msg import PointStamped, PoseArray
import rclpy
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Float64MultiArray

SMALL = [(CompressedImage, 'mask/compressed'), (PoseArray, 'objects_in_cam_frame'),
         (PointStamped, 'pos_in_cam_frame/point'), (Float64MultiArray, 'pos_in_cam_frame'),
         (Float64MultiArray, 'true_pos_in_cam_frame'),
         (Float64MultiArray, 'true_objects_in_cam_frame')]


def main():
    """Listen."""
    rclpy.init()
    node, pictures = rclpy.create_node('picture_listener'), []
    node.create_subscription(CompressedImage, 'debug_image/compressed', pictures.append, 1)
    for kind, topic in SMALL:
        node.create_subscription(kind, topic, lambda message: None, 10)
    until = time.monotonic() + float(sys.argv[1])
    while time.monotonic() < until:
        rclpy.spin_once(node, timeout_sec=0.1)
    print(len(pictures), flush=True)
    time.sleep(1000)


if __name__ == '__main__':
    main()
