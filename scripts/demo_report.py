# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the demo prints of each position, and its picture."""

import math
import time

import cv2
import numpy as np

# Topics are not synchronised: what belongs to a base position arrives within this time.
SETTLED_S = 0.1
# Why the positions mean nothing on this table, by the reason that the diagnostics give.
DOUBTS = {'not_calibrated': 'NOT CALIBRATED', 'random': 'RANDOM'}


class Report:
    """
    Prints each position in the base frame, with the camera position it came from, in one line.

    :param node: The demo's node.
    :param terminal: Where it is printed.
    :param picture: Path of the annotated picture.

    `errors` has the time of each position and its error in mm, where the truth is known.
    """

    def __init__(self, node, terminal, picture):
        from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
        from diagnostic_msgs.msg import DiagnosticArray
        from geometry_msgs.msg import PointStamped, PoseArray
        from sensor_msgs.msg import Image
        # Of the simulated camera's true positions, whatever the calibration is.
        self._true_conversion = CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)
        self.errors = []
        # By the capture time of their frame, in cm.
        self._camera_positions, self._true_positions = {}, {}
        self._waiting = []
        self._count, self._doubt = 0, None
        self._node, self._terminal, self._picture = node, terminal, picture
        self._picture_saved, self._newest_image = False, None
        for kind, topic, callback in (
                (PointStamped, 'pos_in_cam_frame/point', self._on_camera_position),
                (PoseArray, 'true_objects_in_cam_frame', self._on_true_positions),
                (PointStamped, 'pos_in_robot_base_frame/point', self._on_base_position),
                (DiagnosticArray, '/diagnostics', self._on_diagnostics)):
            node.create_subscription(kind, topic, callback, 100)
        self._for_picture = node.create_subscription(Image, 'debug_image', self._on_image, 1)
        node.create_timer(0.05, self._print_settled)

    def close(self):
        """Print the number of positions, the largest error, and the picture's path."""
        summary = [f'{self._count} positions']
        if self.errors:
            summary.append(f'largest error {max(error for _, error in self.errors):.2f} mm')
        if self._doubt:
            summary.append(f'{self._doubt}: these are not the positions on your table')
        self._terminal.say(', '.join(summary))
        if self._picture_saved:
            self._terminal.say(f'annotated picture: {self._picture}')

    def _on_diagnostics(self, message):
        for status in message.status:
            if status.name.endswith('camera_publisher'):
                reasons = (one.value for one in status.values if one.key == 'reason')
                self._doubt = DOUBTS.get(next(reasons, None))

    def _on_camera_position(self, message):
        remember(self._camera_positions, message, in_cm(message.point))
        self._save_picture()

    def _on_true_positions(self, message):
        remember(self._true_positions, message, [in_cm(pose.position) for pose in message.poses])

    def _on_base_position(self, message):
        self._waiting.append((time.monotonic(), stamp_of(message), in_cm(message.point)))

    def _print_settled(self):
        while self._waiting and time.monotonic() - self._waiting[0][0] > SETTLED_S:
            received_at, stamp, (x, y) = self._waiting.pop(0)
            if stamp in self._camera_positions:
                self._print(received_at, self._camera_positions[stamp], x, y,
                            self._true_positions.get(stamp))

    def _print(self, received_at, camera, x, y, truths):
        self._count += 1
        parts = ['camera ({:6.2f}, {:6.2f}) cm  ->'.format(*camera),
                 f'base ({x:6.2f}, {y:6.2f}) cm']
        if truths:
            in_base = [self._true_conversion.convert_point(*truth)[:2] for truth in truths]
            true = min(in_base, key=lambda point: math.dist(point, (x, y)))
            error_mm = 10 * math.dist((x, y), true)
            self.errors.append((received_at, error_mm))
            parts += ['true ({:6.2f}, {:6.2f}) cm'.format(*true), f'error {error_mm:.2f} mm']
        if self._doubt:
            parts.append(self._doubt)
        self._terminal.update(parts)

    def _on_image(self, message):
        self._newest_image = message
        self._save_picture()

    def _save_picture(self):
        # The first one with a published object; either the image or its position arrives first.
        image = self._newest_image
        if self._picture_saved or image is None or (
                stamp_of(image) not in self._camera_positions):
            return
        picture = np.frombuffer(image.data, np.uint8).reshape(image.height, image.width, 3)
        cv2.imwrite(self._picture, picture)
        self._picture_saved = True
        # The node draws as long as there is a subscriber.
        self._node.destroy_subscription(self._for_picture)


def stamp_of(message):
    """Return the capture time of a message's frame."""
    return message.header.stamp.sec, message.header.stamp.nanosec


def in_cm(point):
    """Return x and y of a point in m."""
    return 100 * point.x, 100 * point.y


def remember(positions, message, position):
    """Keep the newest hundred positions by the capture time of their frame."""
    positions[stamp_of(message)] = position
    if len(positions) > 100:
        del positions[min(positions)]
