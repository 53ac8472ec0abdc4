# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
What a lamp's highlight does: on a glossy thing, and in glass.

A highlight is lighter than the table on an object that is darker, so that somewhere around it the
object looks like the table. What surrounds a highlight belongs to the object, and near one the
rim cannot be told from brightness, but from how the outline runs elsewhere.
"""

import math
from typing import List, Optional, Sequence

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.piece import (
    channel_extremes, channel_sum, disc, filled, outlines_in, Piece, slices, solidity, square)
import cv2
import numpy as np

# How much lighter than the table a spot is, how large a part of its region, how many px, and from
# which light on the sensor has cut it off.
_BRIGHTER, _LARGEST_SHARE, _LEAST_AREA, _SATURATED = 1.05, 0.35, 4, 0.95
# How far a spot's surroundings reach, in px.
_AROUND = disc(9)
# How far its light is seen around it, as a part of its size, and the part of the border between an
# object and its shade that may lie there.
_REACH, _MOST_BORDER = 0.25, 0.5
_OFFSETS = np.arange(0, 3.01, 0.25)
# It is a thing's where this part of what is around it is surely one: around glass, none is.
_OF_THING = 0.3
# It is a part of a thing that is so far away at most, px, and then fills its convex hull by this
# much more, and so far; and differs from the table by this part of what the thing does, or more.
_NEAR, _ROUNDER, _ROUND, _AS_BRIGHT = 9, 0.02, 0.88, 0.4
# What is no more than a highlight has so much of a thing around it, and is cut off on this part.
_MOSTLY, _CUT_OFF = 0.6, 0.5


def lighter(piece: Piece) -> np.ndarray:
    """Find what is lighter than the table: shape (h, w), uint8, 1 there."""
    return (channel_sum(piece.frame) > _BRIGHTER * channel_sum(piece.table)).view(np.uint8)


def find_highlight(piece: Piece) -> Optional[np.ndarray]:
    """
    Find a spot of saturated light on an object that is darker elsewhere, with its surroundings.

    :returns: Shape (h, w), uint8, 1 there; None where there is none.
    """
    saturated = channel_extremes(piece.frame)[0] > _SATURATED
    if not saturated.any():
        return None
    light = lighter(piece) & piece.mask
    spot = light.astype(bool)
    is_small = _LEAST_AREA <= spot.sum() < _LARGEST_SHARE * cv2.countNonZero(piece.mask)
    if not is_small or not saturated[spot].any():
        return None
    return cv2.dilate(light, _AROUND)


def surrounds(highlight: np.ndarray, thing: np.ndarray, rest: np.ndarray) -> bool:
    """
    Tell whether a part that looks like an object's shade lies between its highlight and its rim.

    :param highlight: See :func:`find_highlight`.
    :param thing: The object without the part, shape (h, w), uint8, 1 inside.
    :param rest: The part.
    """
    border = cv2.dilate(rest, square(5)) & thing
    reach = 2 * int(_REACH * math.sqrt(cv2.countNonZero(highlight))) + 3
    near = cv2.countNonZero(border & cv2.dilate(highlight, square(reach)))
    return near > _MOST_BORDER * cv2.countNonZero(border)


def complete_shares(shares: np.ndarray, mask: np.ndarray, highlight: np.ndarray) -> np.ndarray:
    """
    Give the pixels around a highlight the share that their depth in the region has elsewhere.

    :param shares: How much of each pixel the object covers, shape (h, w), float32.
    :param mask: The region, shape (h, w), uint8; it reaches a little beyond the object.
    :param highlight: See :func:`find_highlight`.
    """
    depth = cv2.distanceTransform(mask, cv2.DIST_L2, 5)
    clear = (1 - highlight) * cv2.dilate(mask, square(3))
    wanted = float((shares * clear).sum())
    too_much = [abs(float((np.clip(depth - offset, 0, 1) * clear).sum()) - wanted)
                for offset in _OFFSETS]
    offset = _OFFSETS[int(np.argmin(too_much))]
    return np.where(highlight > 0, np.clip(depth - offset, 0, 1), shares).astype(np.float32)


def is_on(thing: np.ndarray, highlight: np.ndarray, changed: np.ndarray) -> bool:
    """
    Tell whether a highlight is a thing's, and no glass's nor a lamp's mirror image.

    :param thing: What is surely none of these, shape (h, w), uint8, 1 inside.
    :param highlight: See :func:`find_highlight`.
    :param changed: The region.
    """
    around = cv2.dilate(highlight, square(3)) & (1 - highlight) & changed
    return cv2.countNonZero(around & thing) > _OF_THING * cv2.countNonZero(around)


def with_highlights(
    things: Sequence[np.ndarray], change: np.ndarray, bright: np.ndarray, changed: np.ndarray
) -> List[np.ndarray]:
    """
    Give things with the highlights that were taken for light, or for things of their own.

    :param things: Each of shape (h, w), uint8, 1 inside.
    :param change: By how much the level has changed, of that shape, float32.
    :param bright: What is lighter than the table.
    :param changed: The region.
    """
    bright = cv2.morphologyEx(bright & changed, cv2.MORPH_OPEN, square(3))
    result: List[np.ndarray] = []
    for thing in sorted(things, key=cv2.countNonZero, reverse=True):
        area = cv2.countNonZero(thing)
        if any(2 * cv2.countNonZero(thing & one) > area for one in result):
            continue
        spots = outlines_in(bright & (1 - thing))
        near = cv2.dilate(thing, square(_NEAR)) if spots else thing
        for outline in spots:
            box = Box(*cv2.boundingRect(outline))
            spot = filled(outline, box)
            # The glow around a bright thing is no highlight.
            if (cv2.countNonZero(spot & near[slices(box)]) and cv2.countNonZero(spot) < area
                    and cv2.mean(change[slices(box)], spot)[0]
                    > _AS_BRIGHT * cv2.mean(change, thing)[0]):
                joined = thing.copy()
                joined[slices(box)] |= spot
                joined = cv2.morphologyEx(joined, cv2.MORPH_CLOSE, square(_NEAR))
                if solidity(joined) > max(solidity(thing) + _ROUNDER, _ROUND):
                    thing = thing | joined & changed
        result.append(thing)
    return result


def may_be_highlight(thing: np.ndarray, changed: np.ndarray, cut_off: np.ndarray) -> bool:
    """Tell whether a thing may be no more than a highlight on what is around it."""
    if cv2.countNonZero(thing & cut_off) <= _CUT_OFF * cv2.countNonZero(thing):
        return False
    around = cv2.dilate(thing, square(5)) & (1 - thing)
    return cv2.countNonZero(around & changed) > _MOSTLY * cv2.countNonZero(around)
