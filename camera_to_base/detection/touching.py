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
"""

from itertools import combinations
from typing import Iterator, List, Optional, Tuple

from camera_to_base.detection.precise.piece import largest_part, outline_of
import cv2
import numpy as np

# A notch is at least this deep, in px and as a part of the square root of the area.
_DEEPEST_FLAW, _LEAST_NOTCH = 1.5, 0.06
# The neck beside the narrower part's width.
_WIDEST_NECK = 0.6
# How much of its convex hull a part fills; a small one's outline is ragged.
_LEAST_SOLIDITY, _SMALLEST = 0.9, 30
_MOST_NOTCHES, _MOST_PARTS = 12, 12


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
        rest = mask.copy()
        cv2.line(rest, start, end, 0, 1, cv2.LINE_8)
        count, labels = cv2.connectedComponents(rest, connectivity=4)
        if count < 3:
            continue
        first, second = sorted(((labels == label).astype(np.uint8) for label in range(1, count)),
                               key=cv2.countNonZero)[-2:]
        widest = _WIDEST_NECK * min(_width(first), _width(second))
        if cv2.countNonZero(first) >= _SMALLEST and np.hypot(*np.subtract(end, start)) <= widest:
            return first, second
    return None


def _necks(mask: np.ndarray) -> Iterator[Tuple[Tuple[int, int], Tuple[int, int]]]:
    notches = _notches(mask)
    pairs = [tuple(tuple(map(int, notch)) for notch in pair) for pair in combinations(notches, 2)]
    return iter(sorted(pairs, key=lambda pair: np.hypot(*np.subtract(*pair))))


def _notches(mask: np.ndarray) -> List[np.ndarray]:
    outline = outline_of(mask)
    if outline is None or len(outline) < 8:
        return []
    hull = cv2.convexHull(outline, returnPoints=False)
    try:
        defects = cv2.convexityDefects(outline, hull)
    except cv2.error:
        return []  # an outline that touches itself has no order
    if defects is None:
        return []
    least = max(_DEEPEST_FLAW, _LEAST_NOTCH * np.sqrt(cv2.countNonZero(mask)))
    deep = sorted((defect for defect in defects.reshape(-1, 4) if defect[3] / 256 >= least),
                  key=lambda defect: -defect[3])
    return [outline[defect[2], 0] for defect in deep[:_MOST_NOTCHES]]


def _width(mask: np.ndarray) -> float:
    outline = outline_of(mask)
    return 0.0 if outline is None else min(cv2.minAreaRect(outline)[1]) + 1


def _is_convex(mask: np.ndarray) -> bool:
    outline = outline_of(mask)
    hull = cv2.contourArea(cv2.convexHull(outline))
    return hull > 0 and cv2.contourArea(outline) >= _LEAST_SOLIDITY * hull


def _grown_together(parts: List[np.ndarray], mask: np.ndarray) -> List[np.ndarray]:
    # The cut's own pixels belong to the nearest part.
    nearest = nearest_part(parts)
    return [largest_part(mask & (nearest == index).astype(np.uint8))
            for index in range(len(parts))]


def nearest_part(parts: List[np.ndarray]) -> np.ndarray:
    """Tell which of some masks is nearest to each pixel: shape (h, w), its index."""
    return np.argmin([cv2.distanceTransform(1 - part, cv2.DIST_L2, 5) for part in parts], axis=0)
