# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Tells two solid objects apart of which one hides a part of the other.

The camera sees them as one silhouette with a notch on one side of their border or on both. A
bracket has a notch as well, but it has one colour: only what has a notch and another colour on
either side of it is two. The border is where the frame says, between the two colours.
"""

from dataclasses import replace
from itertools import combinations
import math
from typing import Callable, List, Optional, Sequence, Tuple

from camera_to_base.detection.detection import Box, Detection, Pixel, touches_edge
from camera_to_base.detection.precise.light import LINEAR
from camera_to_base.detection.precise.piece import (
    centre_of, filled, largest_part, outline_of, slices, square)
from camera_to_base.detection.touching import halves, notches_in, Place
import cv2
import numpy as np

# A notch is as deep as this part of the silhouette's width, and deeper than its pixels make it.
_LEAST_NOTCH, _PIXEL_NOTCH, _MOST_NOTCHES = 0.04, 2.0, 4
# The smaller of two objects as a part of both; how far from the cut the border is looked for, as
# a part of the cut's length, and of either object's distances from it.
_LEAST_PART, _AROUND, _FAR_SIDE = 0.1, 0.5, 0.6
# Of an object that is hidden over this part of its width, the foot is not known.
_MOSTLY_HIDDEN = 0.75
# Colours of light differ by this angle, in rad. This much light has no colour.
_OTHER_COLOUR, _DARK = 0.25, 0.003

Cut = Tuple[Place, Place]


def apart(
    detection: Detection, frame: np.ndarray, distances: Callable[[np.ndarray], np.ndarray]
) -> Tuple[List[Detection], List[Detection]]:
    """
    Tell two objects apart that are detected as one, by their colours beside a notch.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param distances: Tells how far pixels, shape (n, 2), are from the camera's foot.
    :returns: The one in front and the one behind it, whose centre is in doubt for what is hidden
        of it, or the detection itself where it is one; then what is hidden for the most part.
    :raises HorizonError: If one of them lies beyond the horizon.
    """
    outline = (detection.outline - np.int32(detection.box[:2]))[:, None]
    width = math.sqrt(cv2.contourArea(cv2.convexHull(outline)))
    least = max(_LEAST_NOTCH * width, _PIXEL_NOTCH)
    notches = notches_in(outline, least, _MOST_NOTCHES)
    if detection.cut_off or not notches:
        return [detection], []
    mask, near = filled(detection.outline, detection.box), frame[slices(detection.box)]
    for cut in _cuts(mask, notches):
        parts = _parts(mask, near, cut)
        if parts is not None and _differ(*parts, near):
            found = [_detected(part, mask, detection, frame) for part in parts]
            first, second = distances(np.array([one.centre for one in found]))
            front, behind = found if first < second else found[::-1]
            hidden, width = math.dist(*cut), math.sqrt(behind.area)
            if hidden > _MOSTLY_HIDDEN * width:
                return [front], [behind]
            # Beyond the cut, a right angle of it may be hidden at most.
            shift = hidden ** 2 / 4 / behind.area * width / 2
            return [front, replace(behind, doubt=math.hypot(behind.doubt, shift))], []
    return [detection], []


def _cuts(mask: np.ndarray, notches: Sequence[Place]) -> List[Cut]:
    """List where to cut: between two notches, or across from one, the shortest first."""
    points = outline_of(mask)[:, 0]
    cuts = list(combinations(notches, 2))
    for notch in notches:
        away = np.hypot(*(points - np.float64(notch)).T)
        # Not the notch's own sides: what is across is a longer way along the outline.
        steps = np.abs(np.arange(len(points)) - np.argmin(away))
        along = np.minimum(steps, len(points) - steps)
        across = np.where(2 * away < along, away, np.inf)
        cuts.append((notch, tuple(points[np.argmin(across)].tolist())))
    return sorted(cuts, key=lambda cut: math.dist(*cut))


def _parts(
    mask: np.ndarray, frame: np.ndarray, cut: Cut
) -> Optional[Tuple[np.ndarray, np.ndarray]]:
    """Part a silhouette at the frame's edge near a cut; None where that leaves too little."""
    pair = halves(mask, *cut)
    if pair is None or cv2.countNonZero(pair[0]) < _LEAST_PART * cv2.countNonZero(mask):
        return None
    line = np.ones_like(mask)
    cv2.line(line, *cut, 0, 1)
    away = cv2.distanceTransform(line, cv2.DIST_L2, 5)
    cores = []
    for half in pair:
        # Of a small one, its far side.
        beyond = min(_AROUND * math.dist(*cut), float(np.quantile(away[half > 0], _FAR_SIDE)))
        cores.append(half & (away >= max(beyond, 2.0)))
    seeds = np.int32(cores[0]) + 2 * np.int32(cores[1]) + 3 * (1 - np.int32(mask))
    reached = cv2.watershed(np.ascontiguousarray(frame), seeds)
    first, second = (largest_part((reached == one).view(np.uint8)) for one in (1, 2))
    return first, second


def _differ(one: np.ndarray, other: np.ndarray, frame: np.ndarray) -> bool:
    colours = []
    for part in (one, other):
        inside = frame[cv2.erode(part, square(5)) > 0]
        if not len(inside):
            return False
        colour = LINEAR[np.median(inside, axis=0).astype(int)] + _DARK
        colours.append(colour / np.linalg.norm(colour))
    return bool(np.arccos(min(np.dot(*colours), 1.0)) > _OTHER_COLOUR)


def _detected(
    part: np.ndarray, whole: np.ndarray, detection: Detection, frame: np.ndarray
) -> Detection:
    """Give a part as a detection of its own: its hull, as both objects are convex."""
    outline = cv2.convexHull(outline_of(cv2.dilate(part, square(3)) & whole))
    left, top, width, height = cv2.boundingRect(outline)
    box = Box(left + detection.box.x, top + detection.box.y, width, height)
    outline = outline + np.int32([detection.box.x, detection.box.y])
    mask = filled(outline, box)
    # What the pixels at the rim are worth is known of the whole.
    area = cv2.countNonZero(mask) * detection.area / max(cv2.countNonZero(whole), 1)
    u, v = centre_of(mask)
    return replace(detection, box=box, centre=Pixel(u + box.x, v + box.y), area=area,
                   outline=outline[:, 0], moments=None, cut_off=touches_edge(box, frame),
                   is_part=True)
