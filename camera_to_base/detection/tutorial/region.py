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

"""Rectangles of a picture: how they grow, which of them meet, what they contain."""

from typing import Iterable, List, NamedTuple, Tuple


class Region(NamedTuple):
    """Rows and columns of a picture, in px; `picture[region]` is the piece."""

    rows: slice
    columns: slice

    @property
    def shape(self) -> Tuple[int, int]:
        """Numbers of rows and columns."""
        return (self.rows.stop - self.rows.start, self.columns.stop - self.columns.start)

    @property
    def px(self) -> int:
        """Number of pixels."""
        rows, columns = self.shape
        return rows * columns

    def is_near(self, other: 'Region', gap: int) -> bool:
        """Tell whether fewer than `gap` rows and fewer than `gap` columns lie between two."""
        return (self.rows.start < other.rows.stop + gap
                and other.rows.start < self.rows.stop + gap
                and self.columns.start < other.columns.stop + gap
                and other.columns.start < self.columns.stop + gap)


def grow(part: slice, before: int, after: int, length: int) -> slice:
    """Grow a range by some px at each end, within a side of `length` px."""
    return slice(max(part.start - before, 0), min(part.stop + after, length))


def round_up(part: slice, step: int, length: int) -> slice:
    """Grow a range to a whole number of steps of px, within a side of `length` px."""
    size = min(-(-(part.stop - part.start) // step) * step, length)
    start = min(part.start, length - size)
    return slice(start, start + size)


def within(inner: Region, outer: Region) -> Region:
    """Return where a region lies in a piece cut out of the picture."""
    return Region(*(slice(part.start - whole.start, part.stop - whole.start)
                    for part, whole in zip(inner, outer)))


def around(regions: Iterable[Region]) -> Region:
    """Return the smallest region that contains all of some."""
    return Region(*(slice(min(part.start for part in side), max(part.stop for part in side))
                    for side in zip(*regions)))


def apart(regions: Iterable[Region], gap: int) -> List[Region]:
    """Put regions that are near each other into one, until `gap` px lie between any two."""
    found: List[Region] = []
    for region in regions:
        near = [other for other in found if region.is_near(other, gap)]
        while near:
            found = [other for other in found if other not in near]
            region = around([region, *near])
            near = [other for other in found if region.is_near(other, gap)]
        found.append(region)
    return found
