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

All of this is done in windows around the parts that have changed, see `tiles`. Most windows show
one region without a hole; there a few steps are enough, and the others are left out.
"""

from typing import Iterable, List, NamedTuple, Optional, Set, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.limits import Limits
from camera_to_base.detection.precise.piece import enclosed, has_holes, outlines_in
import cv2
import numpy as np

_CLOSE = np.ones((3, 3), np.uint8)
_FARTHER = 16
SHORTEST_OUTLINE = 12


class Region(NamedTuple):
    """
    A region of a frame that differs from the background.

    :param outline: Shape (n, 1, 2), int32, in px of the picture.
    :param box: The upright rectangle around it.
    :param strong_area: The largest connected part of it beyond the strong limit, in px².
    :param in_other_light: Whether the table has other light there than `Reference.lit` shows.
    """

    outline: np.ndarray
    box: Box
    strong_area: int
    in_other_light: bool = False


def find_regions(
    frame: np.ndarray, parts: Iterable[Box], limits: Limits, min_area: float
) -> List[Region]:
    """
    Find the regions of a frame.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param parts: Where to look.
    :param min_area: How large a region's strong part must be, in px².
    :returns: The largest first.
    """
    found: List[Region] = []
    seen: Set[Box] = set()
    done: List[Box] = []
    for part in sorted(parts, key=lambda part: -part.width * part.height):
        if any(part.is_inside(window) for window in done):
            continue
        window, regions = _regions_around(frame, part, limits, min_area)
        done.append(window)
        for region in regions:
            if region.box not in seen:
                seen.add(region.box)
                found.append(region)
    return sorted(found, key=lambda region: -region.strong_area)


def filled(outline: np.ndarray, box: Box, value: int = 1) -> np.ndarray:
    """Draw a region's outline, filled: shape (height, width) of a box, uint8, `value` inside."""
    mask = np.zeros((box.height, box.width), np.uint8)
    return cv2.drawContours(mask, [outline], 0, value, cv2.FILLED, offset=(-box.x, -box.y))


def slices(box: Box) -> tuple:
    """Give a box as indices of a picture."""
    return slice(box.y, box.y + box.height), slice(box.x, box.x + box.width)


def grown(box: Box, margin: int, picture: np.ndarray) -> Box:
    """Grow a box by some px to all sides, as far as the picture goes."""
    height, width = picture.shape[:2]
    left, top = max(box.x - margin, 0), max(box.y - margin, 0)
    right = min(box.x + box.width + margin, width)
    bottom = min(box.y + box.height + margin, height)
    return Box(left, top, right - left, bottom - top)


def _regions_around(
    frame: np.ndarray, part: Box, limits: Limits, min_area: float
) -> Tuple[Box, List[Region]]:
    # A region that reaches the window's border is looked at again in a larger window.
    window, margin = part, _FARTHER
    while True:
        found = _regions_in(frame, window, limits, min_area)
        if not any(_goes_on(region.box, window, frame) for region in found):
            return window, found
        window, margin = grown(part, margin, frame), margin * 4


def _regions_in(
    frame: np.ndarray, window: Box, limits: Limits, min_area: float
) -> List[Region]:
    part = slices(window)
    levels = frame[part]
    strong = limits.strong(part).outside(levels)
    area = cv2.countNonZero(strong)
    if area < min_area / 2:
        return []
    weak = limits.weak(part).outside(levels)
    outlines = outlines_in(weak)
    if len(outlines) == 1 and _is_solid(outlines[0], weak, area, min_area):
        return [_moved(outlines[0], area, window)]
    strong, weak = (
        cv2.morphologyEx(mask, cv2.MORPH_CLOSE, _CLOSE) for mask in (strong, weak))
    regions = (_region(outline, strong, window, min_area) for outline in outlines_in(weak)
               if len(outline) >= SHORTEST_OUTLINE)
    return [region for region in regions if region is not None]


def _is_solid(outline: np.ndarray, weak: np.ndarray, area: int, min_area: float) -> bool:
    count = cv2.countNonZero(weak)
    return area >= max(min_area, count / 2) and not has_holes(outline, count)


def _region(
    outline: np.ndarray, strong: np.ndarray, window: Box, min_area: float
) -> Optional[Region]:
    if enclosed(outline) < min_area:
        return None
    box = Box(*cv2.boundingRect(outline))
    inside = filled(outline, box)
    marked = cv2.bitwise_and(strong[slices(box)], inside, mask=inside)
    area = cv2.countNonZero(marked)
    # Where most of a region is strong, the strong part is one.
    if min_area <= area < cv2.countNonZero(inside) / 2:
        area = _largest_area(marked)
    if area < min_area:
        return None
    return _moved(outline, area, window)


def _moved(outline: np.ndarray, area: int, window: Box) -> Region:
    outline = outline + np.int32([window.x, window.y])
    return Region(outline, Box(*cv2.boundingRect(outline)), area)


def _largest_area(mask: np.ndarray) -> int:
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask)
    return int(stats[1:, cv2.CC_STAT_AREA].max(initial=0))


def _goes_on(box: Box, window: Box, picture: np.ndarray) -> bool:
    height, width = picture.shape[:2]
    return (box.x <= window.x > 0 or box.y <= window.y > 0
            or box.x + box.width >= window.x + window.width < width
            or box.y + box.height >= window.y + window.height < height)
