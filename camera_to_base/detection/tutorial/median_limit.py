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
Where a picture's median lies below a limit, without taking the median.

The middle of an odd number of values lies below a limit where more than half of them do. So the
pixels below it are counted in each window, which a box filter does in a fraction of the median's
time. The limit belongs to the window's centre and differs from pixel to pixel, but a box filter
needs one answer for each pixel. So there are two answers: a pixel is *surely* below if it is
below the lowest limit of all windows that it lies in, and *possibly* below if it is below the
highest of them. Where both counts give the same result, it is right; the other windows are
looked at one by one.
"""

from typing import Optional, Tuple

from camera_to_base.detection.tutorial.region import Region
import cv2
import numpy as np

# Windows' pixels that are counted one by one, at most.
_MOST_COUNTED = 4000
# Widths at which OpenCV's median is fast: from 68 px on, before OpenCV 5 those of 4 + 16 n px.
_LEAST_MEDIAN_WIDTH, _MEDIAN_STEP = 68, 16 if cv2.__version__ < '5' else 1


class MedianLimit:
    """
    Limits for the median of a picture.

    :param limits: Shape (h, w), uint8: one limit for each pixel.
    :param median_size: Edge of the median's window, in px, odd. Beyond a picture, the window
        repeats the rim, as OpenCV's median does.
    """

    def __init__(self, limits: np.ndarray, median_size: int) -> None:
        window = np.ones((median_size, median_size), np.uint8)
        self.least = int(limits.min())
        self._limits = limits
        self._lowest = cv2.erode(limits, window)
        self._highest = cv2.dilate(limits, window)
        # Memory for each frame, so that none is allocated.
        self._possibly, self._surely = np.empty((2, *limits.shape), np.uint8)
        self._size = median_size
        self._area = median_size * median_size
        # A window's count must fit.
        self._counts = np.empty(limits.shape, np.uint8 if self._area < 256 else np.uint16)

    def below(self, picture: np.ndarray, place: Region) -> Optional[np.ndarray]:
        """
        Find where the median lies below the limit.

        :param picture: Shape (h', w'), uint8: a piece of a picture of the limits' size. Its rim is
            repeated; so the result is right where the window does not reach out of the piece, and
            at a rim that is not below any limit or is the whole picture's.
        :param place: Where the piece lies.
        :returns: Shape (h', w'), uint8, 1 where it does, until the next call; None if that is
            nowhere.
        """
        possibly = self._marked(picture, self._highest, self._possibly, place)
        possible_count = cv2.countNonZero(possibly)
        if possible_count == 0:
            return None
        surely = self._marked(picture, self._lowest, self._surely, place)
        unsure_count = possible_count - cv2.countNonZero(surely)
        # Here and below: one median of all costs less than counting twice and many windows.
        if unsure_count * self._area > min(picture.size // 32, _MOST_COUNTED):
            np.less(self._median(picture), self._limits[place], out=surely.view(bool))
            return surely
        below = self._most(surely, place)
        if unsure_count:
            undecided = cv2.subtract(self._most(possibly, place), below, dst=possibly)
            undecided = np.flatnonzero(undecided.view(bool))
            if len(undecided):
                pixels = np.divmod(undecided, picture.shape[1])
                below[pixels] = self._medians_below(picture, self._limits[place], pixels)
        return below

    @staticmethod
    def _marked(
        picture: np.ndarray, limits: np.ndarray, memory: np.ndarray, place: Region
    ) -> np.ndarray:
        np.less(picture, limits[place], out=memory[place].view(bool))
        return memory[place]

    def _most(self, marked: np.ndarray, place: Region) -> np.ndarray:
        """Mark, in place, the pixels in whose window most pixels are marked."""
        counts = self._counts[place]
        cv2.boxFilter(marked, cv2.CV_16U if counts.itemsize == 2 else cv2.CV_8U,
                      (self._size, self._size), dst=counts, normalize=False,
                      borderType=cv2.BORDER_REPLICATE)
        np.greater(counts, self._area // 2, out=marked.view(bool))
        return marked

    def _medians_below(
        self, picture: np.ndarray, limits: np.ndarray, pixels: Tuple[np.ndarray, np.ndarray]
    ) -> np.ndarray:
        if len(pixels[0]) * self._area > picture.size // 6:
            return (self._median(picture) < limits)[pixels]
        reach = self._size // 2
        padded = cv2.copyMakeBorder(picture, *[reach] * 4, cv2.BORDER_REPLICATE)
        width = padded.shape[1]
        window = np.add.outer(width * np.arange(self._size), np.arange(self._size)).ravel()
        windows = padded.ravel().take(np.add.outer(width * pixels[0] + pixels[1], window))
        return np.count_nonzero(windows < limits[pixels][:, None], axis=1) > self._area // 2

    def _median(self, picture: np.ndarray) -> np.ndarray:
        # OpenCV's median is up to ten times slower at some widths. It repeats the last column; so
        # does this.
        width = picture.shape[1]
        missing = max(_LEAST_MEDIAN_WIDTH - width, (4 - width) % _MEDIAN_STEP)
        if missing:
            picture = cv2.copyMakeBorder(picture, 0, 0, 0, missing, cv2.BORDER_REPLICATE)
        return cv2.medianBlur(picture, self._size)[:, :width]
