# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
A table, and a camera with a lens that is nudged: the renderer of the nudges.

It knows nothing of the correction: its lens and its homographies are its own. The tables, coins
and hands are those of the attack. Places on the table are px of the camera before the nudge,
without its lens; 1 px is 0.5625 mm.
"""

import attack_scenes as scenes
import cv2
import numpy as np

MM_PER_PX = 0.5625
CORNERS = np.array([[0, 0], [scenes.WIDTH, 0], [scenes.WIDTH, scenes.HEIGHT],
                    [0, scenes.HEIGHT]], float)
_KINDS = 'shift', 'shift', 'zoom', 'turn', 'tilt', 'tilt'
MOTIONS = 'mixed', 'slide', *dict.fromkeys(_KINDS)
_CENTRE = (np.array(scenes.SIZE) - 1) / 2
_RADIUS = float(np.hypot(*scenes.SIZE) / 2)


def random_nudge(random, length_px, motion='mixed'):
    """
    Mix shift, turn, zoom and tilt.

    :param length_px: How far the farthest corner moves.
    :param motion: 'mixed', or one of MOTIONS alone; a slide is a shift along a row or a column.
    :returns: A function that gives the homography of a share of the nudge, shape (3, 3).
    """
    shares = random.normal(size=6) * (1, 1, 0.7, 0.7, 0.5, 0.5)
    if motion == 'slide':
        shares[1 - random.integers(2)] = shares[2:] = 0
    elif motion != 'mixed':
        shares[[one != motion for one in _KINDS]] = 0

    def matrix(size):
        du, dv, growth, turn, tilt_u, tilt_v = size * shares
        warp = np.array([[1 + growth / _RADIUS, -turn / _RADIUS, du],
                         [turn / _RADIUS, 1 + growth / _RADIUS, dv],
                         [tilt_u / _RADIUS ** 2, tilt_v / _RADIUS ** 2, 1]])
        centred = np.array([[1, 0, -_CENTRE[0]], [0, 1, -_CENTRE[1]], [0, 0, 1]])
        return np.linalg.inv(centred) @ warp @ centred

    low, high = 0.0, 10 * length_px
    for _ in range(40):
        middle = (low + high) / 2
        far = np.hypot(*(through(matrix(middle), CORNERS) - CORNERS).T).max()
        low, high = (low, middle) if far > length_px else (middle, high)
    return lambda share: matrix(share * low)


def through(matrix, points):
    """Map points of shape (n, 2) by a homography."""
    return cv2.perspectiveTransform(np.asarray(points, float)[None], matrix)[0]


class Camera:
    """
    A camera above a table.

    :param table: See `attack_scenes`.
    :param random: A numpy Generator.
    :param coefficient: Of the lens, in the division model; 0 for none.
    """

    def __init__(self, table, random, coefficient=0.0):
        self.table, self.coefficient = table, coefficient
        self._random = random
        v, u = np.mgrid[:scenes.HEIGHT, :scenes.WIDTH].astype(float)
        offsets = (np.stack([u, v], axis=2) - _CENTRE) / _RADIUS
        scale = 1 + coefficient * (offsets ** 2).sum(axis=2, keepdims=True)
        self._undistorted = (_CENTRE + _RADIUS * offsets / scale).reshape(-1, 2)

    def shoot(self, matrix=None, draw=(), light=1.0):
        """
        Take a picture.

        :param matrix: Homography from the px before the nudge to those after it; None for none.
        """
        canvas = self.table.canvas.copy()
        for function in draw:
            function(canvas)
        places = self._undistorted if matrix is None else through(
            np.linalg.inv(matrix), self._undistorted)
        places = (places + scenes.MARGIN).astype(np.float32).reshape(*scenes.SIZE[::-1], 2)
        return self.table.exposed(cv2.remap(canvas, places, None, cv2.INTER_CUBIC), light)
