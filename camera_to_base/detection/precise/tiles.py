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
Where a frame differs from the background at all: the only step that reads the whole frame.

Strips of the frame are first compared by one number, the largest difference of a level. In the few
strips that differ, the levels beyond the strong limit are counted, tile by tile. All of this is
done in bytes. Whatever follows works in windows around the tiles that have changed.
"""

from typing import Iterator, List, Optional, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.limits import Limits, Range
import cv2
import numpy as np

_TILE, _STRIPS = 8, 12
_LEAST_LEVELS = 3  # fewer single levels beyond the limit in a tile are noise
_MARGIN = 4
_NEARLY_ALL, _PLACES = 0.9, 30
_NEXT_TILES = np.ones((3, 3), np.uint8)
# Eight bytes are added at a time, each for itself: a tile has fewer than 256 levels.
_ONES, _TOP_BYTE = np.uint64(0x0101010101010101), np.uint64(56)
_CALM = np.uint64(3 * _TILE ** 2 - _LEAST_LEVELS)


def changed_parts(frame: np.ndarray, lit: np.ndarray, limits: Limits) -> List[Box]:
    """
    Find the parts of a frame in which it differs from the background.

    :param frame: Shape (h, w, 3), uint8, BGR, contiguous.
    :param lit: The background at the frame's light, of the same shape.
    :param limits: What is the background's own.
    :returns: Boxes around changes that are connected, a little larger than these.
    """
    changed = _changed_tiles(frame, lit, limits)
    if changed is None:
        return []
    outlines, _ = cv2.findContours(
        cv2.dilate(changed, _NEXT_TILES), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    return [_part(cv2.boundingRect(outline), frame) for outline in outlines]


def is_all_changed(frame: np.ndarray, parts: List[Box], limits: Limits) -> bool:
    """
    Tell whether nothing of the background is seen: a covered lens, another scene, no light.

    :param parts: See :func:`changed_parts`; the frame is read only if one is nearly all of it.
    """
    size = frame.shape[0] * frame.shape[1]
    if not any(part.width * part.height > _NEARLY_ALL * size for part in parts):
        return False
    rows, columns = (slice(None, None, max(length // _PLACES, 1)) for length in frame.shape[:2])
    usual = limits.strong((slice(0, len(frame)),))
    places = (np.ascontiguousarray(levels[rows, columns]) for levels in (frame, *usual))
    inside = cv2.inRange(*places)
    return cv2.countNonZero(inside) < (1 - _NEARLY_ALL) * inside.size


def frame_outline(frame: np.ndarray) -> np.ndarray:
    """Give the outline of a whole frame, shape (4, 1, 2), int32, in px."""
    bottom, right = frame.shape[0] - 1, frame.shape[1] - 1
    return np.int32([[[0, 0]], [[0, bottom]], [[right, bottom]], [[right, 0]]])


def _part(tiles: Tuple[int, int, int, int], frame: np.ndarray) -> Box:
    # The tiles are one more to each side than have changed, where the frame goes on.
    x, y, width, height = tiles
    less = _TILE - _MARGIN
    left, top = (max(first * _TILE - less, 0) for first in (x, y))
    right, bottom = (length if end * _TILE >= length else end * _TILE - less for end, length in (
        (x + width, frame.shape[1]), (y + height, frame.shape[0])))
    return Box(left, top, right - left, bottom - top)


def _changed_tiles(frame: np.ndarray, lit: np.ndarray, limits: Limits) -> Optional[np.ndarray]:
    changed = None
    for rows in _changed_strips(frame, lit, -1 if limits.has_field else limits.least):
        if changed is None:
            changed = np.zeros([-(-length // _TILE) for length in frame.shape[:2]], np.uint8)
        tiles = _tiles(frame[rows], limits.strong((rows,)))
        first = rows.start // _TILE
        changed[first:first + len(tiles)] = tiles
    return changed


def _changed_strips(frame: np.ndarray, lit: np.ndarray, least: float) -> Iterator[slice]:
    height = len(frame)
    step = max(height // _STRIPS // _TILE, 1) * _TILE
    first = None
    for start in range(0, height, step):
        rows = slice(start, start + step)
        if cv2.norm(frame[rows], lit[rows], cv2.NORM_INF) > least:
            first = start if first is None else first
        elif first is not None:
            yield slice(first, start)
            first = None
    if first is not None:
        yield slice(first, height)


def _tiles(frame: np.ndarray, usual: Range) -> np.ndarray:
    # Channel by channel: OpenCV compares single bytes faster than triples.
    height, width = len(frame), 3 * frame.shape[1]
    rows, columns = -(-height // _TILE), -(-width // (3 * _TILE))
    size = rows * _TILE, columns * 3 * _TILE
    inside = np.empty(size, np.uint8) if size == (height, width) else np.full(size, 255, np.uint8)
    cv2.inRange(*(levels.reshape(height, width) for levels in (frame, *usual)),
                dst=inside[:height, :width])
    lanes = np.add.reduce((inside.view(np.uint64) & _ONES).reshape(rows, _TILE, -1), axis=1)
    lanes = lanes.reshape(rows, columns, 3)
    calm = (lanes[..., 0] + lanes[..., 1] + lanes[..., 2]) * _ONES >> _TOP_BYTE
    return calm <= _CALM
