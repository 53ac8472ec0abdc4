# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The short way for plain objects: of one colour, with a sharp rim, on a table without shade.

Most objects are plain, and their place follows from one projection, without a look at their
surroundings, in a window that is hardly larger than the object. What decides between the ways:

- what differs from the background is one region that lies within the picture,
- its inside is wide enough to be judged, and as even as noise allows: one level, no highlight,
- it differs from the table by at least twice what an object must, all along its rim by a part of
  that: it is not faint,
- few pixels lie between its colour and the table's: shade and blurred rims would be among them,
- few are darker than all mixtures of both colours: they are its shade, however narrow,
- what is covered is one part without a hole,
- the table's texture is seen all around it: no face of it looks like the table,
- nothing of that texture is seen in it, nor a coloured table's own colour: it is no light,
- where the background has edges, the background around it has another colour: it is no ghost.

Everything else goes the long way, see `shares`. On a plain object both ways give the same place.
"""

import math
import operator
from typing import Iterable, List, NamedTuple, Optional

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.light import LINEAR
from camera_to_base.detection.precise.piece import (
    filled, grown, has_holes, outlines_in, slices, square)
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import SHORTEST_OUTLINE
from camera_to_base.detection.precise.shade import is_of_its_colour
from camera_to_base.detection.precise.shares import Placed
import cv2
import numpy as np

_DEPTH, _LEAST_CORE = 3, 20
_EVEN_LEVELS, _EVEN_DEVIATIONS, _CLEAR = 4.0, 2.5, 2.0
_COVERED, _HALF, _WIDEST_RIM = 204, 127, 2.6  # shares of 255
_LEAST_SPAN, _SURELY_OTHER = 0.12, 0.5
# From which angle on two colours tell a shade, its sine squared; what is in shade; on how many px,
# by the square root of the area.
_OTHER_CHROMA, _SHADED, _MOST_SHADE = 0.04, 0.75, 0.25
# How many deviations of chance the frame's detail has in common with the table's, at most.
_LIKENESS = 6.0
# The table's texture is gone where the frame's has less than this part of its power in common with
# it; the least power, by the noise's; in windows, px.
_GONE, _TEXTURED, _BESIDE = 0.25, 4.0, 11
_DIAGONAL = math.sqrt(2) - 1
_LINEAR = LINEAR.tolist()
_STEPS = [*map(operator.sub, _LINEAR[1:], _LINEAR), 0.0]
_CORE, _NEXT, _WIDE = square(2 * _DEPTH + 1), square(3), square(5)


class Plain(NamedTuple):
    """
    A plain object.

    :param placed: Its place in its window.
    :param window: The window on the picture.
    """

    placed: Placed
    window: Box


def find_plain(
    frame: np.ndarray, part: Box, reference: Reference, min_area: float
) -> Optional[Plain]:
    """
    Find a plain object.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param part: What has changed, see `changes`.
    :param reference: The background at the frame's light.
    :param min_area: What shows less is noise, in px².
    :returns: None where there is something else than one plain object.
    """
    place = slices(part)
    weak = reference.limits.weak(frame, place)
    everything = outlines_in(weak)
    outlines = [outline for outline in everything if len(outline) >= SHORTEST_OUTLINE]
    if not outlines:
        return None
    outline = max(outlines, key=cv2.contourArea)
    if len(everything) > 1:  # specks of noise
        weak = filled(outline, Box(0, 0, part.width, part.height), 255)
    x, y, width, height = cv2.boundingRect(outline)
    if (x == 0 or y == 0 or x + width == part.width or y + height == part.height
            or len(outlines) > 1 and _shows_more(frame, weak, place, reference, min_area)):
        return None
    mask = weak[y - 1:y + height + 1, x - 1:x + width + 1]
    window = Box(part.x + x - 1, part.y + y - 1, width + 2, height + 2)
    placed = _place(frame, window, mask, outline, reference)
    if placed is None or _hides_more(frame, part, outline, reference):
        return None
    return Plain(placed, window)


def _shows_more(
    frame: np.ndarray, weak: np.ndarray, place: tuple, reference: Reference, min_area: float
) -> bool:
    # JPEG leaves faint specks around an object. They are no regions, see `regions`.
    strong = reference.limits.strong(frame, place)
    return cv2.countNonZero(cv2.subtract(strong, weak)) >= min_area / 2


def _place(
    frame: np.ndarray, window: Box, mask: np.ndarray, outline: np.ndarray, reference: Reference
) -> Optional[Placed]:
    """
    Place a plain object.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param window: The box around the object, 1 px larger to each side.
    :param mask: What differs in the window, shape (height, width), uint8, 255 there.
    :param outline: The mask's outline, shape (n, 1, 2), int32.
    :param reference: The background at the frame's light.
    :returns: None where the object is not plain.
    """
    place = slices(window)
    seen, table = frame[place], reference.lit[place]
    core = cv2.erode(mask, _CORE)
    if cv2.countNonZero(core) < _LEAST_CORE:
        return None
    # Every second row tells as much.
    mean, deviation = cv2.meanStdDev(seen[::2], mask=core[::2])
    level, usual = mean[:, 0].tolist(), cv2.mean(table[::2])[:3]
    if (deviation.max() > max(_EVEN_LEVELS, _EVEN_DEVIATIONS * reference.mean_noise)
            or max(map(abs, map(operator.sub, usual, level))) < _CLEAR * reference.limits.least):
        return None
    shares = _shares(seen, table, mask, _light(level), _light(usual), reference.has_edges(place))
    if shares is None:
        return None
    if is_of_its_colour(level, usual) or _shows_table(seen, table, core):
        return None
    shares = cv2.max(shares, core)
    between = cv2.countNonZero(mask) - cv2.countNonZero(_above(_COVERED, shares))
    return _whole(shares, window) if between <= _WIDEST_RIM * _length(outline) else None


def _hides_more(
    frame: np.ndarray, part: Box, outline: np.ndarray, reference: Reference
) -> bool:
    """Tell whether the table's texture is gone beside an outline in a part of the frame."""
    x, y, width, height = cv2.boundingRect(outline)
    around = grown(Box(part.x + x, part.y + y, width, height), _BESIDE, frame)
    near = slices(around)
    if not reference.has_edges(near):
        return False
    beside = np.ones((around.height, around.width), np.uint8)
    cv2.drawContours(
        beside, [outline], 0, 0, cv2.FILLED, offset=(part.x - around.x, part.y - around.y))
    # Every second row tells as much.
    beside = cv2.erode(beside, _NEXT)[::2]
    now, usual = (_detail(picture[near][::2]) * beside for picture in (frame, reference.lit))
    both, own = (cv2.blur(one, (_BESIDE, _BESIDE)) for one in (now * usual, usual * usual))
    gone = (both < _GONE * own) & (own > _TEXTURED * reference.mean_noise ** 2)
    return bool(cv2.morphologyEx(gone.view(np.uint8) & beside, cv2.MORPH_OPEN, _WIDE).any())


