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

Shade takes light in all colours alike, is one lump, and lies to one side of its object. A table's
pattern and a smooth gradient look like two parts, too; so the *frame* must show the step between
them, and a sharp one.

The object is the darker part, with all that is lighter than the table or coloured. It may be
lighter than its shadow: then the shadow is a crescent, and the object is convex.
"""

from typing import NamedTuple, Optional, Tuple

from camera_to_base.detection.precise.gloss import find_highlight, surrounds
from camera_to_base.detection.precise.piece import (
    channel_extremes, in_clearest_colour, largest_part, Look, look_at, Piece, quantile, solidity,
    square)
import cv2
import numpy as np

# What shade can be: the least and the largest ratio, and the strongest tint.
_DEEPEST, _FAINTEST, _TINT = 0.2, 0.985, 1.25
_LEAST_PART, _LEAST_THING, _LEAST_RING = 8, 16, 4
_LEAST_SHARE_OF_REGION, _LEAST_FREE_RIM = 0.15, 0.25
_LEAST_SHADE, _LEAST_LUMP = 0.8, 0.6
# The step between two levels is at least this high, is this part of the whole difference, and the
# object hardly changes on the way to it.
_LEAST_STEP, _FRAME_STEP, _OF_WHOLE, _STEEPEST = 0.12, 0.4, 0.35, 0.2
_NEAR, _CLOSE, _FARTHER = (1.5, 4.0), (3.0, 5.0), (6.0, 9.0)

# What shade cannot be: lighter, or of a colour.
_LIGHT, _COLOURED = 1.1, 1.6
_LEAST_CORE, _LEAST_SHADE_PART = 20, 8
_SATURATED, _MOST_SATURATED = 0.97, 0.02
# Two levels are apart by this much, logarithm.
_LEVELS_APART = 0.15
_STEPS, _LOWEST = 80, -3.0
# How much more convex an object is than its shadow, where it is lighter.
_MORE_CONVEX = 0.2


def _is_thing_and_shade(
    thing: np.ndarray, marked: np.ndarray, piece: Piece, look: Look
) -> bool:
    """
    Tell whether a part of a region may be an object, and the rest its shade.

    :param thing: The part, shape (h, w), uint8, 1 inside.
    :param marked: What tells it from shade: the part without its holes.
    """
    mask = piece.mask
    rest = mask & (1 - cv2.dilate(thing, square(3)))
    return (cv2.countNonZero(thing) >= _least_area(mask)
            and _is_lump_of_shade(cv2.erode(rest, square(3)), look)
            and _has_free_rim(thing, mask)
            and _has_sharp_step(thing, marked, rest, piece))


def _least_area(mask: np.ndarray) -> float:
    """Give the least area of an object in a region, in px²."""
    return max(_LEAST_THING, _LEAST_SHARE_OF_REGION * cv2.countNonZero(mask))


def _is_lump_of_shade(rest: np.ndarray, look: Look) -> bool:
    area = cv2.countNonZero(rest)
    shade = (look.smallest > _DEEPEST) & (look.largest < _FAINTEST) & (look.tint < _TINT)
    if area < _LEAST_PART or cv2.countNonZero(
            rest & shade.astype(np.uint8)) < _LEAST_SHADE * area:
        return False
    outlines, _ = cv2.findContours(rest, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    areas = [cv2.contourArea(outline) + len(outline) / 2 for outline in outlines]
    return max(areas) > _LEAST_LUMP * sum(areas)


def _has_free_rim(thing: np.ndarray, mask: np.ndarray) -> bool:
    """
    Tell whether enough of a part's rim is the region's rim.

    A shadow lies to one side of its object; a highlight or a print is surrounded.
    """
    rim = thing & (1 - cv2.erode(thing, square(3)))
    free = rim & (1 - cv2.erode(mask, square(9)))
    return cv2.countNonZero(free) >= _LEAST_FREE_RIM * cv2.countNonZero(rim)


def _has_sharp_step(
    thing: np.ndarray, marked: np.ndarray, rest: np.ndarray, piece: Piece
) -> bool:
    sides, light, level, ratio = _sides(thing, marked, rest, piece)
    in_frame, in_ratio = sides.step(level, *_NEAR), sides.step(ratio, *_NEAR)
    if in_frame is None:
        return False
    whole = abs(sides.step(ratio, 0.0, np.inf))
    is_step = (abs(in_frame) >= max(_LEAST_STEP, _FRAME_STEP * abs(in_ratio))
               and abs(in_ratio) >= _OF_WHOLE * whole)
    return bool(is_step and sides.slope(light) <= _STEEPEST * abs(sides.step(light, *_NEAR)))


def _sides(
    thing: np.ndarray, marked: np.ndarray, rest: np.ndarray, piece: Piece
) -> Tuple['_Sides', np.ndarray, np.ndarray, np.ndarray]:
    inner = cv2.erode(piece.mask, square(5))
    light, usual = in_clearest_colour(piece, thing & marked & inner, rest & inner)
    level = cv2.log(light)
    sides = _Sides(thing & cv2.erode(marked, square(3)) & inner, rest & inner,
                   cv2.distanceTransform(1 - rest, cv2.DIST_L2, 3),
                   cv2.distanceTransform(1 - thing, cv2.DIST_L2, 3))
    return sides, light, level, level - cv2.log(usual)


class _Sides(NamedTuple):
    """Both sides of the border between an object and its shade."""

    thing: np.ndarray
    rest: np.ndarray
    to_rest: np.ndarray
    to_thing: np.ndarray

    def step(self, values: np.ndarray, near: float, far: float) -> Optional[float]:
        """How much higher the median is on the shade's side, between two distances in px."""
        inside, outside = (_median(values, side, distances, near, far) for side, distances in (
            (self.thing, self.to_rest), (self.rest, self.to_thing)))
        return None if inside is None or outside is None else outside - inside

    def slope(self, values: np.ndarray) -> float:
        """How much the object's own side changes on the way to the border."""
        near, farther = (_median(values, self.thing, self.to_rest, *distances)
                         for distances in (_CLOSE, _FARTHER))
        return 0.0 if near is None or farther is None else abs(near - farther)


