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
Where a frame can be darker than the background after closing and median: a look at few rows.

The closed picture is dark only where a whole square of the closing kernel's size is dark, or the
part of it that lies within the picture. As the kernel's centre always lies within the picture, no
such part has fewer rows or columns than `step`, the kernel's larger half (or all, if the picture
has fewer). So each square contains a row whose number is a multiple of `step`, and in it a
run of at least `step` dark pixels. Only these rows are read. Salt, thin lines and noise have no
such runs.
"""

from typing import List, Optional, Tuple

from camera_to_base.detection.tutorial.region import grow, Region
import cv2
import numpy as np

# A box of its own costs as much time as this many px of a larger box.
_BOX_PX = 30000


class DarkSquares:
    """
    Finds boxes that contain all dark squares of a frame.

    :param limits: Shape (h, w), uint8: a median below it is dark.
    :param closing_size: Edge of the closing kernel, in px.
    :param median_reach: How far the median looks to each side, in px.
    """

    def __init__(self, limits: np.ndarray, closing_size: int, median_reach: int) -> None:
        self._shape = limits.shape
        self._step = step = closing_size - closing_size // 2
        # A square can make a median dark whose limit is as far away as this from its pixels.
        reach = min(2 * (closing_size // 2) + median_reach, max(limits.shape))
        around = np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
        self._limits = np.ascontiguousarray(cv2.dilate(limits, around)[::step])
        self._run = min(step, limits.shape[1])
        self._run_kernel = np.ones((1, self._run), np.uint8)
        # Runs that are closer than this can belong to squares that one median sees together.
        self._join = np.ones((1 + 2 * (median_reach + step - 1) // step,
                              1 + 2 * median_reach + step), np.uint8)

    def boxes(self, frame: np.ndarray, rows: Optional[slice] = None) -> List[Region]:
        """
        Find the boxes.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param rows: Where to look: squares within these rows are found. None looks everywhere.
        :returns: Each square lies within a box. No median sees pixels of two squares for which
            there is no common box. Boxes may overlap.
        """
        start, stop = (rows.start, rows.stop) if rows else (0, len(frame))
        first, last = -(-start // self._step), -(-stop // self._step)
        if first >= last:
            return []
        rows_read = cv2.cvtColor(frame[first * self._step:stop:self._step], cv2.COLOR_BGR2GRAY)
        dark = (rows_read < self._limits[first:last]).view(np.uint8)
        count = cv2.countNonZero(dark)
        if 2 * count > dark.size:  # A search would cost more than it saves.
            return [self._box(slice(0, dark.shape[0]), slice(0, dark.shape[1]), first)]
        return self._boxes_of(dark, first) if count else []

    def _boxes_of(self, dark: np.ndarray, first: int) -> List[Region]:
        # The middle of each run within the picture.
        runs = cv2.erode(dark, self._run_kernel, borderType=cv2.BORDER_CONSTANT, borderValue=0)
        groups, _ = cv2.findContours(
            cv2.dilate(runs, self._join), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        if not groups:
            return []
        parts = [self._runs_in(*cv2.boundingRect(group), runs.shape) for group in groups]
        whole = self._box(*(slice(min(part.start for part in side), max(
            part.stop for part in side)) for side in zip(*parts)), first)
        if whole.px < 2 * _BOX_PX or len(groups) * _BOX_PX > whole.px:
            return [whole]
        boxes = [self._box(rows, columns, first) for rows, columns in parts]
        return boxes if sum(_BOX_PX + box.px for box in boxes) < whole.px else [whole]

    def _runs_in(
        self, left: int, top: int, width: int, height: int, shape: Tuple[int, int]
    ) -> Tuple[slice, slice]:
        """Take off from a group what the dilation has added, where the border cut nothing off."""
        (rows, columns), (all_rows, all_columns) = self._join.shape, shape
        right, bottom = left + width, top + height
        return (slice(top and top + rows - 1 - rows // 2,
                      bottom - rows // 2 if bottom < all_rows else bottom),
                slice(left and left + columns - 1 - columns // 2,
                      right - columns // 2 if right < all_columns else right))

    def _box(self, rows: slice, columns: slice, first: int) -> Region:
        top, bottom = (first + rows.start) * self._step, (first + rows.stop - 1) * self._step
        return Region(
            grow(slice(top, bottom + 1), self._step - 1, self._step - 1, self._shape[0]),
            grow(columns, self._run // 2, self._run - 1 - self._run // 2, self._shape[1]))
