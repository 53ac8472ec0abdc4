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
Which rows of a frame differ from the background: the only step that reads the whole frame.

Strips of the frame are compared by one number, the largest difference of a level. Most objects lie
still: where the last frame differed, this one is taken to differ, too, and the strips in between
are compared at once. This changes the time, not the result.
"""

from itertools import groupby
from typing import Iterable, List, Sequence, Set, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.limits import Limits
import cv2
import numpy as np

TILE = 8
_STRIPS = 20


class Strips:
    """
    Finds the rows in which frames differ from a background.

    :param shape: The frames' shape, (h, w, 3).
    """

    def __init__(self, shape: Tuple[int, ...]) -> None:
        self._height = shape[0]
        self._step = max(shape[0] // _STRIPS // TILE, 1) * TILE
        self._numbers = range(-(-shape[0] // self._step))
        self._last: Set[int] = set()

    def changed(self, frame: np.ndarray, lit: np.ndarray, limits: Limits) -> List[slice]:
        """
        Find the rows in which a frame differs, or the last one did.

        :param frame: Shape (h, w, 3), uint8, BGR, contiguous.
        :param lit: The background at the frame's light, of the same shape.
        :param limits: What is the background's own.
        :returns: From top to bottom, each of whole tiles but for the last.
        """
        changed: List[int] = []
        for was_changed, run in groupby(self._numbers, self._last.__contains__):
            numbers = list(run)
            # Where all strips differed nothing is assumed: the detector asks whether all do.
            if was_changed and len(numbers) < len(self._numbers):
                changed += numbers
            elif was_changed or not self._is_calm(numbers, frame, lit, limits):
                changed += [number for number in numbers
                            if not self._is_calm((number,), frame, lit, limits)]
        return [self._rows(numbers) for numbers in _joined(changed)]

    def remember(self, parts: Iterable[Box]) -> None:
        """Take note of the parts in which the last frame differed."""
        self._last = {number for part in parts for number in range(
            part.y // self._step, (part.y + part.height - 1) // self._step + 1)}

    def _is_calm(
        self, numbers: Sequence[int], frame: np.ndarray, lit: np.ndarray, limits: Limits
    ) -> bool:
        rows = self._rows(numbers)
        return cv2.norm(frame[rows], lit[rows], cv2.NORM_INF) <= limits.least

    def _rows(self, numbers: Sequence[int]) -> slice:
        return slice(numbers[0] * self._step,
                     min((numbers[-1] + 1) * self._step, self._height))


def _joined(numbers: Iterable[int]) -> List[List[int]]:
    joined: List[List[int]] = []
    for number in numbers:
        if joined and joined[-1][-1] == number - 1:
            joined[-1].append(number)
        else:
            joined.append([number])
    return joined
