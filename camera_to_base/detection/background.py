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
Finds the rows of a frame that differ from the background: the early exit of both detectors.

Reading a frame once is fast. Then a detector processes only the rows between the first and the
last change.
"""

from typing import Iterable, List, Optional

import cv2
import numpy as np

# Ends of the blocks of rows, as parts of the whole. More blocks end closer to an object, but each
# costs a call. The thin blocks at both ends show quickly that everything has changed.
_BLOCK_ENDS = 0, 1 / 60, 1 / 6, 1 / 3, 1 / 2, 2 / 3, 5 / 6, 59 / 60, 1
# The block with the first change is searched again in steps of this many rows.
_STEP = 12


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


def _steps(part: slice) -> List[slice]:
    return [slice(start, min(start + _STEP, part.stop))
            for start in range(part.start, part.stop, _STEP)]
