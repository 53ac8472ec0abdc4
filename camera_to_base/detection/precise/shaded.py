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
Finds whole objects in a region that reaches in from the picture's edge: a coin in an arm's shadow.

An arm, its shadow and what lies in the shadow are one region. A part of it is an object of its own
where it does not touch the edge and is set apart by a step all around: it is clearly darker than
the shadow, or lighter than the table, or coloured. A shadow's own rim is soft, a part of the arm
goes on into the arm, and what lies on the arm is not surrounded by table or shade; so none of
these is taken for an object.
"""

from typing import Iterator, List

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.piece import (
    in_clearest_colour, Look, look_at, outlines_in, Piece, square)
from camera_to_base.detection.precise.regions import filled, grown, slices
import cv2
import numpy as np

# What no shadow is: lighter, or of a colour. Logarithms of ratios, from dark to very dark: what is
# darker than a shadow, of whatever depth, is set apart by one of them.
_LIGHT, _COLOURED, _DARK = 1.1, 1.6, (-0.5, -0.8, -1.1, -1.5, -2.0, -2.6)
# How sharp a rim is, on which part of it, told from the steps in windows of two sizes in px.
_SHARP, _RIM, _WINDOWS = 0.6, 0.85, (5, 11)
_LEAST_CONTRAST = 0.15
# What surrounds an object: no ratio below this one, on at least this part.
_DEEPEST, _LEAST_AROUND = 0.2, 0.75


def find_shaded(piece: Piece, min_area: float) -> List[np.ndarray]:
    """
    Find the objects in a region that touches the picture's edge.

    :param piece: Where it touches the window's border, it touches the picture's edge.
    :param min_area: In px².
    :returns: A mask of each, shape (h, w), uint8, 1 inside.
    """
    look = look_at(piece)
    found: List[np.ndarray] = []
    taken = np.zeros_like(piece.mask)
    for mask in _candidates(piece, look):
        for outline in _outlines_inside(mask, min_area):
            window = grown(Box(*cv2.boundingRect(outline)), max(_WINDOWS), mask)
            part, inside = slices(window), filled(outline, window)
            if not (inside & taken[part]).any() and _is_set_apart(
                    inside, Piece(*(picture[part] for picture in piece)),
                    Look(*(picture[part] for picture in look))):
                taken[part] |= inside
                found.append(np.zeros_like(taken))
                found[-1][part] = inside
    return found


def _candidates(piece: Piece, look: Look) -> Iterator[np.ndarray]:
    special = (look.largest > _LIGHT) | (look.tint > _COLOURED)
    yield cv2.morphologyEx(piece.mask & special.astype(np.uint8), cv2.MORPH_OPEN, square(3))
    for ratio in _DARK:
        yield piece.mask & (look.ratio < ratio).astype(np.uint8)


def _outlines_inside(mask: np.ndarray, min_area: float) -> Iterator[np.ndarray]:
    height, width = mask.shape
    for outline in outlines_in(mask):
        x, y, across, down = cv2.boundingRect(outline)
        is_inside = x > 0 and y > 0 and x + across < width and y + down < height
        if is_inside and cv2.contourArea(outline) >= min_area:
            yield outline


def _is_set_apart(part: np.ndarray, piece: Piece, look: Look) -> bool:
    rim = part & (1 - cv2.erode(part, square(3)))
    around = cv2.dilate(part, square(9)) & (1 - cv2.dilate(part, square(5)))
    if not _is_on_table(around, look):
        return False
    level = cv2.log(in_clearest_colour(piece, part, around)[0])
    contrast = np.abs(np.median(level[rim > 0]) - np.median(level[around > 0]))
    # At a sharp step, a small window shows as large a step as a larger window does.
    near, far = (cv2.morphologyEx(level, cv2.MORPH_GRADIENT, square(size))[rim > 0]
                 for size in _WINDOWS)
    return bool(contrast > _LEAST_CONTRAST and (near > _SHARP * far).mean() >= _RIM)


def _is_on_table(around: np.ndarray, look: Look) -> bool:
    # Around an object lies the table or shade; around a part of a thing, the thing.
    table = (look.smallest > _DEEPEST) & (look.largest < _LIGHT) & (look.tint < _COLOURED)
    return np.count_nonzero(table & (around > 0)) >= _LEAST_AROUND * cv2.countNonZero(around)
