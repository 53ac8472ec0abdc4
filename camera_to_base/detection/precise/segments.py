# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Tells a region's things from its shade, segment by segment: by their colours and their edges.

A region is cut along the frame's edges. A thing's outline is as sharp as the lens allows, all
around; shade ends in a penumbra on its way into the table's full light. Both count as evidence:
a segment without a penumbra is a thing unless its colour and texture speak against it.
"""

import math
from typing import Iterator, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.evidence import (
    BRIGHTEST, Detail, detail_of, Evidence, PRIOR)
from camera_to_base.detection.precise.faces import cut_by_chroma, Side, with_faces
from camera_to_base.detection.precise.light import LEVEL_SCALE
from camera_to_base.detection.precise.piece import (
    centre_of, channel_extremes, cut_off, disc, grown, largest_part, quantile, slices, square)
from camera_to_base.detection.precise.shade import DARKEST, FAINTEST, Shade
import cv2
import numpy as np

# Where a frame is flat, so that a segment may start: logarithms per px, and deviations of the
# noise; on how many px.
_FLAT, _NOISE, _LEAST_FLAT = 0.02, 2.5, 12
# Where the rim of a region is, px, and how much of a narrow part of a thing lies there, at most.
_RIM, _MOST_AT_RIM = 7, 0.4
# A step is looked at in windows of two sizes, px; what is a step, logarithm of the light; a step
# that the background has to this part, too, tells nothing.
_FAR, _LEAST_STEP, _STEP_NOISE, _SAME_STEP = 9, 0.1, 5.0, 0.5
# A step is soft where its near part is less than this part of that of the sharpest ones, which
# are this part of all, or of what a lens that is in focus gives, 1/px: an edge with a deviation of
# 1.3 px.
_SOFT, _SHARPEST, _IN_FOCUS = 0.7, 0.8, 0.26
# Fitted to 1,225 segments of rendered scenes with two soft lamps, noise and JPEG; 13 pale faces
# are taken for light. Nats for a rim without a penumbra, and less for one that is all penumbra;
# how much the colour may count for light and for a thing, and the table's texture for either.
_NO_PENUMBRA, _PENUMBRA, _MOST_LIGHT, _MOST_THING = 27.0, 68.0, -30.0, 60.0
_MOST_TEXTURE = 30.0
_FEW = 8
# Shade is the lightest at its rim. What is lighter in the middle of this window, px, than on both
# of its sides is round: by so many deviations of the noise, on more than a quarter of it, which
# counts so many nats. Of some 1,700 shades in rendered cells none reached 2.8 deviations, of 143
# grey faces 21 reached 3.
_RIDGE, _LEAST_RIDGE, _OF_RIDGE, _ROUND = square(9), 3.0, 0.75, 30.0
# Without light that was joined to it, a coloured thing's segment has this median, nats, and this
# part of it is one. The sensor has cut off this part of a segment, and this part of it is a thing.
_COLOURED, _SINGLE, _MUCH = 35.0, 0.85, 0.3
# All faces of a coloured thing have so much chroma, and those of a black one so little light,
# logarithms: beside 740 shades in rendered cells, no side of a thing had the table's chroma.
COLOURED, _BLACK = 0.3, -4.0
# So many of a segment's nats make one of its odds: of the segments above, 8 of 28 within 6 nats
# are mistaken, 12 of the 13 mistakes lie within 15. What has a smaller deviation is sure.
_NATS_OF_ODDS, _LEAST_DEVIATION = 5.0, 0.4
# What a pixel is whatever its segment is, what tells that a region has a thing, and what that it
# is light alone; nats. What is soft shade, by the thing's area.
_SURELY, _SURE, _SURE_LIGHT, _LEAST_PENUMBRA = 30.0, 2.5, 9.0, 0.1
# Soft shade without a segment is on this part of a region, or it is no more than a rim.
_LEAST_SOFT = 0.15
# Segments touch on so many px.
_SHORTEST = 3


class Unsure(NamedTuple):
    """
    A segment that may be a thing as well as light.

    :param segment: Shape (h, w), uint8, 1 inside.
    :param deviation: Standard deviation of the part of it that is a thing: 0.5 if nothing tells.
    """

    segment: np.ndarray
    deviation: float


class Parted(NamedTuple):
    """
    A region that is parted into things and light, each of shape (h, w), uint8, 1 inside.

    :param things: The things.
    :param light: The light.
    :param unsure: Segments of both that may be the other.
    :param is_light: Whether all of it is light, for sure.
    :param is_untold: Whether edges tell no light from a thing: `things` and `light` say nothing.
    """

    things: np.ndarray
    light: np.ndarray
    unsure: List[Unsure]
    is_light: bool = False
    is_untold: bool = False

    @property
    def is_blind(self) -> bool:
        """Whether there was no edge to look at."""
        return self.is_untold and not self.things.any()


def untold(changed: np.ndarray) -> Parted:
    """Give a region of which edges tell nothing."""
    return Parted(np.zeros_like(changed), np.zeros_like(changed), [], is_untold=True)


class _Segment(NamedTuple):
    """
    A segment of a region.

    :param mask: Shape (h, w), uint8, 1 inside.
    :param nats: The median of what speaks for a thing.
    :param softness: See :func:`_softness`.
    :param detail: Whether the table's texture is seen in it.
    :param colour: What speaks against a thing of the table's chroma, nats.
    :param ratio: The median logarithm of its level / the table's.
    :param tone: The median changes of both axes of the chroma, logarithms.
    :param chroma: How far that is off what the tint of shade may do.
    :param is_black: Whether it is darker than any shade in this room.
    :param ridge: If it may be shade and is round: its middle, of the mask's shape.
    """

    mask: np.ndarray
    nats: float
    softness: Optional[float]
    detail: Detail
    colour: float
    ratio: float
    tone: Tuple[float, float]
    chroma: float
    is_black: bool
    ridge: Optional[np.ndarray] = None

    @property
    def may_be_light(self) -> bool:
        """Whether its pixels tell of a thing by less than the prior: light may look like that."""
        return self.nats < PRIOR

    @property
    def may_be_shade(self) -> bool:
        """Whether it is as dark as shade, and has the table's chroma."""
        return self.may_be_light and not self.is_black and self.ratio < FAINTEST

    @property
    def is_deep(self) -> bool:
        """Whether it may be shade only below one lamp in a dark room: or it is a black thing."""
        return self.may_be_shade and self.ratio < DARKEST

    @property
    def is_soft(self) -> Optional[bool]:
        """Whether its rim is a penumbra; None where it has none."""
        return None if self.softness is None else self.softness > _NO_PENUMBRA / _PENUMBRA


