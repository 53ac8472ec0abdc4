# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Tells which detections light alone could look like, where the evidence of single pixels did not.

Shade and sun keep the table's chroma, and change its level by one factor. A thing that does the
same is told from them in three ways:

- the rim of light is soft, or it is a crescent of one level; it has no sharp edges inside,
- light shows the table's stains and pile, too faint for single pixels, where many of them agree,
- else, where neither the thing nor the table has a colour or a texture of its own, nothing but a
  sharp rim tells, and that is said.

A lamp's mirror image adds its own colour to the table's, so that only its rim tells.
"""

from enum import Enum
import math
import operator
from typing import List, NamedTuple, Optional, Tuple

from camera_to_base.detection.detection import Box, Detection
from camera_to_base.detection.precise.evidence import BRIGHTEST
from camera_to_base.detection.precise.light import LINEAR, log_light, SATURATED
from camera_to_base.detection.precise.piece import (
    channel_extremes, filled, fullness, grown, ratio_of, slices, square, without_rim)
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.shade import (
    change_of, DARKEST, is_neutral, like_light, SHADED)
import cv2
import numpy as np

# What becomes of what may be light as well, see the detector.
LIGHT_OR_THING = ('leave_out', 'leave_out_all', 'publish')
# Some rows tell as much as all.
_ROW_STEP = 3
# What is shade, is so on this part.
_LEAST_SHADE = 0.8
# An outline that fills less of its hull is a crescent's.
_FULL = 0.85
# How sharp a rim is, on which part of it, told from the steps in windows of two sizes in px;
# things that were seen out of focus or in motion are as sharp on a quarter of theirs.
_SHARP, _LEAST_RIM, _WINDOWS, _HARDLY_SHARP = 0.6, 0.5, (5, 11), 0.12
# The least step between two faces in grey levels; the table has less than this part of it; how
# long such edges are, by the square root of the area.
_LEAST_STEP, _SAME_STEP, _LEAST_EDGES = 13.0, 0.4, 0.5
# What is of one colour: its deviation in grey levels, and by that of the noise; and how much more
# a table may deviate where the frame is cut off.
_EVEN_LEVELS, _EVEN_DEVIATIONS, _GRADIENT = 2.0, 2.5, 3.0
# Every so many px are asked, this far from the rim, and at least so many.
_STEP, _INSIDE, _WELL_INSIDE, _LEAST_INSIDE = 2, square(5), square(7), 20
# Stains are wider, px. How alike the frame's and the table's are, by how many deviations of
# chance, and how much of them is seen.
_FINE, _LEAST_LIKENESS, _SURE, _LEAST_SEEN, _MOST_SEEN = 5, 0.4, 4.5, 0.4, 1.6
_NOTHING = 1e-12


def is_soft_light(
    detection: Detection, frame: np.ndarray, reference: Reference, is_thing: bool = False
) -> bool:
    """
    Tell whether a detection has a rim as light has it, and the chroma of light.

    What fades away all around is a lamp's mirror image, whatever its chroma.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param reference: The background at the frame's light.
    :param is_thing: Whether its chroma or its texture is known to be a thing's.
    """
    if detection.cut_off:
        return False
    outline, part = np.int32(detection.outline)[:, None], slices(detection.box)
    pictures, inside = (frame[part], reference.lit[part]), filled(outline, detection.box)
    seen, usual = (cv2.mean(picture, inside)[:3] for picture in pictures)
    if all(map(operator.gt, seen, usual)) and _sharp_part(frame, outline) < _HARDLY_SHARP:
        return True
    if is_thing:
        return False
    is_shade = _is_shade(*pictures, inside)
    if (not (is_shade or _is_shade(*reversed(pictures), inside))
            or _has_edges_inside(*pictures, inside)):
        return False
    if is_shade and fullness(outline) < _FULL:
        levels = _levels_in(detection, frame, reference)
        if levels is None or levels.are_even:
            return True
    return _sharp_part(frame, outline) < _LEAST_RIM


def _is_shade(piece: np.ndarray, table: np.ndarray, inside: np.ndarray) -> bool:
    # Some rows tell as much as all.
    light, usual = (cv2.LUT(picture[::_ROW_STEP], LINEAR) for picture in (piece, table))
    inside = np.ascontiguousarray(inside[::_ROW_STEP])
    is_shade = like_light(ratio_of(light, usual), SHADED)
    return cv2.countNonZero(is_shade & inside) > _LEAST_SHADE * cv2.countNonZero(inside)


def _has_edges_inside(piece: np.ndarray, table: np.ndarray, inside: np.ndarray) -> bool:
    """Tell whether there are sharp steps inside that are not the table's: faces of a thing."""
    seen, usual = (cv2.blur(picture, (3, 3)) for picture in (piece, table))
    near, far = (_steps(seen, size) for size in _WINDOWS)
    own = _steps(usual, _WINDOWS[1])
    sharp = (near > _SHARP * far) & (far > _LEAST_STEP) & (own < _SAME_STEP * far)
    edges = without_rim(inside, _WELL_INSIDE) & sharp.view(np.uint8)
    # Around an edge, a step is seen in as many px as the window has.
    length = cv2.countNonZero(edges) / _WINDOWS[0]
    return length > _LEAST_EDGES * math.sqrt(cv2.countNonZero(inside))


def _steps(piece: np.ndarray, size: int) -> np.ndarray:
    """Give the step of levels in the window around each pixel: shape (h, w), float32."""
    return np.float32(channel_extremes(
        cv2.morphologyEx(piece, cv2.MORPH_GRADIENT, square(size)))[1])