def _shows_table(seen: np.ndarray, table: np.ndarray, core: np.ndarray) -> bool:
    # The table's texture, however faint: it may be light alone.
    details = [*map(_detail, (seen, table))]
    both, own, now = (cv2.mean(details[one] * details[other], core)[0]
                      for one, other in ((0, 1), (1, 1), (0, 0)))
    return both * math.sqrt(cv2.countNonZero(core)) > _LIKENESS * math.sqrt(own * now)


def _detail(picture: np.ndarray) -> np.ndarray:
    level = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY).astype(np.float32)
    return level - cv2.blur(level, (5, 5))


def _shares(
    seen: np.ndarray, table: np.ndarray, mask: np.ndarray, thing: List[float],
    usual: List[float], has_edges: bool
) -> Optional[np.ndarray]:
    # In 255ths: 255 where all is object, `span` is what is seen where all is table.
    contrast = [*map(operator.sub, usual, thing)]
    power = sum(map(operator.mul, contrast, contrast))
    from_thing = np.float32([[*contrast, -sum(map(operator.mul, contrast, thing))]])
    span = cv2.transform(cv2.LUT(table, LINEAR), from_thing)
    near = cv2.dilate(mask, _NEXT)
    if (cv2.minMaxLoc(span, near)[0] < _LEAST_SPAN * power or has_edges
            and cv2.mean(span, cv2.bitwise_not(near))[0] < _SURELY_OTHER * power):
        return None
    light = cv2.LUT(seen, LINEAR)
    if _has_own_shade(light, near, usual, contrast, power):
        return None
    excess = cv2.transform(light, from_thing)
    return cv2.subtract(near, cv2.divide(excess, span, scale=255, dtype=cv2.CV_8U))


def _has_own_shade(
    light: np.ndarray, near: np.ndarray, usual: List[float], contrast: List[float], power: float
) -> bool:
    """Tell whether pixels are darker than all mixtures of a thing's colour and the table's."""
    part = sum(map(operator.mul, usual, contrast)) / power
    # What the table has and the mixtures have alike, whatever their shares.
    common = [one - part * other for one, other in zip(usual, contrast)]
    whole = sum(map(operator.mul, common, common))
    if whole < _OTHER_CHROMA * sum(map(operator.mul, usual, usual)):
        return False
    dark = cv2.compare(
        cv2.transform(light, np.float32([common])), _SHADED * whole, cv2.CMP_LT)
    count, area = map(cv2.countNonZero, (cv2.bitwise_and(dark, near), near))
    return count > _MOST_SHADE * math.sqrt(area)


def _whole(shares: np.ndarray, window: Box) -> Optional[Placed]:
    covered = _above(_HALF, shares)
    outlines = outlines_in(covered, window)
    if len(outlines) != 1 or has_holes(outlines[0], cv2.countNonZero(covered)):
        return None
    if len(outlines_in(cv2.erode(covered, _NEXT))) > 1:
        # Two things, or one with a neck.
        return None
    return Placed(shares * np.float32(1 / 255), covered, outlines[0])


def _above(limit: int, shares: np.ndarray) -> np.ndarray:
    return cv2.threshold(shares, limit, 1, cv2.THRESH_BINARY)[1]


def _light(levels: Iterable[float]) -> List[float]:
    return [_LINEAR[int(level)] + level % 1 * _STEPS[int(level)] for level in levels]


def _length(outline: np.ndarray) -> float:
    # Of the core's outline, pixel by pixel with common sides; of a convex region's.
    diagonal = (cv2.arcLength(outline, True) - len(outline)) / _DIAGONAL
    return len(outline) + diagonal - 8 * _DEPTH
