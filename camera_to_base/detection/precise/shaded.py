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
the shadow, or lighter than the table, or coloured. A shadow's own rim is soft, and a part of the
arm goes on into the arm; so neither is taken for an object.
"""

from typing import Iterator, List, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.piece import (
    in_clearest_colour, Look, look_at, Piece, square)
from camera_to_base.detection.precise.regions import grown, slices
import cv2
import numpy as np

# What no shadow is: lighter, or of a colour. Logarithms of ratios, from dark to very dark: what is
# darker than a shadow, of whatever depth, is set apart by one of them.
_LIGHT, _COLOURED, _DARK = 1.1, 1.6, (-0.5, -0.8, -1.1, -1.5, -2.0, -2.6)
# How sharp a rim is, on which part of it, told from the steps in windows of two sizes in px.
_SHARP, _RIM, _WINDOWS = 0.6, 0.85, (5, 11)
_LEAST_CONTRAST = 0.15


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
        for part in _parts_inside(mask, min_area):
            if not (part & taken).any() and _is_set_apart(*_cut_out(part, piece)):
                found.append(part)
                taken |= part
    return found


def _candidates(piece: Piece, look: Look) -> Iterator[np.ndarray]:
    special = (look.largest > _LIGHT) | (look.tint > _COLOURED)
    yield cv2.morphologyEx(piece.mask & special.astype(np.uint8), cv2.MORPH_OPEN, square(3))
    for ratio in _DARK:
        yield piece.mask & (look.ratio < ratio).astype(np.uint8)


def _parts_inside(mask: np.ndarray, min_area: float) -> Iterator[np.ndarray]:
    height, width = mask.shape
    outlines, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    for outline in outlines:
        x, y, across, down = cv2.boundingRect(outline)
        is_inside = x > 0 and y > 0 and x + across < width and y + down < height
        if is_inside and cv2.contourArea(outline) >= min_area:
            yield cv2.drawContours(np.zeros_like(mask), [outline], 0, 1, cv2.FILLED)


def _cut_out(part: np.ndarray, piece: Piece) -> Tuple[np.ndarray, Piece]:
    window = slices(grown(Box(*cv2.boundingRect(part)), max(_WINDOWS), part))
    return part[window], Piece(*(picture[window] for picture in piece))


def _is_set_apart(part: np.ndarray, piece: Piece) -> bool:
    rim = part & (1 - cv2.erode(part, square(3)))
    around = cv2.dilate(part, square(9)) & (1 - cv2.dilate(part, square(5)))
    level = cv2.log(in_clearest_colour(piece, part, around)[0])
    contrast = np.abs(np.median(level[rim > 0]) - np.median(level[around > 0]))
    # At a sharp step, a small window shows as large a step as a larger window does.
    near, far = (cv2.morphologyEx(level, cv2.MORPH_GRADIENT, square(size))[rim > 0]
                 for size in _WINDOWS)
    return bool(contrast > _LEAST_CONTRAST and (near > _SHARP * far).mean() >= _RIM)
