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

"""Draws wood and a printed sheet: by how much each point is lighter than the table."""

from typing import Sequence, Tuple

import cv2
import numpy as np

_PLANK_CM, _PLANK_LENGTH_CM, _JOINT_CM = 9.0, 45.0, 0.12
_JOINT_LEVEL = -45.0
_CM2_PER_KNOT, _CM2_PER_FIGURE = 250.0, 12.0
# The rings of a knot, from outside: the share of its radius, and their level.
_KNOT_RINGS = ((1.0, -12.0), (0.75, -28.0), (0.5, -20.0), (0.3, -42.0))
# OpenCV's drawing functions take fractions of a pixel with this many bits.
_SHIFT = 4


class ReliefSize:
    """
    Size of a surface.

    :param width_cm: In cm.
    :param height_cm: In cm.
    :param cm_per_px: Of the picture of it.
    """

    def __init__(self, width_cm: float, height_cm: float, cm_per_px: float) -> None:
        self.width, self.height = round(width_cm / cm_per_px), round(height_cm / cm_per_px)
        self.cm2 = width_cm * height_cm
        self.px_per_cm = 1 / cm_per_px

    def point(self, random: np.random.Generator) -> np.ndarray:
        """Draw a point: x and y, in px."""
        return random.uniform(0, 1, 2) * [self.width, self.height]


def draw_wood(size: ReliefSize, random: np.random.Generator) -> np.ndarray:
    """
    Draw planks along x, each with its own grain and shade, with joints between them, and knots.

    :returns: Shape (h, w), float32, in grey levels, about 0.
    """
    relief = np.zeros((size.height, size.width), np.float32)
    for top in np.arange(0, size.height, _PLANK_CM * size.px_per_cm):
        bottom = min(top + _PLANK_CM * size.px_per_cm, size.height)
        _draw_plank(relief[int(top):int(bottom)], size.px_per_cm, random)
    for _ in range(round(size.cm2 / _CM2_PER_KNOT)):
        _draw_knot(relief, size.point(random), random.uniform(0.3, 0.7) * size.px_per_cm)
    return cv2.GaussianBlur(relief, (0, 0), 0.6)


def draw_print(size: ReliefSize, random: np.random.Generator) -> np.ndarray:
    """
    Draw frames, discs and lines of ink.

    :returns: Shape (h, w), float32, in grey levels, 0 and below.
    """
    relief = np.zeros((size.height, size.width), np.float32)
    for number in range(round(size.cm2 / _CM2_PER_FIGURE)):
        at, level = size.point(random), random.uniform(-70, -25)
        length, height = random.uniform(0.6, 5, 2) * size.px_per_cm
        line_px = max(1, round(0.1 * size.px_per_cm))
        if number % 3 == 0:
            cv2.rectangle(relief, _fixed(at), _fixed(at + [length, height]), level, line_px,
                          cv2.LINE_AA, _SHIFT)
        elif number % 3 == 1:
            cv2.circle(relief, _fixed(at), _fixed([length / 4])[0], level, -1, cv2.LINE_AA,
                       _SHIFT)
        else:
            cv2.line(relief, _fixed(at), _fixed(at + [length, -height]), level, line_px,
                     cv2.LINE_AA, _SHIFT)
    return cv2.GaussianBlur(relief, (0, 0), 0.6)


def _draw_plank(
    plank: np.ndarray, px_per_cm: float, random: np.random.Generator
) -> None:
    # Length and width of the grain in cm, and its standard deviation in grey levels.
    for length_cm, width_cm, level in ((2.5, 0.12, 9), (0.6, 0.08, 5), (9.0, 1.5, 5)):
        plank += level * _grain(plank.shape, length_cm * px_per_cm, width_cm * px_per_cm, random)
    plank += random.normal(0, 5)
    height, width = plank.shape
    joint_px = max(1, round(_JOINT_CM * px_per_cm))
    plank[:joint_px] = _JOINT_LEVEL
    length_px = _PLANK_LENGTH_CM * px_per_cm
    for end in np.arange(random.uniform(0, length_px), width, length_px).astype(int):
        plank[:, end:end + joint_px] = _JOINT_LEVEL


def _grain(
    shape: Tuple[int, int], length_px: float, width_px: float, random: np.random.Generator
) -> np.ndarray:
    # Noise that was drawn coarsely; its standard deviation is about 1.
    height, width = shape
    coarse = random.standard_normal(
        (max(2, round(height / width_px)), max(2, round(width / length_px))))
    return 1.3 * cv2.resize(
        coarse.astype(np.float32), (width, height), interpolation=cv2.INTER_CUBIC)


def _draw_knot(relief: np.ndarray, middle: np.ndarray, radius: float) -> None:
    for share, level in _KNOT_RINGS:
        axes = _fixed((1.6 * share * radius, share * radius))
        cv2.ellipse(relief, _fixed(middle), axes, 0, 0, 360, level, -1, cv2.LINE_AA, _SHIFT)


def _fixed(numbers: Sequence[float]) -> Tuple[int, ...]:
    return tuple(round(float(number) * 2 ** _SHIFT) for number in numbers)
