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

"""Remembers where something was told to be the old place of an object that has left."""

from collections import deque
from typing import Deque, Iterable, Tuple

from camera_to_base.detection import Box, Detection

# On a table with a strong pattern, one frame tells less of an old place than the next one does.
_MEMORY_S = 1.0
# What is larger than an old place, as a factor on its area, is an object.
_LARGER = 1.5


class Remains:
    """
    Tells which objects appear where an old place was told less than a second ago.

    What is told by this memory alone is not remembered: an object that is laid there is left out
    for a second at most.
    """

    def __init__(self) -> None:
        self._places: Deque[Tuple[float, Detection]] = deque()

    def note(self, told: Iterable[Detection], taken_at: float) -> None:
        """
        Remember what a frame shows of old places.

        :param taken_at: In s.
        """
        while self._places and not 0 <= taken_at - self._places[0][0] <= _MEMORY_S:
            self._places.popleft()
        self._places.extend((taken_at, one) for one in told)

    def may_be_part(self, one: Detection) -> bool:
        """Tell whether an object overlaps a place that is remembered, and is not much larger."""
        return any(one.area <= _LARGER * place.area and _overlap(one.box, place.box)
                   for _, place in self._places)


def _overlap(one: Box, other: Box) -> bool:
    return (one.x < other.x + other.width and other.x < one.x + one.width
            and one.y < other.y + other.height and other.y < one.y + one.height)
