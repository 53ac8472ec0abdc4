# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Tells what is a face of a thing, and no shade, sun or bare table, where no edge tells it.

- It has the chroma of the thing and not the table's, though it may be as dark as its shade.
- The table's texture is gone, also where nothing else has changed. What shows it is light, though
  it was taken for a part of the thing.

The edge between a light face and a dark one looks like the table, but not for more than a pixel.
"""

import math
from typing import List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.evidence import (
    box_mean, detail_nats, detail_of, Evidence, PRIOR)
from camera_to_base.detection.precise.light import LEVEL_SCALE
from camera_to_base.detection.precise.piece import (
    filled, grown, outlines_in, quantile, slices, square, two_means)
from camera_to_base.detection.precise.shade import is_neutral, NEUTRAL
import cv2
import numpy as np

# Chroma is told by the mean of a window, px. One that is not the table's is off by so many times
# what light may change, and nearer to the thing's by this: a shade takes some of it. One that is
# another thing's is off by more than this part of it. The narrowest face, px.
_WINDOW, _OTHER_CHROMA, _NEARER, _SAME_CHROMA, _LEAST_WIDTH = 5, 1.5, 0.7, 0.4, 3
# What touches is so near, px, and on so many px; JPEG parts faces by so many.
_BESIDE, _FEW, _NEARBY = 5, 8, 9
_NOTHING = 1e-3
# The shade in a segment is off the table's chroma by less than this part of what the thing is;
# chosen on 785 segments with two kinds of chroma.
_LESS_CHROMA = 0.35
# The table's texture is looked for in windows, px; the median of what tells that it is seen, or
# gone, where that is sure, nats.
_TEXTURE_WINDOW, _SURELY = 11, 15.0
# What hides the table has less than this part of its power, and what is around has more, on this
# part of the pixels: around nine of ten that rendered things hide there is twice as much as that,
# and around the traces of objects on real tables 0.03 to 0.08.
_PLAIN, _COMMON = 0.25, 0.75
# An edge between faces has this part of their step within 3 px; what is off the table by less than
# this part of it looks like the table.
_AT_ONCE, _AS_TABLE = 0.55, 0.25


class Side(NamedTuple):
    """
    A part of a thing, by its colour.

    :param mask: Shape (h, w), uint8, 1 inside.
    :param tone: How both axes of its chroma are off the table's, logarithms.
    """

    mask: np.ndarray
    tone: Tuple[float, float]


def cut_by_chroma(
    labels: np.ndarray, count: int, changed: np.ndarray, found: Evidence, min_area: float
) -> np.ndarray:
    """
    Cut segments of which a part has the table's chroma, and a part has another.

    A thing and its shade may be equally dark, and then no edge is between them.

    :param labels: The segments' numbers, shape (h, w), int32; 1 on the table.
    :param count: The number of the first new segment.
    :param changed: The region, of that shape.
    :param min_area: Smaller parts do not count, in px².
    """
    # Light on a coloured table may change its chroma.
    nats, inside = found.nats - found.colour, changed > 0
    is_thing, numbers = nats[inside] > -PRIOR, labels[inside]
    # Both parts are told by their medians, so that half of each is on its side.
    has_thing, has_light = (np.bincount(numbers[one] + 1, minlength=count + 1) >= min_area / 2
                            for one in (is_thing, ~is_thing))
    mixed = [number for number in np.flatnonzero(has_thing & has_light) - 1 if number > 0]
    if not mixed:
        return labels
    chroma = [cv2.blur(one, (3, 3)) for one in found.chroma]
    off = np.hypot(*found.shade.off_tints(chroma, found.level))
    cut = labels.copy()
    for number in mixed:
        segment = changed & (labels == number).view(np.uint8)
        near = slices(grown(Box(*cv2.boundingRect(segment)), 1, segment))
        segment = segment[near]
        limit = _chroma_between(off[near][segment > 0])
        if limit is None:
            continue
        other = cv2.morphologyEx(
            segment & (off[near] > limit).view(np.uint8), cv2.MORPH_OPEN, square(3))
        parts = other > 0, (segment & (1 - other)) > 0
        if min(map(np.count_nonzero, parts)) < min_area:
            continue
        thing, light = (quantile(nats[near][part]) for part in parts)
        if thing > -PRIOR > light:
            cut[near][parts[0]] = count
            count += 1
    return cut


def _chroma_between(off: np.ndarray) -> Optional[float]:
    """Give the limit between two kinds of chroma, half-way; None where all is of one kind."""
    low, high = two_means(off)
    return (low + high) / 2 if high > NEUTRAL and low < _LESS_CHROMA * high else None


def with_faces(
    things: np.ndarray, light: np.ndarray, sides: Sequence[Side], changed: np.ndarray,
    found: Evidence,
) -> np.ndarray:
    """
    Give things with their faces, shape (h, w), uint8, 1 inside.

    :param things: What edges tell to be things, of that shape.
    :param light: What they tell to be light.
    :param sides: The things whose chroma tells of their faces.
    :param changed: The region.
    """
    faces = _of_chroma(changed & (1 - things), sides, found)
    if faces.any():
        # Pixels between two faces show neither.
        both = cv2.morphologyEx(things | faces, cv2.MORPH_CLOSE, square(_BESIDE))
        things = things | both & cv2.dilate(faces, square(_BESIDE))
    things = _by_texture(things, light & (1 - things), found)
    return _with_edges(things, changed, found)


def _of_chroma(rest: np.ndarray, sides: Sequence[Side], found: Evidence) -> np.ndarray:
    """
    Give what of the rest has the chroma of a thing that it touches, shape (h, w), uint8, 1 there.

    The faces of a thing differ in their level, and a shade has the table's chroma and a tint.
    """
    faces = np.zeros_like(rest)
    count = cv2.max(box_mean(rest.astype(np.float32), _WINDOW), _NOTHING)
    *chroma, level = (box_mean(one * rest, _WINDOW) / count
                      for one in (*found.chroma, found.level))
    off = np.hypot(*found.shade.off_tints(chroma, level))
    other = rest & ~is_neutral(off / _OTHER_CHROMA, LEVEL_SCALE * level)
    if not other.any():
        return faces
    nearby = [(one, cv2.dilate(one.mask, square(_BESIDE))) for one in sides]
    for side in sides:
        is_same = cv2.magnitude(*map(cv2.subtract, chroma, side.tone)) < _NEARER * off
        for box, face in _parts(other & is_same.view(np.uint8), _LEAST_WIDTH):
            touched = [one for one, near in nearby if cv2.countNonZero(face & near[slices(box)])]
            # It joins no two things.
            if any(one is side for one in touched) and all(
                    math.dist(one.tone, side.tone) < _SAME_CHROMA * math.hypot(*side.tone)
                    for one in touched):
                faces[slices(box)] |= face
    return faces


def _by_texture(things: np.ndarray, light: np.ndarray, found: Evidence) -> np.ndarray:
    """Give things without what shows the table's texture, and with what of the light does not."""
    inside = cv2.erode(things, square(5)) | cv2.erode(light, square(5))
    nats = detail_nats(found, inside, _TEXTURE_WINDOW)
    shown, gone = (_surely(mask, one) for mask, one in (
        (things & found.is_light, -nats), (light, nats)))
    for part in shown:
        # A thing's own texture may be like the table's by chance.
        if detail_of(found, part).is_table:
            things = things & (1 - part)
    near = cv2.dilate(things, square(_NEARBY))
    for part in gone:
        if cv2.countNonZero(part & near) >= _FEW:
            things = things | part
    return things


