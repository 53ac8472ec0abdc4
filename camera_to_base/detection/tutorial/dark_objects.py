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
The outlines of the objects that are darker than the background, from the boxes around them.

Closed alone, a box of all dark squares gives the whole picture's result, as if all around it were
white. Boxes that do not reach the picture's edge are processed together, side by side.
"""

from typing import List, NamedTuple

from camera_to_base.detection.tutorial.median import Median
from camera_to_base.detection.tutorial.region import grow, Region, within
from camera_to_base.detection.tutorial.strip import Strip
import cv2
import numpy as np


class _Piece(NamedTuple):
    box: Region
    place: Region  # with the rim in which the box can have objects


class DarkObjects:
    """
    Finds the objects in boxes.

    :param limits: Shape (h, w), uint8: an object is where the median is below.
    :param closing_size: Edge of the closing kernel, in px.
    :param median: The median filter.
    """

    def __init__(self, limits: np.ndarray, closing_size: int, median: Median) -> None:
        self._limits = limits
        self._lowest_limit = int(limits.min())
        self._kernel = np.ones((closing_size, closing_size), np.uint8)
        self._median = median
        # The even kernel moves the closed picture by 1 px to the lower right, and the median looks
        # further by its reach. A box needs a white rim, except where the picture ends.
        self._before, self._after = max(median.reach, 1), median.reach + 1
        # Memory for each frame, so that none is allocated.
        self._grey = np.empty(limits.size, np.uint8)

    def outlines(self, frame: np.ndarray, boxes: List[Region]) -> List[np.ndarray]:
        """
        Find the outer outlines.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param boxes: As `DarkSquares` finds them.
        :returns: Arrays of shape (n, 1, 2), int32, in OpenCV's order: from the bottom to the top,
            as the rows of the objects' first pixels follow.
        """
        outlines = [outline for pieces in self._together(boxes)
                    for outline in self._outlines_of(frame, pieces)]
        if len(boxes) > 1:
            outlines.sort(key=lambda outline: outline[0, 0, ::-1].tolist(), reverse=True)
        return outlines

    def _together(self, boxes: List[Region]) -> List[List[_Piece]]:
        """Return the pieces that are processed together."""
        pieces = [_Piece(box, Region(*(grow(part, self._before, self._after, length)
                                       for part, length in zip(box, self._limits.shape))))
                  for box in boxes]
        inner = [piece for piece in pieces if self._has_rim(piece)]
        if len(inner) < 2 or not self._fits(Strip([piece.place for piece in inner])):
            return [[piece] for piece in pieces]
        return [inner, *([piece] for piece in pieces if piece not in inner)]

    def _has_rim(self, piece: _Piece) -> bool:
        rim = self._before + self._after
        return all(with_rim == size + rim for with_rim, size in zip(
            piece.place.shape, piece.box.shape))

    def _fits(self, strip: Strip) -> bool:
        """Tell whether a strip has few pixels that belong to no piece, and memory."""
        return strip.px <= min(2 * sum(part.px for part in strip.parts), self._grey.size)

    def _outlines_of(self, frame: np.ndarray, pieces: List[_Piece]) -> List[np.ndarray]:
        strip = Strip([piece.place for piece in pieces])
        grey = self._grey[:strip.px].reshape(strip.shape)
        if pieces[0].box != pieces[0].place:
            grey[:] = 255
        for piece, part in zip(pieces, strip.parts):
            cv2.cvtColor(frame[piece.box], cv2.COLOR_BGR2GRAY,
                         dst=grey[part][within(piece.box, piece.place)])
        if strip.shape == self._limits.shape and self._is_dark(grey):
            return strip.outlines(np.ones_like(grey))
        closed = cv2.morphologyEx(grey, cv2.MORPH_CLOSE, self._kernel, dst=grey)
        smooth = self._median.blur(closed)
        dark = np.less(smooth, strip.cut(self._limits), out=smooth.view(bool))
        return strip.outlines(dark.view(np.uint8))

    def _is_dark(self, grey: np.ndarray) -> bool:
        """Tell whether no step can make a pixel light, as none makes one lighter than all are."""
        return all(part.max() < self._lowest_limit for part in (grey[::16], grey))
