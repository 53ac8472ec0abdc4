# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The demo of two cameras: each object's place and height, with the true ones."""

import math
import os
import time

CAMERAS = 'left', 'right'
CONFIG = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', 'config')
PERIOD_S = 1.0


class TwoCameras:
    """
    Prints what two simulated cameras find out together about objects of unknown heights.

    :param node: The demo's node.
    :param terminal: Where it is printed.
    """

    def __init__(self, node, terminal):
        from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
        from visualization_msgs.msg import MarkerArray
        # Of the simulated cameras' true positions, whatever the calibration is.
        self._true_conversion = CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)
        self._terminal, self._true = terminal, []
        self._place_mm = self._height_mm = 0.0
        self._count, self._printed_at = 0, -math.inf
        node.create_subscription(
            MarkerArray, f'{CAMERAS[0]}/true_objects_in_cam_frame/boxes', self._on_true, 10)
        node.create_subscription(
            MarkerArray, 'objects_in_robot_base_frame/boxes', self._on_boxes, 10)

    @staticmethod
    def nodes():
        """List the nodes: the executable, the parameter file, and the namespace."""
        cameras = [(executable, os.path.join(CONFIG, f'simulated_{name}.yaml'), name)
                   for name in CAMERAS for executable in ('robot_base_publisher',
                                                          'camera_publisher')]
        return [*cameras, ('camera_fusion', None, '')]

    def close(self):
        """Print the largest errors."""
        self._terminal.say(f'{self._count} positions, largest error {self._place_mm:.2f} mm, of '
                           f'the height {self._height_mm:.2f} mm')

    def _on_true(self, message):
        self._true = []
        for marker in boxes_of(message):
            at = marker.pose.position
            x, y, _ = self._true_conversion.convert_point(100 * at.x, 100 * at.y)
            self._true.append((x, y, 100 * marker.scale.z))

    def _on_boxes(self, message):
        now, lines = time.monotonic(), []
        for marker in boxes_of(message) if self._true else ():
            at, height = marker.pose.position, 100 * marker.scale.z
            x, y = 100 * at.x, 100 * at.y
            true = min(self._true, key=lambda one: math.dist(one[:2], (x, y)))
            place_mm, height_mm = 10 * math.dist(true[:2], (x, y)), 10 * abs(height - true[2])
            self._count += 1
            self._place_mm = max(self._place_mm, place_mm)
            self._height_mm = max(self._height_mm, height_mm)
            lines.append(
                f'base ({x:6.2f}, {y:6.2f}) cm  true ({true[0]:6.2f}, {true[1]:6.2f}) cm  error '
                f'{place_mm:.2f} mm;  height {height:.2f} cm  true {true[2]:.2f} cm  error '
                f'{height_mm:.2f} mm')
        if lines and now - self._printed_at >= PERIOD_S:
            self._printed_at = now
            self._terminal.say('\n'.join([*lines, (
                f'==> largest error so far {self._place_mm:.2f} mm, of the height '
                f'{self._height_mm:.2f} mm')]))


def boxes_of(message):
    """Return the boxes of a message."""
    return [marker for marker in message.markers if marker.action == marker.ADD]
