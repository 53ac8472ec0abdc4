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
Where a frame differs from the background at all: the early exit of both detectors.

Reading a frame once is about as fast as anything can be. Both detectors start with it, and give a
second look only to the rows and columns between the first change and the last.
"""

from typing import Iterable, List, NamedTuple, Optional

import cv2
import numpy as np

# Where blocks of rows end, as parts of the whole: more of them end closer to an object, but each
# costs a call. The thin ones at both ends tell at once that everything changed.
_BLOCK_ENDS = 0, 1 / 60, 1 / 6, 1 / 3, 1 / 2, 2 / 3, 5 / 6, 59 / 60, 1
# The block with the first change is searched again in steps of so many rows.
_STEP = 12


class Region(NamedTuple):
    """Rows and columns of a picture, in px; what is outside has not changed."""

    rows: slice
    columns: slice


class Background:
    """
    The reference picture that frames are compared with.

    :param picture: Shape (h, w, 3), uint8, BGR; it must not be changed afterwards.
    """

    def __init__(self, picture: np.ndarray) -> None:
        self.picture = picture
        self.grey = cv2.cvtColor(self.picture, cv2.COLOR_BGR2GRAY)

    def changed_region(
        self, frame: np.ndarray, threshold: float, margin: int, grey: np.ndarray
    ) -> Optional[Region]:
        """
        Find the part of a frame that holds every pixel which differs in grey.

        The colours are compared first, as they are. Grey is a mean with weights that are not
        negative and add up to 1, rounded; so where no colour differs by more than the threshold,
        grey does not either.

        :param frame: Shape (h, w, 3) as the picture, uint8, BGR.
        :param threshold: Grey levels; a pixel that differs by more has changed.
        :param margin: How many rows around the changed ones are wanted in grey, too.
        :param grey: Shape (h, w), uint8: takes these rows of the frame in grey.
        :returns: None where no pixel has changed.
        """
        height, width = self.grey.shape
        rows = changed_rows(frame, self.picture, threshold)
        if rows is None:
            return None
        band = grow(rows, margin, margin, height)
        cv2.cvtColor(frame[band], cv2.COLOR_BGR2GRAY, dst=grey[band])
        if rows.stop - rows.start > height // 2:
            # Hardly worth a look: the steps' time depends on the rows more than on the columns.
            return Region(rows, slice(0, width))
        difference = cv2.absdiff(grey[rows], self.grey[rows])
        columns = np.flatnonzero(difference.max(axis=0) > threshold)
        return Region(rows, slice(int(columns[0]), int(columns[-1]) + 1)) if len(columns) else None


def changed_rows(
    frame: np.ndarray, picture: np.ndarray, threshold: float, exact: bool = True
) -> Optional[slice]:
    """
    Find the rows between the first and the last pixel in which two pictures differ.

    From both ends inwards, up to the first block with a change, and once more within that block:
    a frame in which nothing changed is read once, and one in which everything changed is hardly
    read at all.

    :param frame: Shape (h, w, 3), uint8.
    :param picture: Of the same shape.
    :param threshold: Grey levels; a channel that differs by more has changed.
    :param exact: Whether the second look within a block is worth its time.
    :returns: None where nothing has.
    """
    ends = [int(end * len(picture)) for end in _BLOCK_ENDS]
    blocks = [slice(*pair) for pair in zip(ends, ends[1:]) if pair[0] < pair[1]]

    def first_changed(parts: Iterable[slice]) -> Optional[slice]:
        for rows in parts:
            if cv2.norm(frame[rows], picture[rows], cv2.NORM_INF) > threshold:
                return rows
        return None

    first = first_changed(blocks)
    if first is None:
        return None
    last = first_changed(reversed(blocks))
    if not exact:
        return slice(first.start, last.stop)
    return slice(first_changed(_steps(first)).start,
                 first_changed(reversed(_steps(last))).stop)


def grow(part: slice, before: int, after: int, length: int) -> slice:
    """Grow a range by some px at each end, as far as a side of `length` px goes."""
    return slice(max(part.start - before, 0), min(part.stop + after, length))


def round_up(part: slice, step: int, length: int) -> slice:
    """Grow a range to a whole number of steps of px, as far as a side of `length` px goes."""
    size = min(-(-(part.stop - part.start) // step) * step, length)
    start = min(part.start, length - size)
    return slice(start, start + size)


def _steps(part: slice) -> List[slice]:
    return [slice(start, min(start + _STEP, part.stop))
            for start in range(part.start, part.stop, _STEP)]
