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

"""Rectangles of a picture: how they grow, what they contain, which of them share rows."""

from typing import Iterable, List, NamedTuple


class Region(NamedTuple):
    """Rows and columns of a picture, in px; `picture[region]` is the piece."""

    rows: slice
    columns: slice

    @property
    def px(self) -> int:
        """Number of pixels."""
        return (self.rows.stop - self.rows.start) * (self.columns.stop - self.columns.start)


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


def row_bands(regions: Iterable[Region]) -> List[Region]:
    """
    Put regions that share rows into one.

    :param regions: At least one.
    :returns: From top to bottom, with at least one row between two of them.
    """
    bands: List[Region] = []
    for region in sorted(regions, key=lambda region: region.rows.start):
        if bands and region.rows.start <= bands[-1].rows.stop:
            bands[-1] = Region(*(slice(min(part.start, other.start), max(part.stop, other.stop))
                                 for part, other in zip(bands[-1], region)))
        else:
            bands.append(region)
    return bands