# A segment, what of it counts, and what speaks for a thing, in nats.
_Judged = Tuple[_Segment, np.ndarray, float]


class _Steps(NamedTuple):
    """Where a frame has steps between segments, and which of them are soft; (h, w), uint8."""

    borders: np.ndarray
    soft: np.ndarray


def parted(
    frame: np.ndarray, changed: np.ndarray, logs: Tuple[np.ndarray, ...], found: Evidence,
    min_area: float,
) -> Parted:
    """
    Part a region into things and light.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param changed: The region, shape (h, w), uint8, 1 inside.
    :param logs: Logarithms of the frame's light and the background's, each of shape (h, w, 3).
    :param min_area: Smaller segments do not count, in px².
    :returns: No things where nothing is surely a thing, and there is soft shade or all of it has
        a coloured table's own colour.
    """
    noise = cv2.sqrt(found.variance / 2)
    labels, count = _segments(frame, changed, logs[0], noise)
    steps = _steps(logs, labels, noise)
    if steps is None:
        return untold(changed)
    labels = _joined(labels, count, logs[0])
    labels = cut_by_chroma(labels, count, changed, found, min_area)
    at_table = cv2.dilate((labels == 1).view(np.uint8), square(3))
    sure = found.nats > _SURELY, found.is_light
    thing, light = (cv2.morphologyEx(pixels.view(np.uint8), cv2.MORPH_OPEN, square(5))
                    for pixels in sure)
    segments = _with_ridges([_look((labels == number).view(np.uint8), at_table, steps, found)
                             for number in np.unique(labels[changed > 0]) if number > 1], found)
    # Where the table goes on below it, light is seen; without a penumbra, it is a patch of sun.
    on_table = [one for one in segments if one.may_be_light and one.detail.is_table]
    shade = found.shade.with_levels([one.ratio for one in on_table])
    most_by_rim = _most_by_rim(segments, on_table)
    are_coloured = _are_coloured(segments)
    is_lamp_soft = any(one.may_be_shade and one.is_soft for one in segments)
    judged: List[_Judged] = []
    is_cut_off = cut_off(frame)
    for one in segments:
        # Beside soft shade, a sharp rim is that of a grey part of the thing; and that of what is
        # as dark as an umbra in a dark room may be a black part's.
        is_shade = are_coloured and one.may_be_shade and (
            one.is_soft is not False or not is_lamp_soft) and (one.is_soft or not one.is_deep)
        nats = _MOST_LIGHT if is_shade else _nats(one, most_by_rim, shade, found)
        # Compression may hide its edge to its shade.
        judged.append((one, _without(one.mask, light, is_cut_off, found), nats))
    result = _sorted(judged, changed)
    result.unsure.extend(_unsure(judged, are_coloured))
    if cv2.countNonZero(result.light) < min_area:
        # Shade so soft that it has no segment went to the table.
        soft = light & changed & (labels == 1).view(np.uint8)
        if cv2.countNonZero(soft) > _LEAST_SOFT * cv2.countNonZero(changed):
            result.light[soft > 0] = 1
    if cv2.countNonZero(result.light) < min_area:
        return result._replace(things=changed, is_untold=True)
    surest = max(nats for *_, nats in judged)
    penumbra = sum(cv2.countNonZero(segment) for one, segment, _ in judged if one.is_soft)
    is_soft = penumbra > _LEAST_PENUMBRA * cv2.countNonZero(result.things)
    if surest <= _SURE or cv2.countNonZero(result.things) < min_area:
        return _without_things(result, surest, is_soft, segments)
    # A dark face may have no segment of its own, for the same reason.
    things = result.things | changed & thing
    sides = [Side(one.mask, one.tone) for one, _, nats in judged if nats > 0]
    things = with_faces(things, result.light & (1 - things), sides, changed, found)
    return Parted(things, result.light & (1 - things), result.unsure)


