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

"""A detector's results: outline, area, centre and axes of an object."""

from dataclasses import dataclass, field
from typing import Mapping, NamedTuple, Optional

from camera_to_base.detection.shape import principal_axes
from camera_to_base.errors import FrameSizeError, InvalidValueError
import cv2
import numpy as np


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
    """

    box: Box
    centre: Pixel
    area: float
    outline: np.ndarray = field(compare=False, repr=False)
    cut_off: bool
    moments: Optional[Mapping[str, float]] = field(default=None, compare=False, repr=False)

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


def check_frame(frame: np.ndarray, name: str = 'frame') -> None:
    """
    Check that an array is a colour picture.

    :raises InvalidValueError: If it is not an array of shape (h, w, 3), uint8, with pixels in it.
    """
    if not isinstance(frame, np.ndarray) or frame.ndim != 3 or frame.shape[2] != 3:
        raise InvalidValueError(
            f'expected a {name} of shape (h, w, 3), got {getattr(frame, "shape", type(frame))}')
    if frame.dtype != np.uint8 or frame.size == 0:
        raise InvalidValueError(
            f'expected a {name} of uint8 with pixels in it, got {frame.dtype} {frame.shape}')


def check_same_size(frame: np.ndarray, background: np.ndarray) -> None:
    """
    Check that a frame can be compared with a background.

    :raises FrameSizeError: If its size is not the background's.
    :raises InvalidValueError: If it is not a colour picture.
    """
    check_frame(frame)
    if frame.shape[:2] != background.shape[:2]:
        raise FrameSizeError(
            f'the frame is {_size_text(frame)}, but the background is {_size_text(background)}: '
            'use one picture size')


def touches_edge(box: Box, picture: np.ndarray) -> bool:
    """Return whether a box reaches the outermost pixels of a picture of shape (h, w, ...)."""
    height, width = picture.shape[:2]
    return (box.x <= 0 or box.y <= 0
            or box.x + box.width >= width or box.y + box.height >= height)


def _size_text(picture: np.ndarray) -> str:
    return f'{picture.shape[1]} x {picture.shape[0]} px'
