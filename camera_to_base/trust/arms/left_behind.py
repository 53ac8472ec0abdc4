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

"""Tells an object's outline from one that is partly that of an object which has left."""

import cv2
import numpy as np

# Width of the rim on which edges are compared, in px, and how far one reaches into it.
_RIM_PX, _EDGE = 5, np.ones((5, 5), np.uint8)
_RIM = np.ones((_RIM_PX, _RIM_PX), np.uint8)
# An edge of the background is strong from this part of the rim's strongest edges on, and lost
# where the frame has less than that part of it.
_STRONG, _LOST = 0.5, 0.4
# The least strength, in levels, and how much of the rim such edges are.
_LEAST_LEVELS, _LEAST_SHARE = 12.0, 0.12


class LeftBehind:
    """
    Finds outlines along which the background has an edge and the frame has none.

    Where an object of the background has moved by less than its width, its old and its new place
    make up one region. An object that is there has an edge all around it.

    :param background: Shape (h, w, 3), uint8, BGR.
    """

    def __init__(self, background: np.ndarray) -> None:
        self._edges = _edges(background)

    def is_part_of(self, frame: np.ndarray, outline: np.ndarray, gain: float) -> bool:
        """
        Tell whether an outline is partly that of an object which has left.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param outline: Shape (n, 2), int32, columns u and v in px.
        :param gain: How much brighter the frame is than the background.
        """
        left, top, width, height = cv2.boundingRect(outline)
        left, top = max(left - _RIM_PX, 0), max(top - _RIM_PX, 0)
        window = np.s_[top:top + height + 2 * _RIM_PX, left:left + width + 2 * _RIM_PX]
        before = self._edges[window]
        if cv2.norm(before, cv2.NORM_INF) * gain < _LEAST_LEVELS:
            return False
        before = cv2.convertScaleAbs(before, alpha=gain)
        rim = _rim(outline, left, top, before)
        clear = cv2.bitwise_and(
            rim, cv2.threshold(before, _LEAST_LEVELS, 1, cv2.THRESH_BINARY)[1])
        least = _LEAST_SHARE * cv2.countNonZero(rim)
        if cv2.countNonZero(clear) < least:
            return False
        now = _edges(frame[window])
        # Hardly any object gets farther than this: a little more than what is lost.
        faint = cv2.compare(now, cv2.convertScaleAbs(before, alpha=_LOST, beta=0.5), cv2.CMP_LT)
        if cv2.countNonZero(cv2.bitwise_and(clear, faint)) < least:
            return False
        rim = rim.view(bool)
        before, now = before[rim], now[rim]
        strong = max(_STRONG * _upper_tenth(np.maximum(before, now)), _LEAST_LEVELS)
        is_lost = (before > strong) & (now < _LOST * before)
        return np.count_nonzero(is_lost) >= least


def _rim(outline: np.ndarray, left: int, top: int, window: np.ndarray) -> np.ndarray:
    rim = np.zeros(window.shape[:2], np.uint8)
    # To draw a line of the rim's width takes three times as long.
    cv2.drawContours(rim, [outline], 0, 1, offset=(-left, -top))
    return cv2.dilate(rim, _RIM)


def _upper_tenth(levels: np.ndarray) -> float:
    place = int(0.9 * (levels.size - 1))
    return float(np.partition(levels, place)[place])


def _edges(picture: np.ndarray) -> np.ndarray:
    edges = cv2.split(cv2.morphologyEx(picture, cv2.MORPH_GRADIENT, _EDGE))
    return cv2.max(cv2.max(edges[0], edges[1]), edges[2])
