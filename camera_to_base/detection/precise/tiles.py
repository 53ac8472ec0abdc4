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

from typing import List, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.limits import Limits
import cv2
import numpy as np

_TILE, _STRIPS = 8, 12
_LEAST_LEVELS = np.uint64(3)  # fewer single levels beyond the limit in a tile are noise
_MARGIN, _FEW = 4, 0.15
_MOST_CHANGED, _PLACES = 0.75, 30
_NEXT_TILES = np.ones((3, 3), np.uint8)
_ONES, _TOP_BYTE = np.uint64(0x0101010101010101), np.uint64(56)


def changed_strips(frame: np.ndarray, lit: np.ndarray, limits: Limits) -> List[slice]:
    """
    Find the rows in which a frame differs from the background.

    :param frame: Shape (h, w, 3), uint8, BGR, contiguous.
    :param lit: The background at the frame's light, of the same shape.
    :param limits: What is the background's own.
    """
    if limits.has_field:
        return [slice(0, len(frame))]
    step = max(len(frame) // _STRIPS // _TILE, 1) * _TILE
    strips: List[slice] = []
    for start in range(0, len(frame), step):
        rows = slice(start, min(start + step, len(frame)))
        if cv2.norm(frame[rows], lit[rows], cv2.NORM_INF) > limits.least:
            goes_on = strips and strips[-1].stop == start
            strips.append(slice(strips.pop().start, rows.stop) if goes_on else rows)
    return strips


def is_all_changed(
    frame: np.ndarray, lit: np.ndarray, strips: List[slice], limits: Limits
) -> bool:
    """
    Tell whether hardly anything of the background is seen: a covered lens, another scene.

    :param strips: See :func:`changed_strips`; the frame is read only if this is all of it.
    """
    if strips != [slice(0, len(frame))]:
        return False
    rows, columns = (slice(None, None, max(length // _PLACES, 1)) for length in frame.shape[:2])
    calm = cv2.inRange(cv2.absdiff(*(np.ascontiguousarray(picture[rows, columns])
                                     for picture in (frame, lit))), 0, (limits.least,) * 3)
    return cv2.countNonZero(calm) < (1 - _MOST_CHANGED) * calm.size


def changed_parts(
    frame: np.ndarray, lit: np.ndarray, strips: List[slice], limits: Limits
) -> List[Box]:
    """
    Find the parts of a frame in which it differs from the background.

    :param strips: See :func:`changed_strips`.
    :returns: Boxes around changes that are connected, a little larger than these.
    """
    if not strips:
        return []
    changed = np.zeros([-(-length // _TILE) for length in frame.shape[:2]], np.uint8)
    for rows in strips:
        changed[rows.start // _TILE:-(-rows.stop // _TILE)] = _changed_tiles(
            frame, lit, rows, limits)
    outlines, _ = cv2.findContours(
        cv2.dilate(changed, _NEXT_TILES), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    return [_part(cv2.boundingRect(outline), frame) for outline in outlines]


def frame_outline(frame: np.ndarray) -> np.ndarray:
    """Give the outline of a whole frame, shape (4, 1, 2), int32, in px."""
    bottom, right = frame.shape[0] - 1, frame.shape[1] - 1
    return np.int32([[[0, 0]], [[0, bottom]], [[right, bottom]], [[right, 0]]])


def _part(tiles: Tuple[int, int, int, int], frame: np.ndarray) -> Box:
    # The tiles are one more to each side than have changed, where the frame goes on.
    x, y, width, height = tiles
    less = _TILE - _MARGIN
    left, top = (first * _TILE + less if first else 0 for first in (x, y))
    right, bottom = (length if end * _TILE >= length else end * _TILE - less for end, length in (
        (x + width, frame.shape[1]), (y + height, frame.shape[0])))
    return Box(left, top, right - left, bottom - top)


def _changed_tiles(
    frame: np.ndarray, lit: np.ndarray, rows: slice, limits: Limits
) -> np.ndarray:
    if not limits.has_field:
        difference = cv2.absdiff(frame[rows], lit[rows])
        changed = _with_most(cv2.threshold(
            _by_row(difference), limits.least, 1, cv2.THRESH_BINARY)[1])
        if np.count_nonzero(changed) < _FEW * changed.size:
            return changed
    # Edges of a table whose picture trembles: the limits at each place know them.
    usual = limits.strong((rows, slice(0, frame.shape[1])))
    inside = cv2.inRange(*map(_by_row, (frame[rows], *usual)))
    return _with_most(cv2.bitwise_not(inside) & 1)


def _by_row(picture: np.ndarray) -> np.ndarray:
    # Channel by channel: OpenCV compares single bytes faster than triples.
    return picture.reshape(len(picture), -1)


def _with_most(beyond: np.ndarray) -> np.ndarray:
    rows, columns = -(-len(beyond) // _TILE), -(-beyond.shape[1] // (3 * _TILE))
    size = rows * _TILE, columns * 3 * _TILE
    if beyond.shape != size:
        beyond = cv2.copyMakeBorder(beyond, 0, size[0] - beyond.shape[0], 0,
                                    size[1] - beyond.shape[1], cv2.BORDER_CONSTANT)
    # Eight bytes are added at a time, each for itself: a tile has fewer than 256 levels.
    lanes = np.add.reduce(beyond.view(np.uint64).reshape(rows, _TILE, -1), axis=1)
    lanes = lanes.reshape(rows, columns, 3)
    return (lanes[..., 0] + lanes[..., 1] + lanes[..., 2]) * _ONES >> _TOP_BYTE >= _LEAST_LEVELS
