# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Splits convex objects that touch: coins, nuts, blocks.

Where two convex objects touch, their common outline has a neck: two notches that face each other,
closer together than either object is wide. A screw has two notches, too, but its neck is as wide
as its shaft; an L has one notch. An outline is split only if all of its parts are convex then.

Things with a narrow gap are apart where the table is seen between them, `cut_at_gaps`, also where
their shade or compression has joined them by a neck: `without_necks`. Wider ones are apart where
light explains what is between them: `cut_at_light`.
"""

from itertools import combinations
import math
from typing import Iterator, List, Optional, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.light import LINEAR
from camera_to_base.detection.precise.piece import (
    channel_extremes, chosen, enclosed, filled, grown, largest_part, outline_of, outlines_in,
    quantile, slices, solidity, square)
from camera_to_base.detection.precise.reference import WEAK_LEVELS
from camera_to_base.detection.precise.shade import DARKEST
import cv2
import numpy as np

# A notch is at least this deep, in px and as a part of the square root of the area.
_DEEPEST_FLAW, _LEAST_NOTCH = 1.5, 0.06
# The neck beside the narrower part's width.
_WIDEST_NECK = 0.6
# How much of its convex hull a part fills; a small one's outline is ragged.
_LEAST_SOLIDITY, _SMALLEST = 0.9, 30
_MOST_NOTCHES, _MOST_PARTS = 12, 12
# How far two things may be apart that are taken for one at first, in px; how much nearer to the
# table's colour it is there; how far the frame goes towards the table.
_WIDEST_GAP, _VALLEY, _LEAST_GAP = 9, 0.6, 0.25
# Of what comes apart, each lump is at least this part of the largest, or the second where the
# table's colour tells; all are at least the third of the whole, which is eroded if the lumps are.
# Ragged things are not cut up.
_LEAST_LUMP, _LEAST_OVER_TABLE, _MOSTLY = 0.25, 0.1, 0.6
# The sides of a gap have one colour where they differ by less; how far off their colours and the
# table's a gap may be, as a part of their contrast.
_ALIKE, _THIRD_COLOUR = 0.15, 0.1
# What is narrow between things is a print on one where it is off such mixtures by more than this
# part of its light.
_THIRD_LIGHT = 0.25
# What is off by less than this part of what is near it shows the table.
_SURELY = 0.15

# What joins lumps is so narrow at most, px, and fills the hull by less than this; its middle is so
# much nearer to the table than to a lump, and off a lump by this part of its light.
_NECKS, _NOTCHED, _NEARER, _OTHER_LIGHT, _BRIGHTER = (3, 5, 7, 9), 0.93, 0.5, 0.15, 1.2

Place = Tuple[int, int]


def split_touching(mask: np.ndarray) -> List[np.ndarray]:
    """
    Split a mask into the convex objects that it is made of.

    :param mask: Shape (h, w), uint8, 1 inside, without holes.
    :returns: The parts' masks; only the mask itself where it is not made of such objects.
    """
    waiting, parts = [mask], []
    while waiting:
        part = waiting.pop()
        pair = _cut(part)
        if pair is None:
            parts.append(part)
        else:
            waiting.extend(pair)
        if len(parts) + len(waiting) > _MOST_PARTS:
            return [mask]
    is_split = len(parts) > 1 and all(_is_convex(part) for part in parts)
    return _grown_together(parts, mask) if is_split else [mask]


def _cut(mask: np.ndarray) -> Optional[Tuple[np.ndarray, np.ndarray]]:
    for start, end in _necks(mask):
        pair = halves(mask, start, end)
        if pair is None:
            continue
        first, second = pair
        widest = _WIDEST_NECK * min(_width(first), _width(second))
        if cv2.countNonZero(first) >= _SMALLEST and np.hypot(*np.subtract(end, start)) <= widest:
            return first, second
    return None


def halves(
    mask: np.ndarray, start: Place, end: Place
) -> Optional[Tuple[np.ndarray, np.ndarray]]:
    """Cut a mask along a line: the two largest parts, the largest last; None where it is one."""
    rest = mask.copy()
    cv2.line(rest, start, end, 0, 1, cv2.LINE_8)
    count, labels = cv2.connectedComponents(rest, connectivity=4)
    if count < 3:
        return None
    first, second = sorted(((labels == label).astype(np.uint8) for label in range(1, count)),
                           key=cv2.countNonZero)[-2:]
    return first, second


def _necks(mask: np.ndarray) -> Iterator[Tuple[Place, Place]]:
    outline = outline_of(mask)
    if outline is None or len(outline) < 8:
        return iter(())
    least = max(_DEEPEST_FLAW, _LEAST_NOTCH * np.sqrt(cv2.countNonZero(mask)))
    pairs = combinations(notches_in(outline, least, _MOST_NOTCHES), 2)
    return iter(sorted(pairs, key=lambda pair: np.hypot(*np.subtract(*pair))))


def notches_in(outline: np.ndarray, least: float, most: int) -> List[Place]:
    """
    List the notches of an outline, the deepest first.

    :param outline: Shape (n, 1, 2), int32, in px.
    :param least: Their depth below the convex hull, in px.
    :param most: How many are listed.
    """
    hull = cv2.convexHull(outline, returnPoints=False)
    try:
        defects = cv2.convexityDefects(outline, hull)
    except cv2.error:
        return []  # an outline that touches itself has no order
    if defects is None:
        return []
    deep = sorted((defect for defect in defects.reshape(-1, 4).tolist()
                   if defect[3] / 256 >= least), key=lambda defect: -defect[3])
    return [tuple(outline[at, 0].tolist()) for _, _, at, _ in deep[:most]]


def _width(mask: np.ndarray) -> float:
    outline = outline_of(mask)
    return 0.0 if outline is None else min(cv2.minAreaRect(outline)[1]) + 1


def _is_convex(mask: np.ndarray) -> bool:
    return solidity(mask) >= _LEAST_SOLIDITY


def _grown_together(parts: List[np.ndarray], mask: np.ndarray) -> List[np.ndarray]:
    # The cut's own pixels belong to the nearest part.
    nearest = nearest_part(parts)
    return [largest_part(mask & (nearest == index).astype(np.uint8))
            for index in range(len(parts))]


def nearest_part(parts: List[np.ndarray]) -> np.ndarray:
    """Tell which of some masks is nearest to each pixel: shape (h, w), its index."""
    return np.argmin([cv2.distanceTransform(1 - part, cv2.DIST_L2, 5) for part in parts], axis=0)


def cut_apart(
    things: np.ndarray, light: np.ndarray, frame: np.ndarray, background: np.ndarray,
    min_area: float,
) -> List[np.ndarray]:
    """
    Give each thing's mask: what is printed on one joins it, light and narrow gaps part it.

    :param things: Shape (h, w), uint8, 1 inside.
    :param light: What light explains better than a thing, uint8, of that shape.
    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :param min_area: Smaller things do not count, in px².
    """
    things = with_stripes(things, frame, background)
    things = cut_at_light(things, light, frame, background, min_area)
    return cut_at_gaps(things, frame, background, min_area)


def cut_at_gaps(
    things: np.ndarray, frame: np.ndarray, background: np.ndarray, min_area: float
) -> List[np.ndarray]:
    """
    Cut things where the table is seen between them, be it through a blurred lens.

    :param things: Shape (h, w), uint8, 1 inside.
    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :param min_area: Smaller things do not count, in px².
    :returns: Each thing's mask.
    """
    away, around = _away(frame, background)
    gap = cv2.morphologyEx(
        (away < _VALLEY * around).view(np.uint8), cv2.MORPH_CLOSE, square(3)) & things
    rest = cv2.erode(things & (1 - gap), square(3))
    whole = Box(0, 0, *things.shape[::-1])
    found: List[np.ndarray] = []
    for outline in outlines_in(things):
        inside = filled(outline, whole)
        whole_core = cv2.countNonZero(cv2.erode(inside, square(3)))
        cores = _lumps(rest & inside, min_area, _LEAST_LUMP, whole_core)
        if len(cores) > 1 and _is_gap(cores, gap & inside, frame, background):
            nearest = nearest_part(cores)
            found += [largest_part(inside & (1 - gap) & (nearest == index).view(np.uint8))
                      for index in range(len(cores))]
        elif enclosed(outline) >= min_area:
            found.append(inside)
    return found


def cut_at_light(
    things: np.ndarray, light: np.ndarray, frame: np.ndarray, background: np.ndarray,
    min_area: float,
) -> np.ndarray:
    """
    Cut things where light explains what joins them, see :func:`cut_apart`.

    Shade joins no two things.
    """
    sure = cv2.morphologyEx(things & (1 - light), cv2.MORPH_CLOSE, square(3))
    wide = cv2.morphologyEx(sure, cv2.MORPH_OPEN, square(3))
    cut = things.copy()
    for outline in outlines_in(things):
        box = Box(*cv2.boundingRect(outline))
        near, inside = slices(box), filled(outline, box)
        cores = _lumps(wide[near] & inside, min_area, _LEAST_OVER_TABLE, enclosed(outline))
        if len(cores) > 1:
            middle = inside & _half_way(cores)[0] & (1 - sure[near])
            seen, table = (cv2.LUT(picture[near], LINEAR) for picture in (frame, background))
            if _is_over_table(middle, cores, seen, table):
                cut[near] &= 1 - middle
    return cut


def without_necks(
    mask: np.ndarray, frame: np.ndarray, table: np.ndarray, min_area: float
) -> np.ndarray:
    """
    Take away what joins lumps and shows the table between them, lit or in their shade.

    :param mask: Shape (h, w), uint8, 1 inside.
    :param frame: Its light, shape (h, w, 3), float32.
    :param table: The table's, of the same shape.
    :param min_area: Smaller lumps do not count, in px².
    :returns: A mask in which they are apart; the mask itself where none are.
    """
    if solidity(mask) > _NOTCHED:
        return mask
    for width in _NECKS:
        cores = _lumps(cv2.erode(mask, square(width)), min_area, _LEAST_OVER_TABLE)
        if len(cores) > 1:
            break
    else:
        return mask
    middle, nearest = _half_way(cores)
    middle &= mask
    if not _is_over_table(middle, cores, frame, table):
        return mask
    return mask & (nearest <= width).view(np.uint8) & (1 - middle)


def _lumps(
    mask: np.ndarray, min_area: float, share: float, whole: float = 0.0
) -> List[np.ndarray]:
    """
    Give the large parts of a mask, each of its shape; none where they are little of a whole.

    :param min_area: Half of that is large enough, in px².
    :param share: The least part of the largest that each is.
    :param whole: The area that they are most of, in px².
    """
    outlines = outlines_in(mask)
    least = max(min_area / 2, share * max(map(enclosed, outlines), default=0))
    outlines = [one for one in outlines if enclosed(one) >= least]
    if sum(map(enclosed, outlines)) < _MOSTLY * whole:
        return []
    box = Box(0, 0, *mask.shape[::-1])
    return [filled(one, box) & mask for one in outlines]


def _half_way(cores: List[np.ndarray]) -> Tuple[np.ndarray, np.ndarray]:
    """Give what is half-way between cores, uint8, 1 there; and how far the nearest is, px."""
    nearest, next_one = np.sort(
        [cv2.distanceTransform(1 - core, cv2.DIST_L2, 5) for core in cores], axis=0)[:2]
    return (next_one - nearest < 2).view(np.uint8), nearest


def _is_over_table(
    middle: np.ndarray, cores: List[np.ndarray], frame: np.ndarray, table: np.ndarray
) -> bool:
    """Tell whether what is half-way is the table in some light, and not of its sides' colour."""
    if not middle.any():
        return False
    seen, usual = (quantile(chosen(light, middle)) for light in (frame, table))
    factor = float(np.clip(seen @ usual / (usual @ usual), math.exp(DARKEST), _BRIGHTER))
    # An edge between two colours of a thing is a mixture of both.
    off_sides = min(_off_line(seen, *pair) for pair in combinations(
        [quantile(chosen(frame, core)) for core in cores], 2))
    off_table = np.linalg.norm(seen - factor * usual)
    return off_sides > max(off_table / _NEARER, _OTHER_LIGHT * np.linalg.norm(seen))


