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
Highlights: a spot of light on a glossy object.

A highlight is lighter than the table on an object that is darker, so that somewhere around it the
object looks like the table. What surrounds a highlight belongs to the object, and near one the
rim cannot be told from brightness, but from how the outline runs elsewhere.
"""

import math
from typing import Optional

from camera_to_base.detection.precise.piece import (
    channel_extremes, channel_sum, disc, largest_part, Piece, square)
import cv2
import numpy as np

_BRIGHTER, _LARGEST_SHARE, _LEAST_AREA = 1.05, 0.35, 4
_SATURATED = 0.95
# How far a spot's surroundings reach, in px.
_AROUND = disc(9)
# How far its light is seen around it, as a part of its size, and the part of the border between an
# object and its shade that may lie there.
_REACH, _MOST_BORDER = 0.25, 0.5
_OFFSETS = np.arange(0, 3.01, 0.25)


def find_highlight(piece: Piece) -> Optional[np.ndarray]:
    """
    Find a spot of saturated light on an object that is darker elsewhere, with its surroundings.

    :returns: Shape (h, w), uint8, 1 there; None where there is none.
    """
    light = _lighter(piece, piece.mask)
    spot = light.astype(bool)
    is_small = _LEAST_AREA <= spot.sum() < _LARGEST_SHARE * cv2.countNonZero(piece.mask)
    if not is_small or not (channel_extremes(piece.frame)[0][spot] > _SATURATED).any():
        return None
    return cv2.dilate(light, _AROUND)


def close_around_highlights(piece: Piece) -> np.ndarray:
    """Give a piece's mask with what lies between its highlights and its rim."""
    if find_highlight(piece) is None:
        return piece.mask
    light = _lighter(piece, cv2.dilate(piece.mask, disc(5)))
    return largest_part(cv2.morphologyEx(piece.mask | light, cv2.MORPH_CLOSE, _AROUND))


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


def _lighter(piece: Piece, where: np.ndarray) -> np.ndarray:
    light = channel_sum(piece.frame) > _BRIGHTER * channel_sum(piece.table)
    return (light & (where > 0)).astype(np.uint8)
