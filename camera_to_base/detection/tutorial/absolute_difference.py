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

"""
The tutorial's detector: the same result to the pixel, in less time.

The tutorial treats the frame and the background alike (grey, closing, median), and an object is
where the two results differ by more than the threshold. Four facts make most of it unnecessary:

1. *No step moves two pictures further apart than their largest difference.* Grey is a weighted
   mean, with weights that are not negative and add up to 1, rounded: if no colour differs by more
   than d, neither does grey. Closing and median pick values by their rank (minimum, maximum,
   middle); adding d to a whole picture adds d to its result, and a picture that is nowhere darker
   has a result that is nowhere darker. So from `background - d <= frame <= background + d` the
   results follow in the same order, at most d apart. (Clipping to 0..255 is not needed for the
   argument: it holds on whole numbers.)
2. *Each step only looks around itself.* OpenCV's dilation and erosion with n ones read
   [p - n//2, p + n - 1 - n//2] and ignore what is outside the picture; the median of m reads m//2
   to both sides and repeats the picture's rim. One after the other they read [p - before, p +
   after], see `__init__`. So if all pixels that differ by more than the threshold lie in columns
   [x0, x1), objects can only be in [x0 - after, x1 + before). The same holds for rows.
3. *The background's result is known.* An object is where the frame's median lies below one limit
   (darker than the background) or above another one (lighter). Nothing is above 255, so nothing is
   lighter than a light table.
4. *A dark object contains dark squares of the kernel's size*: the closed picture is below a limit
   exactly where such a square is. If some boxes contain all dark squares, each box can be closed
   alone, as if all around it were white. `dark_squares` finds them in few rows of the frame, and
   `dark_objects` processes them together.

A frame that is nowhere lighter than the background (`light_blocks`) takes the short way: its
boxes. Any other frame is processed as a whole between its first and its last change. On a
background with much contrast, the frame is compared with it first.

Finally, the tutorial finds all contours, this detector only the outer ones. A hole's contour, or
one inside a hole, lies within an outer contour that precedes it in OpenCV's order and is not
smaller, so it is never the first of the largest.
"""

from typing import List, Optional

from camera_to_base.checks import whole_number
from camera_to_base.detection.detection import (
    Box, check_frame, check_same_size, Detection, find_outlines, Pixel, touches_edge)
from camera_to_base.detection.tutorial.changed_rows import changed_rows
from camera_to_base.detection.tutorial.dark_objects import DarkObjects
from camera_to_base.detection.tutorial.dark_squares import DarkSquares
from camera_to_base.detection.tutorial.light_blocks import LightBlocks
from camera_to_base.detection.tutorial.median import Median
from camera_to_base.detection.tutorial.region import grow, Region, round_up, within
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
        self._background = background.copy()
        self._background_grey = cv2.cvtColor(self._background, cv2.COLOR_BGR2GRAY)
        self._threshold = threshold
        self._kernel = np.ones((closing_size, closing_size), np.uint8)
        self._median = Median(median_size)
        reach = self._median.reach
        self._before = 2 * (closing_size // 2) + reach
        self._after = 2 * (closing_size - 1 - closing_size // 2) + reach
        # Memory for each frame, so that none is allocated.
        self._grey = np.empty_like(self._background_grey)
        self._smooth = self._median.blur(self._close(self._background_grey.copy())).copy()
        darkest = np.maximum(self._smooth.astype(int) - threshold, 0).astype(np.uint8)
        lightest = np.minimum(self._smooth.astype(int) + threshold, 255).astype(np.uint8)
        self._dark_squares = DarkSquares(darkest, closing_size, reach)
        self._dark_objects = DarkObjects(darkest, closing_size, self._median)
        self._light_blocks = LightBlocks(lightest, self._before)
        self._least_lightest = int(lightest.min())
        self._has_contrast = bool(self._has_light_pixels(self._background)
                                  or self._dark_squares.boxes(self._background))

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
        return sorted(map(self._detection, self._outlines(frame)),
                      key=lambda detection: -detection.area)

    @property
    def taken_away(self) -> List[Detection]:
        """Always empty: what was taken away counts as an object, as in the tutorial."""
        return []

    @property
    def noise(self) -> None:
        """Not known: the tutorial does not ask."""

    def _outlines(self, frame: np.ndarray) -> List[np.ndarray]:
        """Find the outer outlines of all objects, in OpenCV's order."""
        if not self._has_contrast and not self._has_light_pixels(frame):
            return self._dark_objects.outlines(frame, self._dark_squares.boxes(frame))
        changed = changed_rows(frame, self._background, self._threshold)
        if changed is None:
            return []
        reach = self._before + self._after
        near = grow(changed, reach, reach, len(frame))
        boxes = self._dark_squares.boxes(frame, near)
        if (sum(box.px for box in boxes) > self._grey.size // 2
                or self._light_blocks.has_light(frame, near)):
            return self._changed_outlines(frame, changed, near)
        return self._dark_objects.outlines(frame, boxes)

    def _has_light_pixels(self, frame: np.ndarray) -> bool:
        # Grey is not above the largest colour.
        return self._least_lightest < 255 and int(frame.max()) > self._least_lightest

    def _changed_outlines(
        self, frame: np.ndarray, changed: slice, near: slice
    ) -> List[np.ndarray]:
        cv2.cvtColor(frame[near], cv2.COLOR_BGR2GRAY, dst=self._grey[near])
        columns = self._changed_columns(changed)
        if columns is None:
            return []
        region = Region(changed, columns)
        read = self._grow(region, self._before + self._after, self._before + self._after)
        # The closing is up to twice as fast on a width that is a multiple of 64.
        read = read._replace(columns=round_up(read.columns, 64, self._grey.shape[1]))
        found = self._grow(region, self._after, self._before)
        place = self._grow(found, self._median.reach, self._median.reach)
        closed = self._close(self._grey[read])[within(place, read)]
        difference = cv2.absdiff(self._median.blur(closed), self._smooth[place])
        _, mask = cv2.threshold(
            difference[within(found, place)], self._threshold, 255, cv2.THRESH_BINARY)
        return find_outlines(mask, found.columns.start, found.rows.start)

    def _changed_columns(self, rows: slice) -> Optional[slice]:
        height, width = self._grey.shape
        if rows.stop - rows.start > height // 2:
            return slice(0, width)  # The steps' time depends more on the rows than on the columns.
        difference = cv2.absdiff(self._grey[rows], self._background_grey[rows])
        columns = np.flatnonzero(difference.max(axis=0) > self._threshold)
        return slice(int(columns[0]), int(columns[-1]) + 1) if len(columns) else None

    def _grow(self, region: Region, before: int, after: int) -> Region:
        return Region(*(grow(part, before, after, length)
                        for part, length in zip(region, self._grey.shape)))

    def _close(self, grey: np.ndarray) -> np.ndarray:
        return cv2.morphologyEx(grey, cv2.MORPH_CLOSE, self._kernel, dst=grey)

    def _detection(self, outline: np.ndarray) -> Detection:
        box = Box(*cv2.boundingRect(outline))
        centre = Pixel(box.x + box.width // 2, box.y + box.height // 2)
        return Detection(box, centre, cv2.contourArea(outline), outline[:, 0],
                         touches_edge(box, self._grey))
