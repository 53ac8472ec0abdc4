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
The short way for plain objects: of one colour, with a sharp rim, on a table without shade.

An object is plain where its inside is as even as noise allows, and where few pixels lie between
its colour and the table's: a shadow or a highlight would be among them. Its place then follows
from one projection, without a look at its surroundings. On a plain object both ways give the same
place, see `shares`.
"""

from typing import Optional

from camera_to_base.detection.precise.piece import largest_part, Piece, square
from camera_to_base.detection.precise.shares import Placed
import cv2
import numpy as np

_LEAST_CORE = 20
# Deviation inside of the object, in grey levels and in deviations of the noise.
_EVEN_LEVELS, _EVEN_DEVIATIONS = 4.0, 2.5
# Pixels between the object's colour and the table's, for each pixel of the core's outline.
_COVERED, _WIDEST_RIM = 0.8, 2.6
_LEAST_CONTRAST = 0.02


def place_plain(frame: np.ndarray, piece: Piece, noise: float) -> Optional[Placed]:
    """
    Place a plain object.

    :param frame: The piece's frame, shape (h, w, 3), uint8, BGR.
    :param noise: Deviation of the noise, in grey levels.
    :returns: None where the object is not plain.
    """
    core = cv2.erode(piece.mask, square(7))
    if cv2.countNonZero(core) < _LEAST_CORE:
        return None
    _, deviation = cv2.meanStdDev(frame, mask=core)
    if deviation.max() > max(_EVEN_LEVELS, _EVEN_DEVIATIONS * noise):
        return None
    shares = _shares(piece, core)
    if shares is None:
        return None
    between = piece.mask & (shares < _COVERED).astype(np.uint8)
    outline = core & (1 - cv2.erode(core, square(3)))
    if cv2.countNonZero(between) > _WIDEST_RIM * cv2.countNonZero(outline):
        return None
    shares = np.maximum(np.clip(shares, 0, 1) * cv2.dilate(piece.mask, square(3)), core)
    covered = (shares > 0.5).astype(np.uint8)
    # Several parts are more than one plain object.
    is_one = cv2.countNonZero(covered & (1 - largest_part(covered))) == 0
    return Placed(shares, covered) if is_one else None


def _shares(piece: Piece, core: np.ndarray) -> Optional[np.ndarray]:
    thing = np.float32(cv2.mean(piece.frame, core)[:3])
    contrast = np.float32(cv2.mean(piece.table, piece.mask)[:3]) - thing
    if np.abs(contrast).max() < _LEAST_CONTRAST:
        return None
    weights = contrast.reshape(1, 3)
    table, frame = (cv2.transform(light, weights) for light in (piece.table, piece.frame))
    span = table - float(contrast @ thing)
    if span.min() < 0.3 * float(contrast @ contrast):
        return None
    return (table - frame) / span
