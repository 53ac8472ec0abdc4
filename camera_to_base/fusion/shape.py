# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
Convex shapes on the surface, by how far they reach in each direction.

How far a convex shape reaches in a direction is linear in all that is asked of it here: shapes are
moved, scaled, swept and averaged by adding numbers, and nothing needs to be cut.
"""

import math
from typing import Callable, NamedTuple, Optional

from camera_to_base.coordinate_transform import axis_angle, LEAST_ELONGATION
import numpy as np

# The directions, 3 degrees apart; each has its opposite half a turn later.
COUNT = 120
_STEP = 2 * math.pi / COUNT
ANGLES = _STEP * np.arange(COUNT)
# Shape (COUNT, 2).
DIRECTIONS = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])


class Extent(NamedTuple):
    """
    The rectangle around a shape.

    :param length: Along `angle`, in cm.
    :param width: Across it, in cm.
    :param angle: From x towards y, in rad, in (-pi/2, pi/2].
    """

    length: float
    width: float
    angle: float


class Moments(NamedTuple):
    """
    The moments of a shape.

    :param area: In cm²; not above 0 for what is no shape.
    :param centre: Its centroid, shape (2,), in cm.
    :param spread: Second central moments over the area, shape (2, 2), in cm².
    """

    area: float
    centre: np.ndarray
    spread: np.ndarray

    @property
    def yaw(self) -> Optional[float]:
        """The direction of its length, in rad; None where it is about as wide as long."""
        (xx, xy), (_, yy) = self.spread.tolist()
        both, difference = (xx + yy) / 2, math.hypot(xy, (xx - yy) / 2)
        if not both + difference > LEAST_ELONGATION ** 2 * max(both - difference, 0.0):
            return None
        angle = math.atan2(2 * xy, xx - yy) / 2
        return axis_angle(math.cos(angle), math.sin(angle))


def reach(corners: np.ndarray, directions: np.ndarray = DIRECTIONS) -> np.ndarray:
    """
    Return how far a polygon reaches from the frame's origin.

    :param corners: Shape (n, 2), in cm.
    :param directions: Shape (m, 2).
    :returns: Shape (m,), in cm; negative where all of it lies behind the origin.
    """
    return (directions @ corners.T).max(axis=1)


def notch(corners: np.ndarray) -> float:
    """
    Return how deep a polygon is notched: how far inside of its hull a corner is, in cm.

    :param corners: Shape (n, 2), in cm.
    """
    along = DIRECTIONS @ corners.T
    return float((along.max(axis=1)[:, None] - along).min(axis=0).max())


def outline_of(reached: np.ndarray) -> np.ndarray:
    """
    Return the polygon that reaches so far: where neighbouring tangents meet.

    :param reached: Shape (COUNT,), from the frame's origin, in cm.
    :returns: Shape (COUNT, 2), in cm.
    """
    beside = (np.roll(reached, -1) - reached * math.cos(_STEP)) / math.sin(_STEP)
    left = np.column_stack([-DIRECTIONS[:, 1], DIRECTIONS[:, 0]])
    return reached[:, None] * DIRECTIONS + beside[:, None] * left


def moments_of(corners: np.ndarray) -> Moments:
    """
    Return the moments of a polygon.

    :param corners: Shape (n, 2), counter-clockwise, in cm.
    """
    middle = corners.mean(axis=0)
    here = corners - middle
    after = np.roll(here, -1, axis=0)
    cross = here[:, 0] * after[:, 1] - after[:, 0] * here[:, 1]
    area = float(cross.sum()) / 2
    if not area > 0:
        return Moments(0.0, middle, np.zeros((2, 2)))
    centre = cross @ (here + after) / (6 * area)
    both = here + after
    squares = ((here * cross[:, None]).T @ here + (after * cross[:, None]).T @ after
               + (both * cross[:, None]).T @ both) / (24 * area)
    return Moments(area, middle + centre, squares - np.outer(centre, centre))


def extent_of(reaches: Callable[[np.ndarray], np.ndarray], moments: Moments) -> Extent:
    """
    Measure a shape: along its length, or as the smallest rectangle where it has none.

    :param reaches: Returns how far it reaches in directions, shape (n, 2).
    """
    angle = moments.yaw
    if angle is None:
        widths = reaches(DIRECTIONS)[:COUNT // 2] + reaches(-DIRECTIONS)[:COUNT // 2]
        areas = (widths * np.roll(widths, -COUNT // 4))[:COUNT // 4]
        angle = float(ANGLES[np.argmin(areas)])
    # Asked for in these very directions, as the polygon of tangents reaches too far between two.
    along, across = directions = np.array([
        [math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    length, width = (reaches(directions) + reaches(-directions)).tolist()
    if length < width:
        length, width, along = width, length, across
    return Extent(length, width, axis_angle(*along.tolist()))
