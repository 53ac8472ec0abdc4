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
Whether a frame can be lighter than the background after closing and median: a look at its maxima.

Closing and median choose among the pixels around. So the result is above a limit only near a pixel
that is above it. Grey does not fall when a colour rises: the grey of the largest blue, the largest
green and the largest red in some rows is not below the grey of any pixel there. So one value for
each column and each block of rows is compared with the lowest limit around.
"""

import cv2
import numpy as np

_ROWS = 30


class LightBlocks:
    """
    Looks for pixels that are lighter than a limit around them.

    :param limits: Shape (h, w), uint8: a median above it is light.
    :param reach: How far away a median can be that a pixel makes light, in px.
    """

    def __init__(self, limits: np.ndarray, reach: int) -> None:
        reach = min(reach, max(limits.shape))
        around = np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)
        self._limits = _blocks(np.minimum, cv2.erode(limits, around))

    def has_light(self, frame: np.ndarray, rows: slice) -> bool:
        """
        Return whether there may be such a pixel.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param rows: Where to look. All rows of the blocks that they belong to are read.
        """
        first, stop = rows.start // _ROWS, -(-rows.stop // _ROWS)
        highest = _blocks(np.maximum, frame[first * _ROWS:stop * _ROWS])
        return bool((cv2.cvtColor(highest, cv2.COLOR_BGR2GRAY) > self._limits[first:stop]).any())


def _blocks(choose: np.ufunc, picture: np.ndarray) -> np.ndarray:
    """Reduce each block of rows to one; shape (blocks, w, ...)."""
    flat = np.ascontiguousarray(picture).reshape(len(picture), -1)
    count = len(flat) // _ROWS
    blocks = choose.reduce(flat[:count * _ROWS].reshape(count, _ROWS, flat.shape[1]), axis=1)
    if len(flat) > count * _ROWS:
        blocks = np.vstack([blocks, choose.reduce(flat[count * _ROWS:], axis=0)])
    return blocks.reshape(-1, *picture.shape[1:])
