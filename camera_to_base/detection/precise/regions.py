# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The regions that may be objects.

A region is where pixels beyond the weak limit are connected, and enough of them lie beyond the
strong one (hysteresis): noise stays below the strong limit, and the rim of an object is still seen
by the weak one. Holes belong to their region.

All of this is done in windows around the parts that have changed, see `changes`. Most windows show
one region without a hole; there a few steps are enough, and the others are left out.
"""

from typing import Iterable, List, NamedTuple, Optional, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.piece import (
    enclosed, filled, fullness, grown, has_holes, outline_of, outlines_in, slices, square)
from camera_to_base.detection.precise.reference import LevelLimits
import cv2
import numpy as np

_CLOSE, _ROW_STEP = np.ones((3, 3), np.uint8), 4
# What is between the parts of a thing that was seen as two regions is narrower, px.
_BETWEEN = 9
# Margins of the windows in which a region is looked for, px; the last one is the whole picture.
_FARTHER = 16, 64, 1 << 20
# Where more than this part of a frame has changed, all of it is looked at, each thing once.
_MUCH = 0.1
SHORTEST_OUTLINE = 12
# What differs strongly on less of its area may be light, where nothing else tells what it is, and
# its outline fills no more than this part of its hull. On 67 sets of real pictures, 74 fewer
# reports are false by that, and 2 fewer are right.
_MOSTLY, CONVEX = 0.5, 0.88
# Lines of a print are thinner than this. What they part lies opposite for twice as far as it is
# apart, that is, a gap's area is so many times its half width squared.
_PRINT, _LONG_GAP, _NEARBY = np.ones((11, 11), np.uint8), 8.0, 15
# A print has an object's colour where it is off by less than this part of the object's contrast,
# which is so many times the least.
_SAME_COLOUR, _CLEAR = 0.3, 2.0


class Region(NamedTuple):
    """
    A region of a frame that differs from the background.

    :param outline: Shape (n, 1, 2), int32, in px of the picture.
    :param box: The upright rectangle around it.
    :param strong_area: The largest connected part of it beyond the strong limit, in px².
    :param strong: The box around what is beyond it.
    :param in_other_light: Whether the table has other light there than `Reference.lit` shows.
    :param is_thing: Whether all of it is a thing, see `things`.
    :param neighbours: Outlines of the things near it, as its own.
    :param may_be_light: Whether all of it may be light, as well as a thing.
    :param doubt: See :class:`Detection`.
    :param is_settled: Whether its outline is one that a placing ended with: one more turn will do.
    :param is_hiding: Whether it hides the table's texture where nothing else has changed.
    """

    outline: np.ndarray
    box: Box
    strong_area: int
    strong: Box
    in_other_light: bool = False
    is_thing: bool = False
    neighbours: Tuple[np.ndarray, ...] = ()
    may_be_light: bool = False
    doubt: float = 0.0
    is_settled: bool = False
    is_hiding: bool = False

    @property
    def is_clear(self) -> bool:
        """Whether most of it differs strongly, or it is convex."""
        return (self.strong_area > _MOSTLY * cv2.contourArea(self.outline)
                or fullness(self.outline) > CONVEX)

    def united(self, other: 'Region') -> 'Region':
        """Give one thing that is both, and what is between them."""
        box = Box(*cv2.boundingRect(np.concatenate([self.outline, other.outline])))
        both = filled(self.outline, box) | filled(other.outline, box)
        outline = outline_of(cv2.morphologyEx(both, cv2.MORPH_CLOSE, square(_BETWEEN)), box)
        return self._replace(outline=outline, box=box, strong=box, neighbours=(),
                             strong_area=self.strong_area + other.strong_area,
                             doubt=max(self.doubt, other.doubt), is_settled=False)


def find_regions(
    frame: np.ndarray, parts: Iterable[Box], limits: LevelLimits, min_area: float
) -> List[Region]:
    """
    Find the regions of a frame.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param parts: Where to look.
    :param min_area: How large a region's strong part must be, in px².
    :returns: The largest first.
    """
    looked = {part: _regions_in(frame, part, limits, min_area)
              for part in _or_whole([*parts], frame)}
    for margin in _FARTHER:
        # A region that reaches the window's border is looked at again in a larger window.
        going_on = [window for window, regions in looked.items()
                    if any(goes_beyond(region.box, window, frame) for region in regions)]
        if not going_on:
            break
        windows = _or_whole(_joined([grown(one, margin, frame) for one in going_on]), frame)
        looked = {window: regions for window, regions in looked.items()
                  if not any(window.is_inside(one) for one in windows)}
        looked.update((window, _regions_in(frame, window, limits, min_area))
                      for window in windows)
    found = {region.box: region for regions in looked.values() for region in regions}
    return sorted(found.values(), key=lambda region: -region.strong_area)


def _or_whole(windows: List[Box], frame: np.ndarray) -> List[Box]:
    return [Box(0, 0, *frame.shape[1::-1])] if is_much(windows, frame) else windows


def is_much(windows: List[Box], frame: np.ndarray) -> bool:
    """Tell whether all of a frame is looked at as fast as these windows."""
    return sum(one.width * one.height for one in windows) > _MUCH * frame[..., 0].size


def _joined(windows: List[Box]) -> List[Box]:
    """Join boxes that overlap."""
    joined: List[Box] = []
    for window in windows:
        near = [one for one in joined if one.overlaps(window)]
        while near:
            joined = [one for one in joined if one not in near]
            left, top = (min(one[axis] for one in (window, *near)) for axis in range(2))
            right, bottom = (max(one[axis] + one[axis + 2] for one in (window, *near))
                             for axis in range(2))
            window = Box(left, top, right - left, bottom - top)
            near = [one for one in joined if one.overlaps(window)]
        joined.append(window)
    return joined


def _regions_in(
    frame: np.ndarray, window: Box, limits: LevelLimits, min_area: float
) -> List[Region]:
    part = slices(window)
    levels = frame[part]
    strong = limits.strong(frame, part)
    area = cv2.countNonZero(strong)
    if area < min_area / 2:
        return []
    weak = limits.weak(frame, part)
    # On much of a frame there are always some, of noise.
    outlines = () if is_much([window], frame) else outlines_in(weak)
    if len(outlines) == 1:
        if _is_solid(outlines[0], weak, area, min_area):
            return [_moved(outlines[0], area, window, strong)]
    else:
        between = _print_between(levels, weak, limits, part)
        strong, weak = strong | between, weak | between
    strong, weak = (
        cv2.morphologyEx(mask, cv2.MORPH_CLOSE, _CLOSE) for mask in (strong, weak))
    regions = (_region(outline, strong, window, min_area) for outline in outlines_in(weak)
               if len(outline) >= SHORTEST_OUTLINE)
    return [region for region in regions if region is not None]


def _print_between(
    levels: np.ndarray, mask: np.ndarray, limits: LevelLimits, part: tuple
) -> np.ndarray:
    """
    Find what differs from the background around it only: a print that has the object's colour.

    :param levels: Shape (h, w, 3), uint8, BGR.
    :param mask: What differs, shape (h, w), uint8, not 0 there.
    :param limits: What is the background's own, and where the levels lie on it.
    :returns: Shape (h, w), uint8, 255 for what lies between its parts and has their colour.
    """
    between = np.zeros_like(mask)
    # What has an object's colour is as far from the table's: only there more is asked.
    least = _CLEAR * limits.least
    near = (1 - _SAME_COLOUR) * least
    gaps = limits.has_print(part, near)
    if not cv2.countNonZero(gaps):
        return between
    gaps &= cv2.subtract(cv2.morphologyEx(mask, cv2.MORPH_CLOSE, _PRINT), mask)
    wide = np.zeros_like(mask)
    for outline in outlines_in(gaps):
        if enclosed(outline) > _LONG_GAP:
            cv2.drawContours(wide, [outline], 0, 1, cv2.FILLED)
    parts = outlines_in(cv2.dilate(wide, square(_NEARBY + 2)))
    if not parts:
        return between
    # Some rows tell as much as all.
    table = np.array(cv2.mean(
        levels[::_ROW_STEP], (mask[::_ROW_STEP] == 0).view(np.uint8))[:3])
    for part in (slices(Box(*cv2.boundingRect(outline))) for outline in parts):
        seen = levels[part]
        rest = cv2.subtract(gaps[part], cv2.inRange(seen, table - near, table + near))
        if cv2.countNonZero(rest) > _LONG_GAP:
            between[part] |= _same_colour(seen, mask[part], rest, table, least)
    return between


def _same_colour(
    levels: np.ndarray, mask: np.ndarray, gaps: np.ndarray, table: np.ndarray, least: float
) -> np.ndarray:
    # The mean colour of what differs nearby, without its rim.
    core, places = cv2.erode(mask, _CLOSE), np.flatnonzero(gaps)
    count, total = (cv2.boxFilter(values, cv2.CV_16U, (_NEARBY, _NEARBY), normalize=False)
                    for values in (core & 1, cv2.copyTo(levels, core)))
    count = count.ravel()[places]
    near = np.float32(total.reshape(-1, 3)[places].T / np.maximum(count, 1))
    contrast, off = (np.abs(near - others).max(axis=0, initial=0) for others in (
        table[:, None], levels.reshape(-1, 3)[places].T))
    chosen = (off < _SAME_COLOUR * contrast) & (contrast > least) & (count > 0)
    is_same = np.zeros_like(mask)
    if not chosen.any():
        return is_same
    places = places[chosen]
    is_same.ravel()[places] = 255
    depths = cv2.distanceTransform(cv2.bitwise_not(mask), cv2.DIST_L2, 3).ravel()[places]
    # A line that leads from one object to the next is no wider than they are apart.
    lines, numbers = cv2.connectedComponents(is_same)
    numbers = numbers.ravel()[places]
    deepest = np.zeros(lines, np.float32)
    np.maximum.at(deepest, numbers, depths)
    is_line = np.bincount(numbers, minlength=lines) > _LONG_GAP * deepest ** 2
    is_same.ravel()[places[~is_line[numbers]]] = 0
    return is_same


def _is_solid(outline: np.ndarray, weak: np.ndarray, area: int, min_area: float) -> bool:
    count = cv2.countNonZero(weak)
    return area >= max(min_area, count / 2) and not has_holes(outline, count)


def _region(
    outline: np.ndarray, strong: np.ndarray, window: Box, min_area: float
) -> Optional[Region]:
    if enclosed(outline) < min_area:
        return None
    box = Box(*cv2.boundingRect(outline))
    if cv2.countNonZero(strong[slices(box)]) < min_area:
        return None
    inside = filled(outline, box)
    marked = cv2.bitwise_and(strong[slices(box)], inside, mask=inside)
    area = cv2.countNonZero(marked)
    # Where most of a region is strong, the strong part is one.
    if min_area <= area < cv2.countNonZero(inside) / 2:
        area = _largest_area(marked)
    if area < min_area:
        return None
    return _moved(outline, area, window, marked)


def _moved(outline: np.ndarray, area: int, window: Box, strong: np.ndarray) -> Region:
    outline = outline + np.int32([window.x, window.y])
    box = Box(*cv2.boundingRect(outline))
    x, y, width, height = cv2.boundingRect(strong)
    left, top = (box[:2] if strong.shape[::-1] == box[2:] else window[:2])
    return Region(outline, box, area, Box(left + x, top + y, width, height))


def _largest_area(mask: np.ndarray) -> int:
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask)
    return int(stats[1:, cv2.CC_STAT_AREA].max(initial=0))


def goes_beyond(box: Box, window: Box, picture: np.ndarray) -> bool:
    """Tell whether what a window of a picture shows may go on beyond it."""
    height, width = picture.shape[:2]
    return (box.x <= window.x > 0 or box.y <= window.y > 0
            or box.x + box.width >= window.x + window.width < width
            or box.y + box.height >= window.y + window.height < height)
