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
Ranks detections: the largest first, but no shadow alone before an object.

The first one is what an arm goes to. A shadow whose object is cut off, or is as light as the
table, may be found without it. It takes light in all colours alike, and it is a crescent, or its
rim is soft. A grey object is neither.
"""

from itertools import takewhile
from typing import List

from camera_to_base.detection.detection import Box, Detection
from camera_to_base.detection.precise.light import LINEAR
from camera_to_base.detection.precise.piece import channel_extremes, square
from camera_to_base.detection.precise.regions import filled, grown, slices
import cv2
import numpy as np

_MOST, _ROW_STEP = 10, 3
# What shade can be: the least and the largest ratio, and the strongest tint; on which part.
_DEEPEST, _FAINTEST, _TINT, _LEAST_SHADE, _LEAST_LIGHT = 0.25, 0.985, 1.25, 0.8, 1e-3
# An outline that fills less of its hull is a crescent.
_LEAST_SOLIDITY = 0.85
# How sharp a rim is, on which part of it, told from the steps in windows of two sizes in px.
_SHARP, _LEAST_RIM, _WINDOWS = 0.6, 0.5, (5, 11)


def ranked(
    found: List[Detection], frame: np.ndarray, background: np.ndarray
) -> List[Detection]:
    """
    Sort detections.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    """
    found = sorted(found, key=lambda detection: -detection.area)
    if len(found) < 2:
        return found
    # Most frames have no such shadow: only until an object is the first, each look takes time.
    shadows = list(takewhile(lambda one: _is_shadow(one, frame, background), found[:_MOST]))
    return found[len(shadows):] + shadows


def _is_shadow(detection: Detection, frame: np.ndarray, background: np.ndarray) -> bool:
    if detection.cut_off:
        return False
    outline = np.int32(detection.outline)[:, None]
    part = slices(detection.box)
    if not _is_shade(frame[part], background[part], filled(outline, detection.box)):
        return False
    if _is_crescent(outline):
        return True
    window = grown(detection.box, max(_WINDOWS), frame)
    return not _has_sharp_rim(frame[slices(window)], outline, window)


def _is_shade(piece: np.ndarray, table: np.ndarray, inside: np.ndarray) -> bool:
    # Some rows tell as much as all.
    piece, table, inside = (picture[::_ROW_STEP] for picture in (piece, table, inside))
    light, usual = cv2.LUT(piece, LINEAR), cv2.LUT(table, LINEAR)
    ratio = cv2.divide(light, cv2.max(usual, _LEAST_LIGHT))
    least = _LEAST_SHADE * cv2.countNonZero(inside)
    # Most objects are too dark or too light: their tint need not be looked at.
    may_be = cv2.inRange(ratio, (_DEEPEST,) * 3, (_FAINTEST,) * 3)
    if cv2.countNonZero(cv2.bitwise_and(may_be, inside)) <= least:
        return False
    smallest, largest = channel_extremes(ratio)
    shade = (smallest > _DEEPEST) & (largest < _FAINTEST) & (largest < _TINT * smallest)
    shade = cv2.bitwise_and(shade.view(np.uint8), inside)
    return cv2.countNonZero(shade) > least


def _is_crescent(outline: np.ndarray) -> bool:
    hull = cv2.contourArea(cv2.convexHull(outline))
    return cv2.contourArea(outline) < _LEAST_SOLIDITY * hull


def _has_sharp_rim(piece: np.ndarray, outline: np.ndarray, window: Box) -> bool:
    # At a sharp step, a small window shows as large a step as a larger window does.
    x, y = outline[:, 0, 0] - window.x, outline[:, 0, 1] - window.y
    near, far = (np.float32(channel_extremes(
        cv2.morphologyEx(piece, cv2.MORPH_GRADIENT, square(size)))[1]) for size in _WINDOWS)
    return bool((near > _SHARP * far)[y, x].mean() >= _LEAST_RIM)