def _sorted(judged: Sequence[_Judged], changed: np.ndarray) -> Parted:
    """Give the things and the light among judged segments, see :func:`_unsure`."""
    result = Parted(np.zeros_like(changed), np.zeros_like(changed), [])
    for one, segment, nats in judged:
        result.light[one.mask > segment] = 1
        result[nats < 0][segment > 0] = 1
    return result


def _unsure(judged: Sequence[_Judged], are_coloured: bool) -> Iterator[Unsure]:
    """Give what may be light as well as a thing."""
    # Beside a thing of little chroma, shade without a penumbra may be its face.
    are_grey = all(one.chroma < COLOURED for one, _, nats in judged if nats > 0)
    for one, segment, nats in judged:
        deviation = 0.5 / math.cosh(nats / _NATS_OF_ODDS / 2)
        if are_grey and nats < 0 and not (one.is_soft or one.detail.is_table):
            deviation = 0.5
        if (are_coloured or one.is_deep) and nats > 0 and one.may_be_shade:
            # It has no colour of its own: another lamp may be harder than the one that is seen.
            deviation = 0.5
        if one.ridge is not None and nats > 0:
            # What is round is a thing; its shade may be joined to it.
            segment, deviation = segment & (1 - one.ridge), 0.5
        if deviation > _LEAST_DEVIATION:
            yield Unsure(segment, deviation)


