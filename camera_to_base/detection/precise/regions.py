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
Where a frame differs from the background: the regions that may be objects.

A region is where pixels beyond the weak limit are connected, and enough of them lie beyond the
strong one (hysteresis): noise stays below the strong limit, and the rim of an object is still seen
by the weak one. Holes belong to their region.

The whole frame is read once, against the strong limit, in tiles; everything else is done in
windows around the tiles in which something has changed.
"""

from typing import Iterator, List, NamedTuple, Optional, Set

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.limits import Limits
import cv2
import numpy as np

_TILE = 8
# A tile whose mean is less has some bytes that are outside of the limits.
_CALM_TILE = 251
_CLOSE, _NEXT_TILES = np.ones((3, 3), np.uint8), np.ones((3, 3), np.uint8)
# How far around the changed tiles a region is looked for at first, in px, and by what factor
# farther where it goes on.
_FIRST_MARGIN, _FARTHER = 4, 4
# A shorter outline encloses less than the smallest object.
_SHORTEST_OUTLINE = 12


class Region(NamedTuple):
    """
    A region of a frame that differs from the background.

    :param outline: Shape (n, 1, 2), int32, in px of the picture.
    :param box: The upright rectangle around it.
    :param strong_area: The largest connected part of it beyond the strong limit, in px².
    """

    outline: np.ndarray
    box: Box
    strong_area: int


def find_regions(
    frame: np.ndarray, rows: slice, limits: Limits, min_area: float
) -> List[Region]:
    """
    Find the regions of a frame.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param rows: Where to look.
    :param min_area: How large a region's strong part must be, in px².
    :returns: The largest first.
    """
    found: List[Region] = []
    seen: Set[Box] = set()
    for part in _changed_parts(frame, rows, limits):
        for region in _regions_around(frame, part, limits, min_area):
            if region.box not in seen:
                seen.add(region.box)
                found.append(region)
    return sorted(found, key=lambda region: -region.strong_area)


def filled(outline: np.ndarray, box: Box) -> np.ndarray:
    """Draw a region's outline, filled: shape (height, width) of a box, uint8, 1 inside."""
    mask = np.zeros((box.height, box.width), np.uint8)
    return cv2.drawContours(mask, [outline], 0, 1, cv2.FILLED, offset=(-box.x, -box.y))


def slices(box: Box) -> tuple:
    """Give a box as indices of a picture."""
    return np.s_[box.y:box.y + box.height, box.x:box.x + box.width]


def grown(box: Box, margin: int, picture: np.ndarray) -> Box:
    """Grow a box by some px to all sides, as far as the picture goes."""
    height, width = picture.shape[:2]
    left, top = max(box.x - margin, 0), max(box.y - margin, 0)
    right = min(box.x + box.width + margin, width)
    bottom = min(box.y + box.height + margin, height)
    return Box(left, top, right - left, bottom - top)


def _changed_parts(frame: np.ndarray, rows: slice, limits: Limits) -> Iterator[Box]:
    # Channel by channel: OpenCV compares single bytes faster than triples.
    band = frame[rows]
    strong = limits.strong(np.s_[rows])
    width = 3 * frame.shape[1]
    inside = cv2.inRange(*(picture.reshape(-1, width) for picture in (band, *strong)))
    size = max(frame.shape[1] // _TILE, 1), max(len(band) // _TILE, 1)
    tiles = cv2.resize(inside, size, interpolation=cv2.INTER_AREA)
    _, changed = cv2.threshold(tiles, _CALM_TILE, 255, cv2.THRESH_BINARY_INV)
    if not cv2.countNonZero(changed):
        return
    # The last tile may be larger than the others.
    scale_x, scale_y = frame.shape[1] / size[0], len(band) / size[1]
    outlines, _ = cv2.findContours(
        cv2.dilate(changed, _NEXT_TILES), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    for outline in outlines:
        x, y, width, height = cv2.boundingRect(outline)
        left, top = int(x * scale_x), int(y * scale_y)
        yield Box(left, rows.start + top, int(np.ceil((x + width) * scale_x)) - left,
                  int(np.ceil((y + height) * scale_y)) - top)


def _regions_around(
    frame: np.ndarray, part: Box, limits: Limits, min_area: float
) -> List[Region]:
    # A region that reaches the window's border is looked at again in a larger window.
    margin = _FIRST_MARGIN
    while True:
        window = grown(part, margin, frame)
        found = _regions_in(frame, window, limits, min_area)
        if not any(_goes_on(region.box, window, frame) for region in found):
            return found
        margin *= _FARTHER


def _regions_in(
    frame: np.ndarray, window: Box, limits: Limits, min_area: float
) -> List[Region]:
    part = slices(window)
    piece = np.ascontiguousarray(frame[part])
    strong = limits.strong(part).outside(piece)
    if cv2.countNonZero(strong) < min_area / 2:
        return []
    strong, weak = (cv2.morphologyEx(mask, cv2.MORPH_CLOSE, _CLOSE)
                    for mask in (strong, limits.weak(part).outside(piece)))
    outlines, _ = cv2.findContours(weak, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    regions = (_region(outline, strong, window, min_area) for outline in outlines
               if len(outline) >= _SHORTEST_OUTLINE)
    return [region for region in regions if region is not None]


def _region(
    outline: np.ndarray, strong: np.ndarray, window: Box, min_area: float
) -> Optional[Region]:
    box = Box(*cv2.boundingRect(outline))
    inside = filled(outline, box)
    marked = cv2.bitwise_and(strong[slices(box)], inside, mask=inside)
    area = cv2.countNonZero(marked)
    # Where most of a region is strong, the strong part is one.
    if min_area <= area < cv2.countNonZero(inside) / 2:
        area = _largest_area(marked)
    if area < min_area:
        return None
    corner = np.int32([window.x, window.y])
    return Region(outline + corner, box._replace(x=box.x + window.x, y=box.y + window.y), area)


def _largest_area(mask: np.ndarray) -> int:
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask)
    return int(stats[1:, cv2.CC_STAT_AREA].max(initial=0))


def _goes_on(box: Box, window: Box, picture: np.ndarray) -> bool:
    height, width = picture.shape[:2]
    return (box.x <= window.x > 0 or box.y <= window.y > 0
            or box.x + box.width >= window.x + window.width < width
            or box.y + box.height >= window.y + window.height < height)
