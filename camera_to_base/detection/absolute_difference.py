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
where the two results differ by more than the threshold. Two facts make most of it unnecessary:

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
   after], see `__init__`.

Together: where the pixels that the result at p depends on differ by at most the threshold, there
is no object at p. If all pixels that differ by more lie in columns [x0, x1), objects can only be
in [x0 - after, x1 + before). Only this piece is processed, enlarged by what the steps read, so
that its rim does not matter. The same holds for rows. Everywhere else the tutorial's mask is
empty. The median, the most expensive step, is taken only in bands of rows near one where the
closed pictures differ by more than the threshold. By the same two facts there is nothing between
the bands.

Finally, the tutorial finds all contours, this detector only the outer ones. A hole's contour, or
one inside a hole, lies within an outer contour that precedes it in OpenCV's order and is not
smaller, so it is never the first of the largest.
"""

from typing import List

from camera_to_base.checks import whole_number
from camera_to_base.detection.background import Background, grow, round_up
from camera_to_base.detection.detection import (
    Box, check_frame, check_same_size, Detection, find_outlines, Pixel, touches_edge)
from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np

# Extra columns for a width at which the median is fast.
_PADDING = 80


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
        self._background = Background(background.copy())
        self._threshold = threshold
        self._closing_kernel = np.ones((closing_size, closing_size), np.uint8)
        self._median_size = median_size
        self._median_reach = median_size // 2
        self._before = 2 * (closing_size // 2) + self._median_reach
        self._after = 2 * (closing_size - 1 - closing_size // 2) + self._median_reach
        self._smooth_background = self._smoothed_background()

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
        check_same_size(frame, self._background.picture)
        height, width = frame.shape[:2]
        reach = self._before + self._after
        region = self._background.changed_region(
            frame, self._threshold, reach, self._grey[:, :width])
        if region is None:
            return []
        band = grow(region.rows, reach, reach, height)
        # The closing is up to twice as fast on a width that is a multiple of 64.
        piece = round_up(grow(region.columns, reach, reach, width), 64, width)
        self._close(band, piece)
        rows = grow(region.rows, self._after, self._before, height)
        columns = grow(region.columns, self._after, self._before, width)
        mask = np.zeros((rows.stop - rows.start, columns.stop - columns.start), np.uint8)
        for band in self._bands(rows, columns):
            self._smooth_closed(grow(band, self._median_reach, self._median_reach, height), piece)
            difference = cv2.absdiff(
                self._smooth[band, columns], self._smooth_background[band, columns])
            cv2.threshold(difference, self._threshold, 255, cv2.THRESH_BINARY,
                          dst=mask[band.start - rows.start:band.stop - rows.start])
        detections = [self._detection(outline)
                      for outline in find_outlines(mask, columns.start, rows.start)]
        return sorted(detections, key=lambda detection: -detection.area)

    @property
    def taken_away(self) -> List[Detection]:
        """Always empty: what was taken away counts as an object, as in the tutorial."""
        return []

    @property
    def noise(self) -> None:
        """Not known: the tutorial does not ask."""

    def _smoothed_background(self) -> np.ndarray:
        # The steps write to arrays of the picture's size: a place has the same indices in all of
        # them, and no memory is allocated for each frame.
        height, width = self._background.grey.shape
        self._grey = np.empty((height, width + _PADDING), np.uint8)
        self._grey[:, :width] = self._background.grey
        self._smooth = np.empty_like(self._grey)
        self._close(slice(0, height), slice(0, width))
        self._closed_background = self._grey[:, :width].copy()
        self._smooth_closed(slice(0, height), slice(0, width))
        return self._smooth[:, :width].copy()

    def _close(self, rows: slice, columns: slice) -> None:
        piece = self._grey[rows, columns]
        cv2.morphologyEx(piece, cv2.MORPH_CLOSE, self._closing_kernel, dst=piece)

    def _smooth_closed(self, rows: slice, columns: slice) -> None:
        # medianBlur is up to five times slower where the width is below 68 or (before OpenCV 5)
        # where width - 4 is not a multiple of 16. Beyond the picture it repeats the last column;
        # so the last column is repeated here up to a fast width.
        stop, width = columns.stop, columns.stop - columns.start
        padded = slice(columns.start, stop + max(68 - width, (4 - width) % 16))
        self._grey[rows, stop:padded.stop] = self._grey[rows, stop - 1:stop]
        cv2.medianBlur(self._grey[rows, padded], self._median_size,
                       dst=self._smooth[rows, padded])

    def _bands(self, rows: slice, columns: slice) -> List[slice]:
        if rows.stop - rows.start == len(self._grey):
            return [rows]  # so much has changed that a search would cost more than it saves
        difference = cv2.absdiff(
            self._grey[rows, columns], self._closed_background[rows, columns])
        changed = np.flatnonzero(difference.max(axis=1) > self._threshold) + rows.start
        if len(changed) == 0:
            return []
        reach = self._median_reach
        gaps = np.flatnonzero(np.diff(changed) > 4 * reach + 1)
        return [slice(max(int(first) - reach, rows.start), min(int(last) + 1 + reach, rows.stop))
                for first, last in zip(changed[np.append(0, gaps + 1)],
                                       changed[np.append(gaps, -1)])]

    def _detection(self, outline: np.ndarray) -> Detection:
        box = Box(*cv2.boundingRect(outline))
        centre = Pixel(box.x + box.width // 2, box.y + box.height // 2)
        return Detection(box, centre, cv2.contourArea(outline), outline[:, 0],
                         touches_edge(box, self._background.grey))