def _are_coloured(segments: List[_Segment]) -> bool:
    """Tell whether a region has nothing but coloured or black faces, and what may be shade."""
    # Shade that is fainter than any known is no face: it may be the rim of a darker one.
    faces = [one for one in segments if one.ratio < BRIGHTEST and not (
        one.may_be_light and not one.is_black and one.ratio < 0)]
    return bool(faces) and all(
        one.chroma > COLOURED or one.ratio < _BLACK for one in faces)


def _without_things(
    result: Parted, surest: float, is_soft: bool, segments: List[_Segment]
) -> Parted:
    """Give a region in which nothing is surely a thing: light, unclear, or untold."""
    is_surely_light = surest < -_SURE_LIGHT
    is_light = is_surely_light and any(one.detail.is_table for one in segments)
    # A coloured table's own colour tells of light, and a sharp rim of a thing.
    is_unclear = is_soft or is_surely_light and any(one.colour > _SURE_LIGHT for one in segments)
    return result._replace(things=np.zeros_like(result.things), is_light=is_light,
                           is_untold=not (is_light or is_unclear))


def doubt_of(thing: np.ndarray, unsure: Sequence[Unsure]) -> float:
    """
    Give the standard deviation of a thing's centre because segments beside it are unsure, in px.

    :param thing: Shape (h, w), uint8, 1 inside.
    """
    box = Box(*cv2.boundingRect(thing))
    # A face is no farther away than its thing is wide.
    window = slices(grown(box, max(box.width, box.height), thing))
    thing, variance = thing[window], 0.0
    near = cv2.dilate(thing, square(5))
    for one, deviation in unsure:
        segment = one[window]
        rest = thing & (1 - segment)
        # That there is a thing is decided already.
        if cv2.countNonZero(segment & near) and rest.any():
            shift = math.dist(centre_of(thing | segment), centre_of(rest))
            variance += (deviation * shift) ** 2
    return math.sqrt(variance)


def _without(
    segment: np.ndarray, light: np.ndarray, cut_off: np.ndarray, found: Evidence
) -> np.ndarray:
    """
    Give a segment without the light that was joined to it; all of it where that is not clear.

    Light and a thing that the sensor has cut off have no edge between them.
    """
    near = slices(grown(Box(*cv2.boundingRect(segment)), 1, segment))
    whole = segment[near]
    rest = whole & (1 - light[near])
    count, left = cv2.countNonZero(whole), cv2.countNonZero(rest)
    if left == count:
        return segment
    kept = rest
    if min(cv2.countNonZero(whole & cut_off[near]), left) <= _MUCH * count:
        kept = largest_part(cv2.morphologyEx(rest, cv2.MORPH_OPEN, square(3)))
        if (cv2.countNonZero(kept) <= _SINGLE * left
                or quantile(found.nats[near][kept > 0]) <= _COLOURED):
            return segment
    result = np.zeros_like(segment)
    result[near] = kept
    return result


def _look(
    mask: np.ndarray, at_table: np.ndarray, steps: _Steps, found: Evidence
) -> _Segment:
    # What is around it counts for its rim.
    near = slices(grown(Box(*cv2.boundingRect(mask)), 1, mask))
    inside = mask[near] > 0
    nats, colour, ratio, *tone = (float(quantile(one[near][inside])) for one in (
        found.nats, found.colour, found.level, *found.chroma))
    chroma = math.hypot(*found.shade.off_tints(tone, ratio))
    softness = _softness(mask[near], at_table[near], _Steps(*(one[near] for one in steps)))
    return _Segment(mask, nats, softness, detail_of(found, mask), colour,
                    LEVEL_SCALE * ratio, tuple(tone), chroma,
                    LEVEL_SCALE * ratio < found.shade.darkest)