def hidden_beside(changed: np.ndarray, beside: np.ndarray, found: Evidence) -> np.ndarray:
    """
    Give what of a thing lies beyond its region, shape (h, w), uint8, 1 there.

    Where a face has the table's level and chroma, only the table's texture is gone.

    :param changed: The region, of that shape.
    :param beside: What is in no region, of that shape.
    """
    whole = changed
    for part in _surely(beside, hiding_nats(beside, found)):
        around = beside & cv2.dilate(part, square(2 * _TEXTURE_WINDOW + 1)) & (1 - part)
        near = part & cv2.dilate(whole, square(_NEARBY))
        if min(map(cv2.countNonZero, (near, around))) < _FEW:
            continue
        usual, seen, goes_on = (
            quantile(cv2.extractChannel(found.detail, channel)[one > 0], _COMMON)
            for channel, one in ((1, part), (2, part), (1, around)))
        # What ends with the part was an object of the background; where the camera was pushed,
        # the texture is another one.
        if seen < _PLAIN * usual < goes_on:
            whole = cv2.morphologyEx(whole | part, cv2.MORPH_CLOSE, square(_NEARBY))
    return whole & (1 - changed)


def hiding_nats(mask: np.ndarray, found: Evidence) -> np.ndarray:
    """Tell what speaks for the table's texture to be gone in a mask: nats, of its shape."""
    return detail_nats(found, cv2.erode(mask, square(5)), _TEXTURE_WINDOW)


def _surely(mask: np.ndarray, nats: np.ndarray) -> List[np.ndarray]:
    """
    Give the parts of a mask that something speaks for, surely in the median: each of its shape.

    :param nats: What speaks for it, shape (h, w).
    """
    result = []
    for box, part in _parts(mask & (nats > 0).view(np.uint8)):
        if quantile(nats[slices(box)][part > 0]) > _SURELY:
            result.append(np.zeros_like(mask))
            result[-1][slices(box)] = part
    return result


def _with_edges(things: np.ndarray, changed: np.ndarray, found: Evidence) -> np.ndarray:
    """
    Give things with the edges between their light faces and their dark ones.

    Between two things, the table is seen on more pixels than on such an edge.
    """
    light = found.is_lighter
    # A rim is no face.
    near_light, near_dark = (cv2.dilate(cv2.morphologyEx(
        things & one, cv2.MORPH_OPEN, square(3)), square(_NEARBY)) for one in (light, 1 - light))
    edge = near_light & near_dark & changed & (1 - things)
    if not edge.any():
        return things
    step, whole = (cv2.morphologyEx(found.seen, cv2.MORPH_GRADIENT, square(size))
                   for size in (3, _NEARBY))
    is_table = cv2.absdiff(found.seen, found.usual) < _AS_TABLE * whole
    table = edge & (is_table & (step < _AT_ONCE * whole)).view(np.uint8)
    return things | edge & (1 - cv2.dilate(table, square(_NEARBY)))


def _parts(mask: np.ndarray, width: int = 5) -> List[Tuple[Box, np.ndarray]]:
    """Give the parts of a mask that are some px wide: the box of each, and what is inside."""
    wide = cv2.morphologyEx(mask, cv2.MORPH_OPEN, square(width))
    boxes = [(outline, Box(*cv2.boundingRect(outline))) for outline in outlines_in(wide)]
    return [(box, filled(outline, box) & wide[slices(box)]) for outline, box in boxes]
