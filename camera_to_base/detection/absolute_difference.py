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
   (darker than the background) or above another one (lighter): `median_limit`. Nothing is above
   255, so nothing is lighter than a light table.
4. *A dark object contains dark squares of the kernel's size*: the closed picture is below a limit
   exactly where such a square is. If some boxes contain all dark squares, each box can be closed
   alone, as if all around it were white. `dark_squares` finds them in few rows of the frame.

A frame that is nowhere lighter than the background (`light_blocks`) takes the short way: its
boxes. Any other frame is processed as a whole between its first and its last change. On a
background with much contrast, the frame is compared with it first.

Finally, the tutorial finds all contours, this detector only the outer ones. A hole's contour, or
one inside a hole, lies within an outer contour that precedes it in OpenCV's order and is not
smaller, so it is never the first of the largest.
"""

from typing import List, Optional

from camera_to_base.checks import whole_number
from camera_to_base.detection.background import changed_rows
from camera_to_base.detection.dark_squares import DarkSquares
from camera_to_base.detection.detection import (
    Box, check_frame, check_same_size, Detection, find_outlines, Pixel, touches_edge)
from camera_to_base.detection.light_blocks import LightBlocks
from camera_to_base.detection.median_limit import MedianLimit
from camera_to_base.detection.region import grow, Region, round_up, row_bands, within
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
        self._median_reach = median_size // 2
        self._before = 2 * (closing_size // 2) + self._median_reach
        self._after = 2 * (closing_size - 1 - closing_size // 2) + self._median_reach
        # Of the picture's size: a place has the same indices everywhere, and no memory is
        # allocated for each frame.
        self._grey, self._mask = np.empty((2, *self._background_grey.shape), np.uint8)
        self._everywhere = Region(*(slice(0, length) for length in self._mask.shape))
        self._set_limits(median_size)

    def _set_limits(self, median_size: int) -> None:
        smooth = cv2.medianBlur(self._close(self._background_grey.copy()), median_size).astype(int)
        darkest = np.maximum(smooth - self._threshold, 0).astype(np.uint8)
        lightest = np.minimum(smooth + self._threshold, 255).astype(np.uint8)
        self._darker = MedianLimit(darkest, median_size)
        # A picture is above a limit where the negative picture is below the negative limit.
        self._lighter = MedianLimit(255 - lightest, median_size)
        self._dark_squares = DarkSquares(darkest, len(self._kernel), self._median_reach)
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
        bands = self._marked_bands(frame)
        # OpenCV's order is from the bottom to the top.
        outlines = [outline for band in reversed(bands) for outline in find_outlines(
            self._mask[band], band.columns.start, band.rows.start)]
        return sorted(map(self._detection, outlines), key=lambda detection: -detection.area)

    @property
    def taken_away(self) -> List[Detection]:
        """Always empty: what was taken away counts as an object, as in the tutorial."""
        return []

    @property
    def noise(self) -> None:
        """Not known: the tutorial does not ask."""

    def _marked_bands(self, frame: np.ndarray) -> List[Region]:
        """Mark all objects in the mask; return the bands of rows in which they are."""
        if not self._has_contrast and not self._has_light_pixels(frame):
            return self._mark_darker(frame, self._dark_squares.boxes(frame))
        changed = changed_rows(frame, self._background, self._threshold)
        if changed is None:
            return []
        reach = self._before + self._after
        near = grow(changed, reach, reach, len(frame))
        boxes = self._dark_squares.boxes(frame, near)
        if (sum(box.px for box in boxes) > self._mask.size // 2
                or self._light_blocks.has_light(frame, near)):
            return self._mark_changed(frame, changed, near)
        return self._mark_darker(frame, boxes)

    def _has_light_pixels(self, frame: np.ndarray) -> bool:
        # Grey is not above the largest colour.
        return self._least_lightest < 255 and int(frame.max()) > self._least_lightest

    def _mark_darker(self, frame: np.ndarray, boxes: List[Region]) -> List[Region]:
        # The even kernel moves the closed picture by 1 px to the lower right, and the median looks
        # further by its reach. A box needs a white rim, except where the picture ends.
        places = [self._grow(box, max(self._median_reach, 1), self._median_reach + 1)
                  for box in boxes]
        bands = row_bands(places)
        for band in bands:
            self._mask[band] = 0
        for box, place in zip(boxes, places):
            if box != place:
                self._grey[place] = 255
            cv2.cvtColor(frame[box], cv2.COLOR_BGR2GRAY, dst=self._grey[box])
            if place == self._everywhere and self._grey.max() < self._darker.least:
                self._mask[place] = 1  # No step makes a pixel lighter than all pixels.
            else:
                self._mark(self._darker, self._close(self._grey[place]), place)
        return bands

    def _mark_changed(self, frame: np.ndarray, changed: slice, near: slice) -> List[Region]:
        cv2.cvtColor(frame[near], cv2.COLOR_BGR2GRAY, dst=self._grey[near])
        columns = self._changed_columns(changed)
        if columns is None:
            return []
        region = Region(changed, columns)
        read = self._grow(region, self._before + self._after, self._before + self._after)
        # The closing is up to twice as fast on a width that is a multiple of 64.
        read = read._replace(columns=round_up(read.columns, 64, self._mask.shape[1]))
        found = self._grow(region, self._after, self._before)
        place = self._grow(found, self._median_reach, self._median_reach)
        closed = self._close(self._grey[read])[within(place, read)]
        self._mask[place] = 0
        self._mark(self._darker, closed, place)
        self._mark(self._lighter, cv2.bitwise_not(closed), place)
        return [found]

    def _changed_columns(self, rows: slice) -> Optional[slice]:
        height, width = self._mask.shape
        if rows.stop - rows.start > height // 2:
            return slice(0, width)  # The steps' time depends more on the rows than on the columns.
        difference = cv2.absdiff(self._grey[rows], self._background_grey[rows])
        columns = np.flatnonzero(difference.max(axis=0) > self._threshold)
        return slice(int(columns[0]), int(columns[-1]) + 1) if len(columns) else None

    def _grow(self, region: Region, before: int, after: int) -> Region:
        return Region(*(grow(part, before, after, length)
                        for part, length in zip(region, self._mask.shape)))

    def _close(self, grey: np.ndarray) -> np.ndarray:
        return cv2.morphologyEx(grey, cv2.MORPH_CLOSE, self._kernel, dst=grey)

    def _mark(self, limit: MedianLimit, closed: np.ndarray, place: Region) -> None:
        below = limit.below(closed, place)
        if below is not None:
            cv2.bitwise_or(self._mask[place], below, dst=self._mask[place])

    def _detection(self, outline: np.ndarray) -> Detection:
        box = Box(*cv2.boundingRect(outline))
        centre = Pixel(box.x + box.width // 2, box.y + box.height // 2)
        return Detection(box, centre, cv2.contourArea(outline), outline[:, 0],
                         touches_edge(box, self._mask))
