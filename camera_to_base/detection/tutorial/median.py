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
OpenCV's median filter, in less time: it is slow on short rows, and on some widths.

OpenCV takes the first and last pixels of each row one by one, which can cost as much as 700 pixels
within. So pieces of a picture are put side by side, which makes fewer and longer rows.
"""

import cv2
import numpy as np

_LONG_ROW, _MOST_PIECES = 1200, 4
# Before OpenCV 5, the widths of 4 + 16 n px are fast.
_FAST_WIDTH, _WIDTH_STEP = 4, 1 if cv2.__version__ >= '5' else 16


class Median:
    """
    A median filter that keeps its memory from picture to picture.

    :param size: Edge of the median's window, in px, odd.
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self.reach = size // 2
        self._memory = np.empty((2, 0), np.uint8)

    def blur(self, picture: np.ndarray) -> np.ndarray:
        """
        Return a picture's median, pixel by pixel that of cv2.medianBlur.

        :param picture: Shape (h, w), uint8. It may be overwritten.
        :returns: Of the same shape, until the next call.
        """
        (height, width), reach = picture.shape, self.reach
        if width >= _LONG_ROW and (_FAST_WIDTH - width) % _WIDTH_STEP == 0:
            return cv2.medianBlur(picture, self._size, dst=self._two_pictures(height, width)[0])
        pieces = min(_MOST_PIECES, height // (3 * self._size)) or 1
        rows, columns = -(-height // pieces), width + 2 * reach
        beyond = (_FAST_WIDTH - pieces * columns) % _WIDTH_STEP
        wide, smooth = self._two_pictures(rows + 2 * reach, pieces * columns + beyond)
        # The last piece may have rows of the one before it.
        tops = [min(piece * rows, height - rows) for piece in range(pieces)]
        for top, left in zip(tops, range(0, wide.shape[1], columns)):
            first, stop = max(top - reach, 0), min(top + rows + reach, height)
            cv2.copyMakeBorder(
                picture[first:stop], reach - (top - first), top + rows + reach - stop, reach,
                reach, cv2.BORDER_REPLICATE, dst=wide[:, left:left + columns])
        cv2.medianBlur(wide, self._size, dst=smooth)
        for top, left in zip(tops, range(reach, wide.shape[1], columns)):
            picture[top:top + rows] = smooth[reach:reach + rows, left:left + width]
        return picture

    def _two_pictures(self, height: int, width: int) -> np.ndarray:
        if self._memory.shape[1] < height * width:
            self._memory = np.empty((2, height * width), np.uint8)
        return self._memory[:, :height * width].reshape(2, height, width)
