# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A detector's results: outline, area, centre and axes of an object; random pixels as stand-in."""

from dataclasses import dataclass, field
import math
import random
from typing import Mapping, NamedTuple, Optional

import cv2
import numpy as np

# The tutorial draws them from this range in both directions.
_LOWEST, _HIGHEST = 250, 450
# Which part of a box lies in another that shows the same thing.
_MOSTLY = 0.8


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


class Pixel(NamedTuple):
    """A position on the picture, px: u right, v down, whole numbers at the pixels' centres."""

    u: float
    v: float


class Box(NamedTuple):
    """An upright rectangle on the picture, px, with its top-left pixel at (x, y)."""

    x: int
    y: int
    width: int
    height: int

    def is_inside(self, other: 'Box') -> bool:
        """Tell whether all of it lies in another."""
        return (other.x <= self.x and self.x + self.width <= other.x + other.width
                and other.y <= self.y and self.y + self.height <= other.y + other.height)

    def is_mostly_inside(self, other: 'Box') -> bool:
        """Tell whether more than 4/5 of its area lies in another, so that both show one thing."""
        across = min(self.x + self.width, other.x + other.width) - max(self.x, other.x)
        down = min(self.y + self.height, other.y + other.height) - max(self.y, other.y)
        return max(across, 0) * max(down, 0) > _MOSTLY * self.width * self.height

    def overlaps(self, other: 'Box') -> bool:
        """Tell whether both have a pixel in common."""
        return (self.x < other.x + other.width and other.x < self.x + self.width
                and self.y < other.y + other.height and other.y < self.y + self.height)


@dataclass(frozen=True)
class Detection:
    """
    One object on a frame.

    :param box: The upright rectangle around the object, in px.
    :param centre: The object's centre as the detector defines it, in px.
    :param area: The object's area as the detector defines it, in px².
    :param outline: Shape (n, 2), int32, columns u and v in px: the corners of the polygon through
        the centres of the object's outermost pixels.
    :param cut_off: Whether the object touches the picture's edge, so that a part may be missing.
    :param moments: Moments of the object's pixels, from cv2.moments; None to use the outline's.
    :param doubt: Standard deviation of the centre because a part may be light or not be seen, px.
    :param may_be_light: Whether its sharp rim alone tells that it is no light: neither the object
        nor the surface below has a colour or a texture.
    :param is_part: Whether it was parted from an object that hides it, or that it hides.
    """

    box: Box
    centre: Pixel
    area: float
    outline: np.ndarray = field(compare=False, repr=False)
    cut_off: bool
    moments: Optional[Mapping[str, float]] = field(default=None, compare=False, repr=False)
    doubt: float = 0.0
    is_part: bool = False
    may_be_light: bool = False

    @property
    def spread(self) -> np.ndarray:
        """
        The object's spread around its centroid.

        :returns: Shape (2, 2), the second central moments of u and v over the area, in px².
        """
        moments = self.moments or cv2.moments(self.outline)
        mixed = moments['mu11']
        return np.array([[moments['mu20'], mixed],
                         [mixed, moments['mu02']]]) / (moments['m00'] or 1.0)

    @property
    def orientation(self) -> float:
        """
        The direction of the longest axis.

        :returns: Angle from the u axis towards the v axis, in rad, in (-pi/2, pi/2]. It is
            meaningless if the axes are about equal: a round object has no direction.
        """
        return principal_axes(self.spread).angle


class NoObject(NamedTuple):
    """
    What differs from the background on a frame, and is no detection.

    :param kind: 'shade' or 'light' (darker or lighter than the background), 'speck' (too small),
        'light_or_thing' (the picture does not tell which), 'too_much' (the budget is spent).
    :param position: Its centroid, in px.
    :param area: In px².
    """

    kind: str
    position: Pixel
    area: float


def touches_edge(box: Box, picture: np.ndarray) -> bool:
    """Return whether a box reaches the outermost pixels of a picture of shape (h, w, ...)."""
    height, width = picture.shape[:2]
    return (box.x <= 0 or box.y <= 0
            or box.x + box.width >= width or box.y + box.height >= height)


def random_pixel() -> Pixel:
    """Draw a pixel from the tutorial's range."""
    return Pixel(*(random.randint(_LOWEST, _HIGHEST) for _ in 'uv'))
