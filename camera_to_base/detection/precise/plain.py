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

Most objects are plain, and their place follows from one projection, without a look at their
surroundings, in a window that is hardly larger than the object. What decides between the ways:

- the region lies within the picture, and its inside is wide enough to be judged,
- its inside is as even as noise allows: it has one level and no highlight,
- few pixels lie between its colour and the table's: shade and blurred rims would be among them,
- the table differs from its colour all along the rim: it is not faint,
- what is covered is one part.

Everything else goes the long way, see `shares`. On a plain object both ways give the same place.
"""

import operator
from typing import List, NamedTuple, Optional

from camera_to_base.detection.precise.light import LINEAR
from camera_to_base.detection.precise.piece import outlines_in, square
from camera_to_base.detection.precise.shares import Placed
import cv2
import numpy as np

_LEAST_CORE = 20
_EVEN_LEVELS, _EVEN_DEVIATIONS = 4.0, 2.5
_COVERED, _WIDEST_RIM = 0.8, 2.6
_LEAST_CONTRAST, _LEAST_SPAN, _SURELY_OTHER = 0.02, 0.12, 0.5
_LINEAR = LINEAR.tolist()


class Plain(NamedTuple):
    """
    A plain object in its window.

    :param placed: Its place.
    :param is_new: Whether the background around it has another colour: it is no ghost.
    """

    placed: Placed
    is_new: bool


def place_plain(
    frame: np.ndarray, table: np.ndarray, mask: np.ndarray, noise: float
) -> Optional[Plain]:
    """
    Place a plain object.

    :param frame: A window of the frame, shape (h, w, 3), uint8, BGR.
    :param table: The background's at the frame's light, of the same shape.
    :param mask: The region, shape (h, w), uint8, 1 inside; the window is a little larger.
    :param noise: Deviation of the noise, in grey levels.
    :returns: None where the object is not plain.
    """
    core = cv2.erode(mask, square(7))
    if cv2.countNonZero(core) < _LEAST_CORE:
        return None
    level, deviation = cv2.meanStdDev(frame, mask=core)
    if deviation.max() > max(_EVEN_LEVELS, _EVEN_DEVIATIONS * noise):
        return None
    thing = [_light(value) for value in level[:, 0].tolist()]
    usual = [_light(value) for value in cv2.mean(table, mask)[:3]]
    contrast = [one - other for one, other in zip(usual, thing)]
    if max(map(abs, contrast)) < _LEAST_CONTRAST:
        return None
    return _projected(frame, table, mask, core, thing, contrast)


def _light(level: float) -> float:
    lower = min(int(level), 254)
    return _LINEAR[lower] + (level - lower) * (_LINEAR[lower + 1] - _LINEAR[lower])


def _projected(
    frame: np.ndarray, table: np.ndarray, mask: np.ndarray, core: np.ndarray, thing: List[float],
    contrast: List[float]
) -> Optional[Plain]:
    # From the object's colour to the table's: 0 where all is object, `span` where all is table.
    power = sum(value ** 2 for value in contrast)
    to_table = np.float32([[*contrast, -sum(map(operator.mul, contrast, thing))]])
    seen, span = (cv2.transform(cv2.LUT(levels, LINEAR), to_table) for levels in (frame, table))
    near = cv2.dilate(mask, square(3))
    if cv2.minMaxLoc(span, near)[0] < _LEAST_SPAN * power:
        return None
    shares = cv2.copyTo(1 - cv2.divide(seen, span), near)
    inner_rim = cv2.countNonZero(core) - cv2.countNonZero(cv2.erode(core, square(3)))
    between = cv2.countNonZero(mask) - _count_above(shares, _COVERED)
    if between > _WIDEST_RIM * inner_rim:
        return None
    _, shares = cv2.threshold(shares, 1, 0, cv2.THRESH_TRUNC)
    shares = cv2.max(cv2.threshold(shares, 0, 0, cv2.THRESH_TOZERO)[1], np.float32(core))
    covered = (shares > 0.5).view(np.uint8)
    outlines = outlines_in(covered)
    if len(outlines) != 1:
        return None
    is_new = cv2.mean(span, 1 - near)[0] > _SURELY_OTHER * power
    return Plain(Placed(shares, covered, outlines[0]), is_new)


def _count_above(values: np.ndarray, limit: float) -> int:
    return cv2.countNonZero((values > limit).view(np.uint8))
