# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A textured table, seen by a camera that is nudged: any homography, any lens."""

from bumped_camera import smooth_noise
import cv2
import numpy as np

SIZE = WIDTH, HEIGHT = 480, 360
MARGIN, CM_PER_PX = 40, 0.05
_SHAPE = HEIGHT + 2 * MARGIN, WIDTH + 2 * MARGIN
_CENTRE = (np.array(SIZE) - 1) / 2
RADIUS = float(np.hypot(*SIZE) / 2)


def wood(random):
    """Draw a grain."""
    return 12 * smooth_noise(random, _SHAPE, 9, 2) + 6 * smooth_noise(random, _SHAPE, 20, 8)


def plain(random):
    """Draw nothing."""
    return np.zeros(_SHAPE, np.float32)


def grid(random, period=16):
    """Draw a grid whose squares are all alike."""
    field = np.zeros(_SHAPE, np.float32)
    field[::period] = field[:, ::period] = -60
    return cv2.GaussianBlur(field, (0, 0), 0.8)


def nudge(du=0.0, dv=0.0, turn=0.0, growth=0.0, tilt=(0.0, 0.0)):
    """
    Give the homography of a nudge, shape (3, 3), about the picture's centre.

    :param turn: In px at half of the picture's diagonal, as growth and tilt are.
    """
    warp = np.array([[1 + growth / RADIUS, -turn / RADIUS, du],
                     [turn / RADIUS, 1 + growth / RADIUS, dv],
                     [tilt[0] / RADIUS ** 2, tilt[1] / RADIUS ** 2, 1]])
    centred = np.array([[1, 0, -_CENTRE[0]], [0, 1, -_CENTRE[1]], [0, 0, 1]])
    return np.linalg.inv(centred) @ warp @ centred


class NudgedTable:
    """
    A table and its camera. Places are px of the camera before the nudge, without its lens.

    :param surface: Draws the surface.
    :param coefficient: Of the lens, in the division model.
    """

    def __init__(self, surface=wood, seed=1, coefficient=0.0):
        self._random = np.random.default_rng(seed)
        self._canvas = cv2.merge([150 + surface(self._random).astype(np.float32)] * 3)
        v, u = np.mgrid[:HEIGHT, :WIDTH].astype(float)
        offsets = (np.stack([u, v], axis=2) - _CENTRE) / RADIUS
        scale = 1 + coefficient * (offsets ** 2).sum(axis=2, keepdims=True)
        self._undistorted = (_CENTRE + RADIUS * offsets / scale).reshape(1, -1, 2)

    def shoot(self, matrix=None, coins=(), light=1.0, arm=False):
        """
        Take a picture, shape (360, 480, 3), uint8.

        :param matrix: From the px before the nudge to those after it; None for no nudge.
        :param coins: Their places.
        :param arm: Whether one reaches in from below.
        """
        canvas = self._canvas.copy()
        for at in coins:
            cv2.circle(canvas, [round((x + MARGIN) * 16) for x in at], 15 * 16, (40, 45, 50), -1,
                       cv2.LINE_AA, 4)
        if arm:
            cv2.line(canvas, (200, _SHAPE[0]), (230, 200), (90, 130, 190), 70, cv2.LINE_AA)
        places = self._undistorted if matrix is None else cv2.perspectiveTransform(
            self._undistorted, np.linalg.inv(matrix))
        places = (places + MARGIN).astype(np.float32).reshape(HEIGHT, WIDTH, 2)
        picture = cv2.remap(canvas, places, None, cv2.INTER_CUBIC) * light
        picture += self._random.normal(0, 1.5, picture.shape)
        return np.clip(np.rint(picture), 0, 255).astype(np.uint8)
