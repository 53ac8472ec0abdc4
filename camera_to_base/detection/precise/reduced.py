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
Reduces a large piece to half of its size, or less: the place of a large object needs no more.

Light is averaged, so that a pixel on the rim still shows the share that the object covers.
"""

from typing import Tuple

from camera_to_base.detection.precise.piece import Piece
import cv2
import numpy as np


def reduced(piece: Piece, most: int) -> Tuple[Piece, int]:
    """
    Reduce a piece until it has few pixels.

    :param most: How many pixels it may have.
    :returns: The piece, and how many px of the given one make one of its px, along each axis.
    """
    scale = 1
    while piece.mask.size > most:
        piece, scale = _halved(piece), 2 * scale
    return piece, scale


def enlarged(picture: np.ndarray, scale: int, like: np.ndarray) -> np.ndarray:
    """Bring a picture of a reduced piece back to the size of another: shape (h, w)."""
    if scale == 1:
        return picture
    height, width = picture.shape
    whole = cv2.resize(
        picture, (width * scale, height * scale), interpolation=cv2.INTER_NEAREST)
    return whole[:like.shape[0], :like.shape[1]]


def _halved(piece: Piece) -> Piece:
    frame, table, mask = (_half(picture) for picture in piece)
    return Piece(frame, table, mask)


def _half(picture: np.ndarray) -> np.ndarray:
    height, width = picture.shape[:2]
    # A last odd row or column is doubled, so that what touches the border still touches it.
    even = cv2.copyMakeBorder(picture, 0, height % 2, 0, width % 2, cv2.BORDER_REPLICATE)
    return cv2.resize(even, (even.shape[1] // 2, even.shape[0] // 2), interpolation=cv2.INTER_AREA)
