# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The tutorial's method: OpenCV's absolute difference to the background, closed and smoothed."""

from typing import List

from camera_to_base.checks import check_frame, check_same_size, whole_number
from camera_to_base.detection.detection import Box, Detection, NoObject, Pixel, touches_edge
from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np


class AbsoluteDifferenceDetector:
    """
    Find objects by their absolute difference to the background, as the tutorial does.

    A dark object on a lighter surface is found as a whole. A light object is found only where it
    is wider than the closing kernel; smaller spots count as noise.

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
        self.check_parameters(threshold, closing_size, median_size)
        check_frame(background, 'background')
        self._threshold = threshold
        self._kernel = np.ones((closing_size, closing_size), np.uint8)
        self._median_size = median_size
        self._background = self._smooth(background)

    @staticmethod
    def check_parameters(threshold: int, closing_size: int, median_size: int) -> None:
        """
        Check the detector's parameters without a background.

        :raises InvalidValueError: If one is invalid; the message names it and its range.
        """
        whole_number('threshold', threshold, 0, 255)
        whole_number('closing_size', closing_size, 1, 500)
        if whole_number('median_size', median_size, 1, 99) % 2 == 0:
            raise InvalidValueError(f'median_size must be odd, got {median_size}')

    def detect(self, frame: np.ndarray) -> List[Detection]:
        """
        Find the objects on a frame.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :returns: The largest first; equal ones in OpenCV's order. [] if there is none.
        :raises FrameSizeError: If the frame's size is not the background's.
        :raises InvalidValueError: If it is not a colour picture.
        """
        check_same_size(frame, self._background)
        difference = cv2.absdiff(self._smooth(frame), self._background)
        _, mask = cv2.threshold(difference, self._threshold, 255, cv2.THRESH_BINARY)
        # The tutorial takes all outlines. That of a hole is not larger than the outer one, which
        # precedes it: so the first of the largest is the same.
        outlines, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        return sorted((_detection(outline, frame) for outline in outlines),
                      key=lambda detection: -detection.area)

    @property
    def taken_away(self) -> List[Detection]:
        """Always empty: what was taken away counts as an object, as in the tutorial."""
        return []

    @property
    def dropped(self) -> List[NoObject]:
        """Always empty: the tutorial does not ask what else differs."""
        return []

    @property
    def noise(self) -> None:
        """Not known: the tutorial does not ask."""

    def _smooth(self, picture: np.ndarray) -> np.ndarray:
        grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
        closed = cv2.morphologyEx(grey, cv2.MORPH_CLOSE, self._kernel)
        return cv2.medianBlur(closed, self._median_size)


def _detection(outline: np.ndarray, frame: np.ndarray) -> Detection:
    box = Box(*cv2.boundingRect(outline))
    centre = Pixel(box.x + box.width // 2, box.y + box.height // 2)
    return Detection(box, centre, cv2.contourArea(outline), outline[:, 0],
                     touches_edge(box, frame))
