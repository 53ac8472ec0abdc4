# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Where a frame differs from the background: its rows first, then the tiles in these rows.

Strips of the frame are compared by one number, the largest difference of a level. Most objects lie
still: where the last frame differed, this one is taken to differ, too, and the strips in between
are compared at once. This changes the time, not the result.

All of this is done in bytes. Whatever follows works in windows around the tiles that have changed.
"""

from itertools import groupby
from typing import Iterable, List, Sequence, Set, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.reference import LevelLimits
import cv2
import numpy as np

TILE = 8
_STRIPS = 20

_MARGIN, _FEW = 4, 0.15
_MOST_CHANGED, _PLACES = 0.75, 30
_NEXT_TILES = np.ones((3, 3), np.uint8)
# So many levels are still in a core's cache at the next step.
_BYTES_AT_ONCE = 300_000


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

    def changed(self, frame: np.ndarray, lit: np.ndarray, limits: LevelLimits) -> List[slice]:
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
            if was_changed:
                changed += numbers
            elif not self._is_calm(numbers, frame, lit, limits):
                changed += [number for number in numbers
                            if not self._is_calm((number,), frame, lit, limits)]
        if len(changed) == len(self._numbers):
            # Nothing is assumed then: the detector asks whether all strips differ.
            changed = [number for number in changed if number not in self._last
                       or not self._is_calm((number,), frame, lit, limits)]
        return [self._rows(numbers) for numbers in _joined(changed)]

    def remember(self, parts: Iterable[Box]) -> None:
        """Take note of the parts in which the last frame differed."""
        self._last = {number for part in parts for number in range(
            part.y // self._step, (part.y + part.height - 1) // self._step + 1)}

    def _is_calm(
        self, numbers: Sequence[int], frame: np.ndarray, lit: np.ndarray, limits: LevelLimits
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


def is_all_changed(
    frame: np.ndarray, lit: np.ndarray, strips: List[slice], limits: LevelLimits
) -> bool:
    """
    Tell whether hardly anything of the background is seen: a covered lens, another scene.

    :param strips: The rows that differ; the frame is read only if these are all of it.
    """
    if sum(rows.stop - rows.start for rows in strips) < len(frame):
        return False
    rows, columns = (slice(None, None, max(length // _PLACES, 1)) for length in frame.shape[:2])
    calm = cv2.inRange(cv2.absdiff(*(np.ascontiguousarray(picture[rows, columns])
                                     for picture in (frame, lit))), 0, (limits.least,) * 3)
    return cv2.countNonZero(calm) < (1 - _MOST_CHANGED) * calm.size


def changed_parts(
    frame: np.ndarray, lit: np.ndarray, strips: List[slice], limits: LevelLimits
) -> List[Box]:
    """
    Find the parts of a frame in which it differs from the background.

    :param strips: The rows that differ, see :class:`Strips`.
    :returns: Boxes around changes that are connected, a little larger than these.
    """
    if not strips:
        return []
    found = _changed_tiles(frame, lit, strips, limits)
    # From the row of tiles above the first one to that below the last one.
    top = max(strips[0].start // TILE - 1, 0)
    changed = np.zeros((-(-strips[-1].stop // TILE) + 1 - top, found.shape[1]), np.uint8)
    start = 0
    for rows in strips:
        first, stop = rows.start // TILE, -(-rows.stop // TILE)
        changed[first - top:stop - top] = found[start:start + stop - first]
        start += stop - first
    outlines, _ = cv2.findContours(cv2.dilate(changed, _NEXT_TILES), cv2.RETR_EXTERNAL,
                                   cv2.CHAIN_APPROX_SIMPLE, offset=(0, top))
    return [_part(*cv2.boundingRect(outline), frame.shape) for outline in outlines]


def frame_outline(frame: np.ndarray) -> np.ndarray:
    """Give the outline of a whole frame, shape (4, 1, 2), int32, in px."""
    bottom, right = frame.shape[0] - 1, frame.shape[1] - 1
    return np.int32([[[0, 0]], [[0, bottom]], [[right, bottom]], [[right, 0]]])


def _part(x: int, y: int, across: int, down: int, shape: Tuple[int, ...]) -> Box:
    # The tiles are one more to each side than have changed, where the frame goes on.
    less = TILE - _MARGIN
    left, top = x and x * TILE + less, y and y * TILE + less
    right, bottom = (x + across) * TILE, (y + down) * TILE
    return Box(left, top, (shape[1] if right >= shape[1] else right - less) - left,
               (shape[0] if bottom >= shape[0] else bottom - less) - top)


def _changed_tiles(
    frame: np.ndarray, lit: np.ndarray, strips: List[slice], limits: LevelLimits
) -> np.ndarray:
    """Tell which tiles have changed: one row for each row of tiles in the strips."""
    places = _cut(strips, frame.shape[1])
    changed = _tiles_above(limits.least, (
        cv2.absdiff(_by_row(frame[rows]), _by_row(lit[rows])) for rows in places))
    if np.count_nonzero(changed) < _FEW * changed.size:
        return changed
    # Edges of a table whose picture trembles: the limits at each place know them.
    limits.mark(frame)
    return _tiles_with([limits.strong(frame, (rows, slice(None))) for rows in strips])


def _cut(strips: List[slice], width: int) -> List[slice]:
    step = max(_BYTES_AT_ONCE // (3 * width * TILE), 1) * TILE
    return [slice(start, min(start + step, rows.stop))
            for rows in strips for start in range(rows.start, rows.stop, step)]


def _by_row(picture: np.ndarray) -> np.ndarray:
    # Channel by channel: OpenCV compares single bytes faster than triples.
    return picture.reshape(len(picture), -1)


def _tiles_above(least: float, chunks: Iterable[np.ndarray]) -> np.ndarray:
    """Tell in which tiles a level is above a limit, shape (rows of tiles, columns)."""
    largest = np.concatenate([_largest_in_tile_rows(levels, 3 * TILE) for levels in chunks])
    # Eight bytes at a time.
    above = (largest > int(least)).view(np.uint64).reshape(len(largest), -1, 3)
    return (above[..., 0] | above[..., 1] | above[..., 2]) != 0


def _tiles_with(chunks: Iterable[np.ndarray]) -> np.ndarray:
    """Tell in which tiles something is marked, see :func:`_tiles_above`."""
    return np.concatenate([_largest_in_tile_rows(marks, TILE) for marks in chunks]).view(
        np.uint64) != 0


def _largest_in_tile_rows(levels: np.ndarray, across: int) -> np.ndarray:
    height, width = levels.shape
    missing = -height % TILE, -width % across
    if any(missing):
        levels = cv2.copyMakeBorder(
            levels, 0, missing[0], 0, missing[1], cv2.BORDER_CONSTANT, value=0)
    return levels.reshape(len(levels) // TILE, TILE, -1).max(axis=1)