def _with_ridges(segments: List[_Segment], found: Evidence) -> List[_Segment]:
    """Give segments with the ridges of those that may be shade."""
    if not any(one.may_be_shade for one in segments):
        return segments
    ratio = cv2.blur(found.level, (3, 3))
    # By how many deviations a pixel is lighter than both of its sides.
    ridges = LEVEL_SCALE * cv2.morphologyEx(
        ratio, cv2.MORPH_TOPHAT, _RIDGE) / cv2.sqrt(found.variance)
    return [one._replace(ridge=_ridge(one.mask, ridges)) if one.may_be_shade else one
            for one in segments]


def _ridge(mask: np.ndarray, ridges: np.ndarray) -> Optional[np.ndarray]:
    """Give what is near a segment's middle that is lighter than its sides; None without one."""
    core = ridges[cv2.erode(mask, square(5)) > 0]
    if len(core) < _LEAST_FLAT or quantile(core, _OF_RIDGE) < _LEAST_RIDGE:
        return None
    return cv2.dilate(mask & (ridges > _LEAST_RIDGE).view(np.uint8), _RIDGE)


def _most_by_rim(segments: List[_Segment], on_table: List[_Segment]) -> float:
    """
    Tell how much a rim without a penumbra speaks for a thing, in nats.

    :param on_table: Those that the table's texture tells to be light.
    """
    if any(one.is_soft is False for one in on_table):
        return 0.0
    # Where no rim is soft, the lamp may be hard.
    return _NO_PENUMBRA if any(one.is_soft for one in segments) else _NO_PENUMBRA / 2


def _nats(segment: _Segment, most_by_rim: float, shade: Shade, found: Evidence) -> float:
    """
    Tell what speaks for a segment to be a thing: its colour, texture, rim, and roundness.

    :param most_by_rim: What a rim tells at most, nats.
    :param shade: What the frame's other shade is like.
    """
    dark = found.is_black if segment.is_soft else found.is_dark
    if 2 * cv2.countNonZero(dark & segment.mask) > cv2.countNonZero(segment.mask):
        return _MOST_THING
    nats = min(max(segment.nats, _MOST_LIGHT), _MOST_THING) + min(
        max(segment.detail.nats, -_MOST_TEXTURE), _MOST_TEXTURE)
    if segment.ridge is not None:
        nats += _ROUND
    if segment.may_be_light:
        # Its chroma is the table's.
        nats += shade.nats(segment.ratio) - segment.colour
    if segment.softness is None:
        return nats
    return nats + min(_NO_PENUMBRA - _PENUMBRA * segment.softness, most_by_rim)


def _softness(segment: np.ndarray, at_table: np.ndarray, steps: _Steps) -> Optional[float]:
    """Give the part of a rim that is soft, where the table begins counted twice; None for none."""
    rim = cv2.dilate(segment, square(3)) & steps.borders
    parts = [cv2.countNonZero(one & steps.soft) / cv2.countNonZero(one)
             for one in (rim, rim & at_table) if cv2.countNonZero(one) >= _FEW]
    return sum(parts) / len(parts) if parts else None


def _segments(
    frame: np.ndarray, changed: np.ndarray, logs: np.ndarray, noise: np.ndarray
) -> Tuple[np.ndarray, int]:
    """Cut a region along the frame's edges: -1 on an edge, 1 on the table, more in a segment."""
    steep = channel_extremes(cv2.morphologyEx(
        cv2.blur(logs, (3, 3)), cv2.MORPH_GRADIENT, square(3)))[1]
    flat = (steep < cv2.max(_NOISE * noise, _FLAT)).view(np.uint8) & changed
    count, parts, stats, _ = cv2.connectedComponentsWithStats(flat, connectivity=4)
    large = np.flatnonzero(stats[1:, cv2.CC_STAT_AREA] >= _LEAST_FLAT) + 1
    numbers = np.zeros(count, np.int32)
    numbers[large] = np.arange(2, len(large) + 2)
    marks = numbers[parts]
    marks[cv2.dilate(changed, square(5)) == 0] = 1
    labels = cv2.watershed(np.ascontiguousarray(frame), marks)
    return labels, _label_narrow(labels, len(large) + 2, changed)