def _off_line(colour: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    """Give how far a colour is off the line from one colour to another."""
    way = end - start
    share = np.clip((colour - start) @ way / max(way @ way, 1e-9), 0, 1)
    return float(np.linalg.norm(colour - start - share * way))


def with_stripes(things: np.ndarray, frame: np.ndarray, background: np.ndarray) -> np.ndarray:
    """
    Add what is narrow between things, and of a third colour: it is a print on one thing.

    :param things: Shape (h, w), uint8, 1 inside.
    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    """
    gaps = cv2.morphologyEx(things, cv2.MORPH_CLOSE, square(_WIDEST_GAP)) & (1 - things)
    gaps = cv2.morphologyEx(gaps, cv2.MORPH_OPEN, square(3))
    if not gaps.any():
        return things
    things = things.copy()
    light, usual = (cv2.LUT(picture, LINEAR) for picture in (frame, background))
    for outline in outlines_in(gaps):
        box = grown(Box(*cv2.boundingRect(outline)), _WIDEST_GAP, things)
        near, part = slices(box), filled(outline, box)
        part &= gaps[near]
        sides = things[near] & cv2.dilate(part, square(_WIDEST_GAP))
        seen, side = (quantile(chosen(light[near], where)) for where in (part, sides))
        # The table in any light, and mixtures with the side's colour.
        span = np.stack([side, cv2.mean(usual[near], part)[:3]])
        if _off_mixtures(seen, span) > _THIRD_LIGHT * np.linalg.norm(seen):
            things[near] |= part
    return things


def _off_mixtures(seen: np.ndarray, span: np.ndarray) -> np.ndarray:
    """Give how far colours, shape (..., 3), are off all mixtures of some, shape (n, 3)."""
    return np.linalg.norm(seen - seen @ np.linalg.pinv(span, _ALIKE) @ span, axis=-1)


def table_between(frame: np.ndarray, background: np.ndarray) -> np.ndarray:
    """Give where the frame is as the table, beside where it is not: shape (h, w), 1 there."""
    away, around = _away(frame, background)
    return cv2.morphologyEx((away < _SURELY * around).view(np.uint8), cv2.MORPH_OPEN, square(2))


def _away(frame: np.ndarray, background: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Give how far a frame is off the table, and the same across the widest gap."""
    away = channel_extremes(cv2.absdiff(frame, background))[1]
    return away, cv2.morphologyEx(away, cv2.MORPH_CLOSE, square(_WIDEST_GAP))


def _is_gap(
    parts: List[np.ndarray], gap: np.ndarray, frame: np.ndarray, background: np.ndarray
) -> bool:
    # On the way from a dark face to a light one, a blurred edge looks like the table, too.
    near = cv2.dilate(gap, square(_WIDEST_GAP))
    levels = np.int16(frame)
    change = levels - background
    places = [place for place in ((part & near) > 0 for part in parts) if place.any()]
    span = np.array([np.median(change[place], axis=0) for place in places])
    if not places or (span @ span[0] <= 0).any():
        return False
    # Through a blurred lens, it is a mixture of the table and the sides: no third colour.
    seen, contrasts = change[gap > 0], np.linalg.norm(span, axis=1)
    if np.median(_off_mixtures(seen, span)) > max(_THIRD_COLOUR * contrasts.min(), WEAK_LEVELS):
        return False
    # Not one side goes on. A dark joint of the table below a dark thing is no gap, either.
    for place, contrast in zip(places, contrasts):
        across = levels[gap > 0] - np.median(levels[place], axis=0)
        shares = (across * (across - seen)).sum(axis=1) / max(contrast ** 2, 1.0)
        if np.median(shares) <= _LEAST_GAP:
            return False
    return True