def _sharp_part(frame: np.ndarray, outline: np.ndarray) -> float:
    """Tell which part of an outline is sharp: there, a small window shows as large a step."""
    window = grown(Box(*cv2.boundingRect(outline)), max(_WINDOWS), frame)
    x, y = outline[:, 0, 0] - window.x, outline[:, 0, 1] - window.y
    near, far = (_steps(frame[slices(window)], size) for size in _WINDOWS)
    return float((near > _SHARP * far)[y, x].mean())


class Told(Enum):
    """What a frame tells of a detection, by the words of :class:`NoObject`."""

    THING = 'thing'
    LIGHT = 'light'
    SHADE = 'shade'
    NEITHER = 'light_or_thing'

    @property
    def is_light(self) -> bool:
        """Whether it is no thing."""
        return self in (Told.LIGHT, Told.SHADE)


def told(detection: Detection, frame: np.ndarray, reference: Reference) -> Told:
    """
    Tell whether a detection is light.

    It is where the table's unevenness is seen in it. Neither is told where light of one level
    would make the table's one colour, or its gradient, what the detection shows.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param reference: The background at the frame's light.
    """
    levels = None if detection.cut_off else _levels_in(detection, frame, reference)
    if levels is None:
        return Told.THING
    chroma, ratio = change_of(levels.seen, levels.usual)
    if not DARKEST < ratio < BRIGHTEST or not is_neutral(chroma, ratio):
        return Told.THING
    box, part = detection.box, slices(detection.box)
    inside = without_rim(filled(np.int32(detection.outline)[:, None], box), _WELL_INSIDE)
    if _shows_unevenness(frame[part], reference.lit[part], inside):
        return Told.LIGHT if sum(levels.seen) > sum(levels.usual) else Told.SHADE
    return Told.NEITHER if levels.are_even else Told.THING


class _Levels(NamedTuple):
    """
    The grey levels inside of a detection, B, G and R.

    :param seen: The frame's means.
    :param usual: The table's.
    :param are_even: Whether both have one level, but for noise and what light keeps of the table.
    """

    seen: List[float]
    usual: List[float]
    are_even: bool


def _levels_in(
    detection: Detection, frame: np.ndarray, reference: Reference
) -> Optional[_Levels]:
    """Look inside of a detection; None where it is too narrow."""
    box, part = detection.box, slices(detection.box)
    # Some pixels tell as much as all.
    pictures = [np.ascontiguousarray(picture[part][::_STEP, ::_STEP])
                for picture in (frame, reference.lit)]
    some = np.zeros(pictures[0].shape[:2], np.uint8)
    outline = np.int32(detection.outline)[:, None]
    cv2.drawContours(some, [(outline - (box.x, box.y)) // _STEP], 0, 1, cv2.FILLED)
    some = without_rim(some, _INSIDE)
    if cv2.countNonZero(some) < _LEAST_INSIDE:
        return None
    (level, spread), (usual, usual_spread) = (
        cv2.meanStdDev(picture, mask=some) for picture in pictures)
    most = max(_EVEN_LEVELS, _EVEN_DEVIATIONS * reference.mean_noise)
    are_even = max(spread.max(), usual_spread.max()) <= most
    if not are_even:
        # Light of one level keeps the table's gradients; what is cut off has lost them.
        gain = level / np.maximum(usual, 1)
        change = np.float32(pictures[0]) - np.float32(pictures[1]) * np.float32(gain[:, 0])
        off = cv2.meanStdDev(change, mask=some)[1]
        is_lost = (level >= SATURATED) & (spread <= most) & (usual_spread <= _GRADIENT * most)
        are_even = bool((is_lost | (off <= most * np.sqrt(1 + gain ** 2))).all())
    return _Levels(level[:, 0].tolist(), usual[:, 0].tolist(), are_even)


def _shows_unevenness(seen: np.ndarray, table: np.ndarray, inside: np.ndarray) -> bool:
    """Tell whether the table's stains and pile, too faint for single pixels, are seen."""
    levels = [cv2.blur(log_light(np.ascontiguousarray(picture)), (_FINE, _FINE))
              for picture in (table, seen)]
    v, u = np.nonzero(inside[::_STEP, ::_STEP])
    if len(u) < _LEAST_INSIDE:
        return False
    places = (_STEP * v, _STEP * u)
    values = np.column_stack([level[places] for level in levels])
    # A thing lies in the same light as the table, and in the same shades.
    values = _without_light(values, np.column_stack([u, v]) / len(inside), levels[0], places)
    both, power, other = values[:, 0] @ values[:, 1], *(values ** 2).sum(axis=0)
    likeness = both / math.sqrt(power * other + _NOTHING)
    return (likeness > _LEAST_LIKENESS and likeness * math.sqrt(len(u)) > _SURE * _FINE / _STEP
            and _LEAST_SEEN * power < both < _MOST_SEEN * power)


def _without_light(
    values: np.ndarray, places: np.ndarray, level: np.ndarray, at: Tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Take out of levels, shape (n, k), what lamps may do: a straight edge and a smooth field."""
    u, v = places.T
    smooth = np.linalg.qr(np.column_stack([np.ones_like(u), u, v, u * u, u * v, v * v]))[0]
    values = values - smooth @ (smooth.T @ values)
    slopes = np.stack([cv2.Sobel(level, -1, *axis)[at] for axis in ((1, 0), (0, 1))])
    across = np.linalg.eigh(slopes @ slopes.T)[1][:, -1]
    distance = np.column_stack(at[::-1]) @ across
    strip = np.rint((distance - distance.min()) / _STEP).astype(int)
    counts = np.maximum(np.bincount(strip), 1)
    return values - np.column_stack([
        (np.bincount(strip, one) / counts)[strip] for one in values.T])