def _label_narrow(labels: np.ndarray, count: int, changed: np.ndarray) -> int:
    """
    Give labels of their own, in place, to stripes on a thing that went to the table.

    They are too narrow to be flat, and lie inside of the region.

    :returns: The number of labels then.
    """
    narrow = cv2.morphologyEx(changed & (labels == 1), cv2.MORPH_OPEN, square(3))
    if not narrow.any():
        return count
    found, parts = cv2.connectedComponents(narrow, connectivity=4)
    at_rim = np.bincount(parts[cv2.erode(changed, square(_RIM)) == 0], minlength=found)
    is_inside = at_rim < _MOST_AT_RIM * np.bincount(parts.ravel(), minlength=found)
    is_inside[0] = False
    chosen = is_inside[parts]
    labels[chosen] = parts[chosen] + count - 1
    return count + found - 1


def _steps(
    logs: Tuple[np.ndarray, ...], labels: np.ndarray, noise: np.ndarray
) -> Optional[_Steps]:
    channel = int(np.argmax(cv2.meanStdDev(logs[0])[1]))
    level, usual = (cv2.extractChannel(one, channel) for one in logs)
    far, own = (cv2.morphologyEx(one, cv2.MORPH_GRADIENT, disc(_FAR)) for one in (level, usual))
    slope = cv2.magnitude(*(cv2.Scharr(level, -1, *axis, scale=1 / 32)
                            for axis in ((1, 0), (0, 1))))
    sharpness = cv2.dilate(slope, square(3)) / cv2.max(far, _LEAST_STEP)
    is_step = far > cv2.max(cv2.max(own / _SAME_STEP, _STEP_NOISE * noise), _LEAST_STEP)
    borders = ((labels == -1) & is_step).view(np.uint8)
    borders[[0, -1]] = borders[:, [0, -1]] = 0
    if not borders.any():
        return None
    sharpest = max(float(quantile(sharpness[borders > 0], _SHARPEST)), _IN_FOCUS)
    return _Steps(borders, borders & (sharpness < _SOFT * sharpest).view(np.uint8))


def _joined(labels: np.ndarray, count: int, logs: np.ndarray) -> np.ndarray:
    """Join segments that touch, and are of one colour."""
    edge = labels == -1
    first, last = (morph(np.where(edge, outside, labels).astype(np.float32), square(3))[edge]
                   for morph, outside in ((cv2.erode, count), (cv2.dilate, -1)))
    between = (first > 1) & (last > first) & (first < count)
    lengths = np.bincount((first * count + last)[between].astype(int), minlength=1)
    # Every second row tells as much.
    known = (labels[::2] + 1).ravel()
    areas = np.maximum(np.bincount(known, minlength=count + 1), 1)
    colours = np.stack([np.bincount(known, logs[::2, :, channel].ravel(), count + 1)
                        for channel in range(3)], axis=1) / areas[:, None]
    numbers = np.arange(-1, count)
    sides = 1 + np.stack(np.divmod(np.flatnonzero(lengths >= _SHORTEST), count), axis=1)
    steps = np.abs(colours[sides[:, 0]] - colours[sides[:, 1]]).max(axis=1, initial=0)
    for one, other in (numbers[pair] for pair in sides[steps < _LEAST_STEP]):
        numbers[numbers == max(one, other)] = min(one, other)
    return numbers[labels + 1]