def _median(
    values: np.ndarray, side: np.ndarray, distances: np.ndarray, near: float, far: float
) -> Optional[float]:
    chosen = values[(side > 0) & (distances > near) & (distances <= far)]
    return float(quantile(chosen)) if len(chosen) >= _LEAST_RING else None


def split_off_shade(piece: Piece) -> Optional[np.ndarray]:
    """
    Find the object in a region that is an object and its shade.

    What is split off may be its lighter face, or it is a face of what is split off.

    :returns: Its mask, shape (h, w), uint8, 1 inside; None for other regions.
    """
    core = cv2.erode(piece.mask, square(5))
    if cv2.countNonZero(core) < _LEAST_CORE:
        return None
    look = look_at(piece)
    special = _special(look, piece.mask)
    if 2 * cv2.countNonZero(special & core) >= cv2.countNonZero(core) or _is_dazzled(piece):
        return None
    spot = find_highlight(piece)
    if spot is not None:
        special |= spot & piece.mask
    thing = _darker_thing(piece, look, core, special)
    if thing is not None and spot is not None and surrounds(
            spot, thing, _lighter_side(thing, piece.mask)):
        return None
    return thing


def _is_dazzled(piece: Piece) -> bool:
    # Beside a lamp's mirror image on the table, ratios tell nothing of shade.
    around = cv2.dilate(piece.mask, square(9))
    bright = (channel_extremes(piece.table)[1] > _SATURATED).astype(np.uint8)
    share = cv2.countNonZero(around & bright) / cv2.countNonZero(around)
    return _MOST_SATURATED < share < 1 - _MOST_SATURATED


def _special(look: Look, mask: np.ndarray) -> np.ndarray:
    special = ((look.largest > _LIGHT) | (look.tint > _COLOURED)).astype(np.uint8)
    return cv2.morphologyEx(mask & special, cv2.MORPH_OPEN, square(3))


def _darker_thing(
    piece: Piece, look: Look, core: np.ndarray, special: np.ndarray
) -> Optional[np.ndarray]:
    ratio = look.ratio
    ratios = ratio[(core & (1 - special)) > 0]
    if len(ratios) < _LEAST_CORE:
        return None
    dark = ratios <= _otsu(ratios)
    if not _LEAST_SHADE_PART < dark.sum() < len(dark) - _LEAST_SHADE_PART:
        return None
    low, high = ratios[dark].mean(), ratios[~dark].mean()
    if high - low < _LEVELS_APART:
        return None
    darker = piece.mask & (ratio <= (low + high) / 2).astype(np.uint8)
    darker |= special
    gap = 9 if special.any() else 3
    thing = largest_part(cv2.morphologyEx(darker, cv2.MORPH_CLOSE, square(gap)))
    rest = _lighter_side(thing, piece.mask)
    if not special.any() and solidity(rest) > solidity(thing) + _MORE_CONVEX:
        # A shadow is what its object leaves of it, a crescent.
        thing = darker = rest
    return thing if _is_thing_and_shade(thing, darker, piece, look) else None


def _lighter_side(dark: np.ndarray, mask: np.ndarray) -> np.ndarray:
    # Without the rim, which is lighter on all sides.
    rest = cv2.erode(mask, square(5)) & (1 - dark)
    rest = largest_part(cv2.morphologyEx(rest, cv2.MORPH_OPEN, square(3)))
    return cv2.dilate(rest, square(5)) & mask & (1 - dark)


def _otsu(ratios: np.ndarray) -> float:
    steps = np.clip(np.rint((ratios - _LOWEST) * _STEPS), 0, 255).astype(np.uint8)
    level, _ = cv2.threshold(steps.reshape(-1, 1), 0, 255, cv2.THRESH_OTSU)
    return level / _STEPS + _LOWEST
