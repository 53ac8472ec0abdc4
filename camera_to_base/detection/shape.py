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

"""Centroid and axes of a plane shape."""

import math
from typing import NamedTuple

import numpy as np


class PrincipalAxes(NamedTuple):
    """
    The ellipse with the same second moments as a shape.

    :param angle: The direction of its length, from the first axis towards the second, in rad, in
        (-pi/2, pi/2].
    :param length: Its long diameter.
    :param width: Its short diameter.
    """

    angle: float
    length: float
    width: float

    @property
    def elongation(self) -> float:
        """Length / width: 1 for a disc or a square, infinite for a line."""
        return self.length / self.width if self.width > 0 else math.inf


def principal_axes(spread: np.ndarray) -> PrincipalAxes:
    """
    Compute the axes of a shape.

    :param spread: Shape (2, 2), its second central moments over its area.
    """
    (xx, xy), (_, yy) = spread.tolist()
    # + 0.0 turns -0.0 into 0.0: with -0.0, atan2 returns -pi for an upright shape.
    angle = math.atan2(2 * xy + 0.0, xx - yy) / 2
    both, difference = xx + yy, math.hypot(2 * xy, xx - yy)
    # An ellipse's second moment, the eigenvalue, is a quarter of its half diameter squared.
    return PrincipalAxes(angle, math.sqrt(8 * (both + difference)),
                         math.sqrt(8 * max(both - difference, 0.0)))


def polygon_centroid(corners: np.ndarray) -> np.ndarray:
    """
    Compute the centroid of a polygon, in the unit of its corners.

    :param corners: Shape (n, 2), float.
    :returns: Shape (2,). The mean of the corners if the polygon has no area.
    """
    # Seen from a corner, the two edges at that corner contribute nothing.
    offsets = corners[1:] - corners[0]
    before, after = offsets[:-1], offsets[1:]
    doubled_areas = before[:, 0] * after[:, 1] - after[:, 0] * before[:, 1]
    doubled_area = doubled_areas.sum()
    if doubled_area == 0:
        return corners.mean(axis=0)
    return corners[0] + doubled_areas @ (before + after) / (3 * doubled_area)
