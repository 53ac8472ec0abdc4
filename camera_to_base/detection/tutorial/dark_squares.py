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
has fewer). A whole square has 2 * `step` - 1 columns or more. So each square contains a row whose
number is a multiple of `step`, and all of a block of `step` columns that starts at a multiple of
`step` (the picture's last block may be narrower). Only these rows are read. Salt, thin lines and
noise have no such blocks.
"""

from typing import List, Optional

from camera_to_base.detection.tutorial.region import apart, grow, Region
import cv2
import numpy as np

# A box takes as much time as one with this many pixels more.
_BOX_PX = 12000


class DarkSquares:
    """
    Finds boxes that contain all dark squares of a frame.

    :param limits: Shape (h, w), uint8: a median below it is dark.
    :param closing_size: Edge of the closing kernel, in px.
    :param median_reach: How far the median looks to each side, in px.
    """

    def __init__(self, limits: np.ndarray, closing_size: int, median_reach: int) -> None:
        self._shape = limits.shape
        # The rims in which two boxes can have objects do not touch.
        self._gap = 2 * median_reach + 3
        self._step = step = closing_size - closing_size // 2
        # A square can make a median dark whose limit is as far away as this from its pixels.
        reach = min(2 * (closing_size // 2) + median_reach, max(limits.shape))
        window = np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
        self._limits = np.ascontiguousarray(cv2.dilate(limits, window)[::step])
        self._block = np.ones((1, step), np.uint8)

    def boxes(self, frame: np.ndarray, rows: Optional[slice] = None) -> List[Region]:
        """
        Find the boxes.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param rows: Where to look: squares within these rows are found. None looks everywhere.
        :returns: Each square lies within a box. Between two boxes are at least twice the median's
            reach and 3 rows or columns.
        """
        start, stop = (rows.start, rows.stop) if rows else (0, len(frame))
        first, last = -(-start // self._step), -(-stop // self._step)
        if first >= last:
            return []
        rows_read = cv2.cvtColor(frame[first * self._step:stop:self._step], cv2.COLOR_BGR2GRAY)
        dark = (rows_read < self._limits[first:last]).view(np.uint8)
        count = cv2.countNonZero(dark)
        if 2 * count > dark.size:  # A search would cost more than it saves.
            return [self._box(0, 0, self._shape[1], last - first, first)]
        return self._boxes_of(dark, first) if count else []

    def _boxes_of(self, dark: np.ndarray, first: int) -> List[Region]:
        # 1 at a block's first column if all of it is dark, as what lies beyond the picture is.
        blocks = cv2.erode(dark, self._block, anchor=(0, 0),
                           borderType=cv2.BORDER_CONSTANT, borderValue=1)
        blocks = np.ascontiguousarray(blocks[:, ::self._step])
        groups, _ = cv2.findContours(blocks, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        if not groups:
            return []
        whole = self._box(*cv2.boundingRect(np.concatenate(groups)), first)
        if len(groups) * _BOX_PX > whole.px:
            return [whole]
        boxes = [self._box(*cv2.boundingRect(group), first) for group in groups]
        if sum(_BOX_PX + box.px for box in boxes) > whole.px:
            return [whole]
        return apart(boxes, self._gap)

    def _box(self, left: int, top: int, width: int, height: int, first: int) -> Region:
        """Return what the squares with some of these blocks, and no others, can cover."""
        step, beyond = self._step, self._step - 1
        start, stop = (first + top) * step, (first + top + height - 1) * step + 1
        return Region(
            grow(slice(start, stop), beyond, beyond, self._shape[0]),
            grow(slice(left * step, (left + width) * step), beyond, beyond, self._shape[1]))
