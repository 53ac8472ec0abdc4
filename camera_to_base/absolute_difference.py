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

"""Finds objects by the absolute difference between a frame and a background picture."""

from dataclasses import dataclass
from typing import List, NamedTuple

from camera_to_base.checks import whole_number
from camera_to_base.errors import FrameSizeError, InvalidValueError
import cv2
import numpy as np


class Pixel(NamedTuple):
    """A position on the picture, in px: u to the right, v down, from the top-left pixel."""

    u: float
    v: float


class Box(NamedTuple):
    """An upright rectangle on the picture, in px."""

    x: int
    y: int
    width: int
    height: int


@dataclass(frozen=True)
class Detection:
    """An object on the picture; its area is that of its outline, in px²."""

    box: Box
    centre: Pixel
    area: float


class AbsoluteDifferenceDetector:
    """
    The tutorial's detector, to the pixel.

    A dark object on a lighter surface comes out whole, a light one only where it is wider than
    the closing kernel lets through; smaller spots are taken for noise.

    :param background: The surface without an object, shape (h, w, 3), uint8, BGR.
    :param threshold: Grey levels, 0..255; a pixel that differs by more belongs to an object.
    :param closing_size: Edge of the square kernel that closes gaps, in px.
    :param median_size: Edge of the median filter's window, in px, odd.
    :raises InvalidValueError: If the background or a parameter cannot be used.
    """

    def __init__(
        self,
        background: np.ndarray,
        *,
        threshold: int = 95,
        closing_size: int = 20,
        median_size: int = 5,
    ) -> None:
        check_frame(background, 'background')
        self.check_parameters(threshold, closing_size, median_size)
        self._size = background.shape
        self._threshold = int(threshold)
        self._closing_kernel = np.ones((int(closing_size), int(closing_size)), np.uint8)
        self._median_size = int(median_size)
        self._background = self._smooth(background)

    @staticmethod
    def check_parameters(threshold: int, closing_size: int, median_size: int) -> None:
        """
        Check the detector's parameters without a background.

        :raises InvalidValueError: If one cannot be used; the text names it and its range.
        """
        whole_number('threshold', threshold, 0, 255)
        whole_number('closing_size', closing_size, 1, 500)
        if whole_number('median_size', median_size, 1, 99) % 2 == 0:
            raise InvalidValueError(f'median_size must be odd, got {median_size}')

    def detect(self, frame: np.ndarray) -> List[Detection]:
        """
        Find the objects on a frame.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :returns: The largest first, of equals the one that OpenCV lists first; none is [].
        :raises FrameSizeError: If the frame's size is not the background's.
        :raises InvalidValueError: If it is not a colour picture.
        """
        check_frame(frame, 'frame')
        if frame.shape != self._size:
            raise FrameSizeError(
                f'the frame is {_size_text(frame)}, but the background is '
                f'{self._size[1]} x {self._size[0]} px: use one picture size')
        difference = cv2.absdiff(self._smooth(frame), self._background)
        _, mask = cv2.threshold(difference, self._threshold, 255, cv2.THRESH_BINARY)
        outlines, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        detections = [_detection(outline) for outline in outlines]
        return sorted(detections, key=lambda detection: -detection.area)

    def _smooth(self, frame: np.ndarray) -> np.ndarray:
        grey = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
        closed = cv2.morphologyEx(grey, cv2.MORPH_CLOSE, self._closing_kernel)
        return cv2.medianBlur(closed, self._median_size)


def check_frame(frame: np.ndarray, name: str = 'frame') -> None:
    """
    Check that a picture is one that this package can use.

    :raises InvalidValueError: If it is not an array of shape (h, w, 3), uint8, with pixels in it.
    """
    if not isinstance(frame, np.ndarray) or frame.ndim != 3 or frame.shape[2] != 3:
        raise InvalidValueError(
            f'expected a {name} of shape (h, w, 3), got {getattr(frame, "shape", type(frame))}')
    if frame.dtype != np.uint8 or frame.size == 0:
        raise InvalidValueError(
            f'expected a {name} of uint8 with pixels in it, got {frame.dtype} {frame.shape}')


def _detection(outline: np.ndarray) -> Detection:
    box = Box(*(int(value) for value in cv2.boundingRect(outline)))
    centre = Pixel(box.x + box.width // 2, box.y + box.height // 2)
    return Detection(box, centre, float(cv2.contourArea(outline)))


def _size_text(frame: np.ndarray) -> str:
    return f'{frame.shape[1]} x {frame.shape[0]} px'
