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

"""Which ninths of the picture a calibration covers, as a map of text and in words."""

from typing import List, Sequence

from camera_to_base.image_size import ImageSize
import cv2
import numpy as np

NINTHS = ('top left', 'top', 'top right', 'left', 'middle', 'right', 'bottom left', 'bottom',
          'bottom right')
# Shares of a ninth from which on it counts as covered, and as covered in part.
_COVERED, _PARTLY = 0.5, 0.1


def covered_shares(outlines: Sequence[np.ndarray], image_size: ImageSize) -> np.ndarray:
    """
    Measure how much of each ninth of the picture is covered.

    :param outlines: The convex outlines of what was measured, each of shape (n, 2), in px.
    :param image_size: Width and height, in px.
    :returns: Shape (3, 3), 0 to 1, the top row first.
    """
    # At a reduced size, which is accurate enough.
    scale = 300 / np.array(image_size)
    mask = np.zeros((300, 300), np.uint8)
    for outline in outlines:
        cv2.fillConvexPoly(mask, np.round(outline * scale).astype(np.int32), 1)
    return mask.reshape(3, 100, 3, 100).mean(axis=(1, 3))


def map_lines(shares: np.ndarray) -> List[str]:
    """
    Draw the map: '#' for covered, '+' for in part, '.' for not.

    :param shares: Shape (3, 3), see :func:`covered_shares`.
    """
    return [' '.join(_mark(share) for share in row) for row in shares]


def uncovered(shares: np.ndarray) -> List[str]:
    """Name the ninths that are not covered, those of which least is covered first."""
    order = np.argsort(shares.ravel(), kind='stable')
    return [NINTHS[index] for index in order if shares.ravel()[index] < _COVERED]


def _mark(share: float) -> str:
    return '#' if share >= _COVERED else '+' if share >= _PARTLY else '.'
