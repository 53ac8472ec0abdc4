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
Finds the part of a frame that differs from the background: the early exit of both detectors.

Both detectors first read the frame once, which is fast. Then they process only the rows and
columns between the first and the last change.
"""

from typing import Iterable, List, NamedTuple, Optional

import cv2
import numpy as np

# Ends of the blocks of rows, as parts of the whole. More blocks end closer to an object, but each
# costs a call. The thin blocks at both ends show quickly that everything has changed.
_BLOCK_ENDS = 0, 1 / 60, 1 / 6, 1 / 3, 1 / 2, 2 / 3, 5 / 6, 59 / 60, 1
# The block with the first change is searched again in steps of this many rows.
_STEP = 12


class Region(NamedTuple):
    """Rows and columns of a picture, in px; nothing outside has changed."""

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
        Find the part of a frame that contains all pixels that differ in grey.

        The colours are compared first. Grey is their rounded mean, with weights that are not
        negative and add up to 1. So if no colour differs by more than the threshold, grey does not
        either.

        :param frame: Shape (h, w, 3) as the picture, uint8, BGR.
        :param threshold: Grey levels; a pixel that differs by more has changed.
        :param margin: Number of rows around the changed ones that are also converted to grey.
        :param grey: Shape (h, w), uint8: receives these rows of the frame in grey.
        :returns: None if no pixel has changed.
        """
        height, width = self.grey.shape
        rows = changed_rows(frame, self.picture, threshold)
        if rows is None:
            return None
        band = grow(rows, margin, margin, height)
        cv2.cvtColor(frame[band], cv2.COLOR_BGR2GRAY, dst=grey[band])
        if rows.stop - rows.start > height // 2:
            # Not worth a search: the steps' time depends more on the rows than on the columns.
            return Region(rows, slice(0, width))
        difference = cv2.absdiff(grey[rows], self.grey[rows])
        columns = np.flatnonzero(difference.max(axis=0) > threshold)
        return Region(rows, slice(int(columns[0]), int(columns[-1]) + 1)) if len(columns) else None


def changed_rows(
    frame: np.ndarray, picture: np.ndarray, threshold: float, exact: bool = True
) -> Optional[slice]:
    """
    Find the rows between the first and the last pixel in which two pictures differ.

    The search goes from both ends inwards to the first block with a change, then through that
    block: a frame without a change is read once, and a frame that changed everywhere is hardly
    read at all.

    :param frame: Shape (h, w, 3), uint8.
    :param picture: Of the same shape.
    :param threshold: Grey levels; a channel that differs by more has changed.
    :param exact: Whether the second search within a block is worth its time.
    :returns: None if nothing has changed.
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
    """Grow a range by some px at each end, within a side of `length` px."""
    return slice(max(part.start - before, 0), min(part.stop + after, length))


def round_up(part: slice, step: int, length: int) -> slice:
    """Grow a range to a whole number of steps of px, within a side of `length` px."""
    size = min(-(-(part.stop - part.start) // step) * step, length)
    start = min(part.start, length - size)
    return slice(start, start + size)


def _steps(part: slice) -> List[slice]:
    return [slice(start, min(start + _STEP, part.stop))
            for start in range(part.start, part.stop, _STEP)]
