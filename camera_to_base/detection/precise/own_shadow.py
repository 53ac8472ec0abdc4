# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Splits an object's own shadow off its region where only darkness tells which part is the thing.

The object is the darker part, with all that is lighter than the table or coloured. It may be
lighter than its shadow: then the shadow is a crescent, and the object is convex. A gradient looks
like two parts, too, but has no two levels.
"""

from typing import Optional

from camera_to_base.detection.precise.gloss import find_highlight, surrounds
from camera_to_base.detection.precise.light import LEAST_LIGHT
from camera_to_base.detection.precise.piece import (
    channel_extremes, channel_sum, largest_part, Piece, ratio_of, solidity, square, two_means)
from camera_to_base.detection.precise.shade import like_light, SHADED
import cv2
import numpy as np

# The least object, in px² and as a part of its region; how much of its rim is the region's.
_LEAST_THING, _LEAST_SHARE, _LEAST_FREE_RIM = 16, 0.15, 0.25
# Of the rest, this part is shade, and this part in one lump.
_LEAST_SHADE, _LEAST_LUMP = 0.8, 0.6
# What shade cannot be: lighter, or of a colour.
_LIGHT, _COLOURED = 1.1, 1.6
_LEAST_CORE = 20
# Two levels are apart by this much, logarithm, and the deviations around both are less than this
# part of it; of what changes evenly, they are 0.58. So much of the step is the frame's.
_LEVELS_APART, _TWO_LEVELS, _IN_FRAME = 0.15, 0.3, 0.4
# How much more convex an object is than its shadow, where it is lighter.
_MORE_CONVEX = 0.2


def split_off_shade(piece: Piece) -> Optional[np.ndarray]:
    """
    Find the object in a region that is an object and its shade.

    What is split off may be its lighter face, or it is a face of what is split off.

    :returns: Its mask, shape (h, w), uint8, 1 inside; None for other regions.
    """
    mask, core = piece.mask, cv2.erode(piece.mask, square(5))
    light, usual = (cv2.blur(one, (3, 3)) for one in (piece.frame, piece.table))
    change, spot = ratio_of(light, usual), find_highlight(piece)
    special = _special(change, mask)
    if spot is not None:
        special |= spot & mask
    level, table = (cv2.log(cv2.max(channel_sum(one), 3 * LEAST_LIGHT)) for one in (light, usual))
    ratio, plain = cv2.subtract(level, table), core & (1 - special)
    if cv2.countNonZero(plain) < max(_LEAST_CORE, cv2.countNonZero(core) / 2):
        return None
    limit = _limit(ratio, plain, level)
    if limit is None:
        return None
    darker = special | mask & (ratio <= limit).view(np.uint8)
    gap = 9 if special.any() else 3
    thing = largest_part(cv2.morphologyEx(darker, cv2.MORPH_CLOSE, square(gap)))
    rest = _lighter_side(thing, mask)
    if not special.any() and solidity(rest) > solidity(thing) + _MORE_CONVEX:
        # A shadow is what its object leaves of it, a crescent.
        thing = rest
    shade = mask & (1 - cv2.dilate(thing, square(3)))
    is_split = (cv2.countNonZero(thing) >= max(_LEAST_THING, _LEAST_SHARE * mask.sum())
                and _is_lump(cv2.erode(shade, square(3)), like_light(change, SHADED))
                and _has_free_rim(thing, mask)
                and not (spot is not None and surrounds(spot, thing, rest)))
    return thing if is_split else None


def _special(ratio: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Give what is no shade, by the ratios to the table, shape (h, w, 3)."""
    smallest, largest = channel_extremes(ratio)
    special = (largest > _LIGHT) | (largest > _COLOURED * np.maximum(smallest, LEAST_LIGHT))
    return cv2.morphologyEx(mask & special.view(np.uint8), cv2.MORPH_OPEN, square(3))


def _limit(ratio: np.ndarray, plain: np.ndarray, level: np.ndarray) -> Optional[float]:
    """
    Give the limit between two levels of a region, half-way; None where there are no two.

    :param ratio: Logarithm of the light / the table's, shape (h, w).
    :param plain: What of the region may be shade, of that shape, uint8.
    :param level: Logarithm of the light: a print of the table has no step in it.
    """
    limit = sum(two_means(ratio[plain > 0])) / 2
    is_dark = (ratio <= limit).view(np.uint8)
    # Not at the border itself, where pixels are mixed.
    sides = [cv2.erode(plain & side, square(3)) for side in (is_dark, 1 - is_dark)]
    if not all(map(cv2.countNonZero, sides)):
        return None
    (low, first), (high, second) = (cv2.meanStdDev(ratio, mask=side) for side in sides)
    step = high - low
    steps = [cv2.mean(level, side)[0] for side in sides]
    is_told = (step > _LEVELS_APART and first + second < _TWO_LEVELS * step
               and abs(steps[1] - steps[0]) > _IN_FRAME * step)
    return limit if is_told else None


def _lighter_side(dark: np.ndarray, mask: np.ndarray) -> np.ndarray:
    # Without the rim, which is lighter on all sides.
    rest = cv2.erode(mask, square(5)) & (1 - dark)
    rest = largest_part(cv2.morphologyEx(rest, cv2.MORPH_OPEN, square(3)))
    return cv2.dilate(rest, square(5)) & mask & (1 - dark)


def _is_lump(rest: np.ndarray, shade: np.ndarray) -> bool:
    """Tell whether the rest of a region is shade, and one lump."""
    area = cv2.countNonZero(rest)
    return cv2.countNonZero(rest & shade) > _LEAST_SHADE * area and cv2.countNonZero(
        largest_part(rest)) > _LEAST_LUMP * area


def _has_free_rim(thing: np.ndarray, mask: np.ndarray) -> bool:
    """
    Tell whether enough of a part's rim is the region's rim.

    A shadow lies to one side of its object; a highlight or a print is surrounded.
    """
    rim = thing & (1 - cv2.erode(thing, square(3)))
    free = rim & (1 - cv2.erode(mask, square(9)))
    return cv2.countNonZero(free) >= _LEAST_FREE_RIM * cv2.countNonZero(rim)
