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
Pieces of a picture, side by side in one: each step is one call for all of them.

Most of the time that a small piece takes is the call's own, and OpenCV's filters are faster on
long rows.
"""

from bisect import bisect_right
from itertools import accumulate
from typing import List

from camera_to_base.detection.detection import find_outlines
from camera_to_base.detection.tutorial.region import Region
import numpy as np


class Strip:
    """
    Some places of a picture from left to right, each from the first row on.

    :param places: At least one; they have no pixel in common.
    """

    def __init__(self, places: List[Region]) -> None:
        heights, widths = zip(*(place.shape for place in places))
        self.shape = max(heights), sum(widths)
        self.px = self.shape[0] * self.shape[1]
        self._places = places
        self._ends = list(accumulate(widths))
        self.parts = [Region(slice(0, height), slice(end - width, end))
                      for height, width, end in zip(heights, widths, self._ends)]

    def cut(self, picture: np.ndarray) -> np.ndarray:
        """
        Cut the places out of a picture of shape (h, w).

        :returns: Of the strip's shape, with 0 below the lower pieces; a view if there is one only.
        """
        if len(self._places) == 1:
            return picture[self._places[0]]
        pieces = np.zeros(self.shape, picture.dtype)
        for place, part in zip(self._places, self.parts):
            pieces[part] = picture[place]
        return pieces

    def outlines(self, mask: np.ndarray) -> List[np.ndarray]:
        """
        Find the outer outlines in a mask of the strip.

        :param mask: Nothing in it touches the next piece.
        :returns: One array of shape (n, 1, 2), int32, for each object, in px of the picture.
        """
        if len(self._places) == 1:
            rows, columns = self._places[0]
            return find_outlines(mask, columns.start, rows.start)
        outlines = find_outlines(mask, 0, 0)
        for outline in outlines:
            index = bisect_right(self._ends, outline[0, 0, 0])
            place, part = self._places[index], self.parts[index]
            outline[:, 0, 0] += place.columns.start - part.columns.start
            outline[:, 0, 1] += place.rows.start
        return outlines
