# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Tells things from shade, sun and lamps, pixel by pixel, before anything is connected.

On the table, a frame is `log frame = log background + level + tint + noise`: light changes the
level smoothly or with an edge, and hardly the chroma; the table's own texture stays. A thing has a
colour of its own, and the texture below it is gone. Two chi-squares in small windows, by the known
noise of each grey level, say how well either explains the frame:

- light: the chroma of frame / background is none, and its level is a plane,
- thing: the chroma of the frame is constant, and its level is a plane. A thing may have a texture
  of its own: it costs no more than to describe each pixel on its own.

Each takes the best of the windows that contain the pixel, so that nothing leaks over a border.

Where neither is clear (glass, a grey face on a grey table, a lamp's mirror image), nothing is said
and the long way decides, see `own_shadow`.
"""

from functools import lru_cache
from typing import List, NamedTuple, Optional

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.light import LINEAR
from camera_to_base.detection.precise.own_shadow import has_free_rim
from camera_to_base.detection.precise.piece import (
    channel_extremes, chosen, enclosed, find_highlight, largest_part, make_piece, outline_of,
    outlines_in, quantile, square)
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import filled, grown, Region, slices
from camera_to_base.detection.touching import nearest_part
import cv2
import numpy as np

# The edge of a window, and of one for narrow shade, in px.
_SIZE, _NARROW = 5, 3
# How much of a step of colour is seen beside it.
_BLEED = 0.1
# Two axes of chroma and one of level, of B, G and R; orthonormal.
_AXES = np.float32([[1, 0, -1], [-1, 2, -1], [1, 1, 1]]) / np.sqrt(
    np.float32([[2], [6], [3]]))
_LEVEL_SCALE = 1 / np.sqrt(3)
# A mean of levels is known no better, in grey levels²; the compression and the rounding.
_LEAST_VARIANCE = 0.3
# How much chroma light may change for each change of the level, and anyway (steps of the gain,
# rounding); how far a camera trembles, in px.
_TINT, _LEAST_TINT, _TREMBLE = 0.02, 0.008, 0.12
# The tint of a frame's shade: how strong, in which bins, how common among the places that are
# darker by this logarithm, and on how many of them.
_STRONGEST_TINT, _BINS, _LEAST_COMMON, _LEAST_PLACES, _LEAST_SHADE = 0.12, 24, 0.3, 60, -0.25
_MOST_REGIONS, _NOTHING = 30, 1e-9
# Nats: how much clearer than light a thing must be; what a pixel's channel costs that is described
# on its own (the range of logarithms over the noise); what a level says that no light has.
_PRIOR, _OWN, _DARK_NATS, _LIGHT_NATS = 12.0, 3.5, 100.0, 24.0
# Logarithms of the ratio: a sixth of the light, and more than a lamp adds.
_DARKEST, _LIGHTEST = float(np.log(1 / 6)), 0.15
# The evidence of one pixel is limited before it is smoothed, nats; what is clear.
_MOST_EVIDENCE, _CLEAR = 15.0, 20.0
# What is light beside the things, as a part of the region: where it matters; which part of it must
# be clear by its texture; which chi-square tells that it is no light, and on which part.
_LEAST_REST, _MOSTLY, _WORST_LIGHT, _MOST_BAD, _LEAST_SHARE = 0.1, 0.6, 3.0, 0.3, 0.35
# A thing is wide enough for a window on this part of it; the others are few.
_LEAST_CORE, _MOST_THIN = 0.15, 0.15
# How much of the table's detail is seen where only the light has changed; how much detail, over
# the noise, tells that.
_LEAST_SLOPE, _LEAST_DETAIL = 0.6, 1.0
# How far two things may be apart that are taken for one at first, in px; how much nearer to the
# table's colour it is there; how large a part each is.
_WIDEST_GAP, _VALLEY, _LEAST_PART = 9, 0.6, 0.1
# What is between a thing and its shade: in the frame, logarithm.
_LEAST_STEP = 0.15
_MARGIN = 8
_LEAST_LIGHT = 1e-3


@lru_cache(maxsize=1)
def _log_levels() -> np.ndarray:
    logs = np.log(LINEAR + _LEAST_LIGHT).astype(np.float32)
    return np.repeat(logs[:, None, None], 3, axis=2)


@lru_cache(maxsize=1)
def _slopes() -> np.ndarray:
    return np.gradient(_log_levels()[:, 0, 0])[:, None]


class _Evidence(NamedTuple):
    """
    What speaks for a thing, pixel by pixel, each of shape (h, w), float32.

    :param nats: How much more likely a thing is than light.
    :param light: Chi-square of the light, by its degrees of freedom.
    :param usual: The background's level.
    :param seen: The frame's.
    :param variance: Of a difference of both.
    """

    nats: np.ndarray
    light: np.ndarray
    usual: np.ndarray
    seen: np.ndarray
    variance: np.ndarray


def measure_tint(frame: np.ndarray, regions: List[Region], reference: Reference) -> np.ndarray:
    """
    Measure how much chroma the shade of a frame has for each change of the level.

    :returns: Shape (2,); zeros where no such colour is common.
    """
    slopes = []
    for region in regions[:_MOST_REGIONS]:
        part = slices(region.box)
        seen, usual = (cv2.transform(cv2.LUT(cv2.blur(picture[part], (3, 3))[::2, ::2],
                                             _log_levels()), _AXES)
                       for picture in (frame, reference.lit))
        change = (seen - usual)[filled(region.outline, region.box)[::2, ::2] > 0]
        change = change[(change[:, 2] < _LEAST_SHADE) & (change[:, 2] > _DARKEST / _LEVEL_SCALE)]
        slopes.append(change[:, :2] / change[:, 2:])
    slopes = np.concatenate(slopes) if slopes else np.zeros((0, 2))
    counts, bins, _ = np.histogram2d(*slopes.T, _BINS, [[-_STRONGEST_TINT, _STRONGEST_TINT]] * 2)
    counts = cv2.blur(counts, (3, 3))
    if counts.max() * 9 < max(_LEAST_COMMON * len(slopes), _LEAST_PLACES):
        return np.zeros(2)
    middles = (bins[1:] + bins[:-1]) / 2
    return middles[np.array(np.unravel_index(counts.argmax(), counts.shape))]


def evidence(
    frame: np.ndarray, background: np.ndarray, noise: np.ndarray, tint: np.ndarray
) -> _Evidence:
    """
    Compare both explanations of a part of a frame.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :param noise: Shape (256, 3): the deviation of the grey levels, see `light.measure_noise`.
    :param tint: See :func:`measure_tint`.
    """
    variances = np.float32((noise ** 2 + _LEAST_VARIANCE) * _slopes() ** 2)[:, None]
    seen, usual = (_on_axes(picture, _log_levels(), _AXES) for picture in (frame, background))
    seen_variance, usual_variance = (
        _on_axes(picture, variances, _AXES ** 2) for picture in (frame, background))
    change = [cv2.subtract(*pair) for pair in zip(seen, usual)]
    variance = [one + other + _TREMBLE ** 2 * _gradient(detail)
                for one, other, detail in zip(seen_variance, usual_variance, usual)]
    light = _light(change, variance, tint, _SIZE)
    thing = _off_constant(seen, seen_variance, _SIZE)
    limit = 2 * _OWN * 3 * _SIZE ** 2
    if cv2.minMaxLoc(thing)[1] > limit:
        # Neither one colour nor one light: it may be a shade that is narrower than a window.
        # JPEG and a sensor's colour filter let colours bleed.
        for axis in range(2):
            step = cv2.morphologyEx(seen[axis], cv2.MORPH_GRADIENT, square(_SIZE))
            variance[axis] += (_BLEED * step) ** 2
        narrow = _light(change, variance, tint, _NARROW)
        light[(narrow < _WORST_LIGHT * 3 * _NARROW ** 2) & (light > limit)] = limit
    nats = (light - cv2.min(thing, limit)) / 2 - _PRIOR
    ratio = cv2.blur(change[2], (3, 3)) * _LEVEL_SCALE
    nats[ratio < _DARKEST] += _DARK_NATS
    nats[ratio > _LIGHTEST] += _LIGHT_NATS
    return _Evidence(nats, light / (3 * _SIZE ** 2), usual[2], seen[2], variance[2])


def _on_axes(picture: np.ndarray, table: np.ndarray, axes: np.ndarray) -> List[np.ndarray]:
    values = cv2.transform(cv2.LUT(picture, table), axes)
    return [cv2.extractChannel(values, axis) for axis in range(3)]


def _light(
    change: List[np.ndarray], variance: List[np.ndarray], tint: np.ndarray, size: int
) -> np.ndarray:
    """Give the chi-square of the light in the best window around each pixel: shape (h, w)."""
    count = size ** 2
    means, variance = ([_mean(one, size) for one in planes] for planes in (change, variance))
    shade = cv2.min(means[2], 0)
    # Tint and gain are the same all over a window.
    known = count * (_LEAST_TINT ** 2 + (_TINT * shade) ** 2)
    part, power = np.float32(0), float(tint @ tint)
    if power:
        # The chroma may be any between none and the tint's.
        along = means[0] * np.float32(tint[0]) + means[1] * np.float32(tint[1])
        part = np.clip(along / power, np.minimum(shade, -_NOTHING), 0)
    light = _off_plane(change[2], means[2], size) / variance[2]
    for axis in range(2):
        off_tint = means[axis] - part * np.float32(tint[axis])
        light += (count * (_mean(change[axis] ** 2, size) - means[axis] ** 2) / variance[axis]
                  + count * off_tint ** 2 / (variance[axis] + known))
    return cv2.erode(light, square(size))


def _off_constant(
    seen: List[np.ndarray], variance: List[np.ndarray], size: int
) -> np.ndarray:
    """Give the chi-square of one colour in the best window around each pixel: shape (h, w)."""
    # Small numbers: squares are taken.
    seen = [one - np.float32(cv2.mean(one)[0]) for one in seen]
    means, variance = ([_mean(one, size) for one in planes] for planes in (seen, variance))
    thing = _off_plane(seen[2], means[2], size) / variance[2]
    for axis in range(2):
        thing += size ** 2 * (_mean(seen[axis] ** 2, size) - means[axis] ** 2) / variance[axis]
    return cv2.erode(thing, square(size))


def _mean(values: np.ndarray, size: int) -> np.ndarray:
    return cv2.blur(values, (size, size))


def _off_plane(level: np.ndarray, mean: np.ndarray, size: int) -> np.ndarray:
    """Sum up the squares of what a plane leaves of a level in each window: shape (h, w)."""
    left = size ** 2 * (_mean(level ** 2, size) - mean ** 2)
    ramp, flat = np.arange(size, dtype=np.float32) - size // 2, np.ones(size, np.float32)
    power = size * float((ramp ** 2).sum())
    for across, down in ((ramp, flat), (flat, ramp)):
        left -= cv2.sepFilter2D(level, -1, across, down) ** 2 / np.float32(power)
    return cv2.max(left, 0)


def _gradient(values: np.ndarray) -> np.ndarray:
    return (cv2.Sobel(values, -1, 1, 0, scale=1 / 8) ** 2
            + cv2.Sobel(values, -1, 0, 1, scale=1 / 8) ** 2)


def things_in(
    frame: np.ndarray, region: Region, reference: Reference, tint: np.ndarray, min_area: float
) -> Optional[List[Region]]:
    """
    Find the things in a region, without their shade.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param region: What differs from the background, and is connected.
    :param reference: The background at the frame's light.
    :param tint: See :func:`measure_tint`.
    :param min_area: Of a thing, in px².
    :returns: One region for each thing, none where all is light; None where it is not clear.
    """
    window = grown(region.box, _MARGIN, frame)
    part = slices(window)
    found = evidence(frame[part], reference.lit[part], reference.noise, tint)
    changed = filled(region.outline, window)
    things = _solid(_smooth(found.nats) & cv2.dilate(changed, square(3)), min_area)
    if things is not None and things.any():
        things = _up_to_edges(things, changed, found, frame[part])
    if things is None or not _is_clear(things, changed, found, find_highlight(
            make_piece(frame[part], reference.light(part), changed)) is not None):
        return None
    masks = _cut_at_gaps(things, frame[part], reference.lit[part], min_area)
    outlines = [outline_of(mask, window) for mask in masks]
    return [Region(outline, Box(*cv2.boundingRect(outline)), int(cv2.contourArea(outline)),
                   is_thing=True, neighbours=(*outlines[:index], *outlines[index + 1:]))
            for index, outline in enumerate(outlines)]


def _cut_at_gaps(
    things: np.ndarray, frame: np.ndarray, background: np.ndarray, min_area: float
) -> List[np.ndarray]:
    """Give each thing's mask; cut where the table is seen, be it through a blurred lens."""
    away = channel_extremes(cv2.absdiff(frame, background))[1]
    around = cv2.morphologyEx(away, cv2.MORPH_CLOSE, square(_WIDEST_GAP))
    gap = cv2.morphologyEx(
        (away < _VALLEY * around).view(np.uint8), cv2.MORPH_CLOSE, square(3)) & things
    rest = cv2.erode(things & (1 - gap), square(3))
    whole = Box(0, 0, *things.shape[::-1])
    found: List[np.ndarray] = []
    for outline in outlines_in(things):
        inside = filled(outline, whole)
        least = max(min_area / 2, _LEAST_PART * enclosed(outline))
        cores = [filled(one, whole) for one in outlines_in(rest & inside)
                 if enclosed(one) >= least]
        if len(cores) > 1 and _is_gap(cores, gap & inside, frame, background):
            nearest = nearest_part(cores)
            found += [largest_part(inside & (1 - gap) & (nearest == index).view(np.uint8))
                      for index in range(len(cores))]
        elif enclosed(outline) >= min_area:
            found.append(inside)
    return found


def _is_gap(
    parts: List[np.ndarray], gap: np.ndarray, frame: np.ndarray, background: np.ndarray
) -> bool:
    # On the way from a dark face to a light one, a blurred edge looks like the table, too.
    near = cv2.dilate(gap, square(_WIDEST_GAP))
    change = np.int16(frame) - background
    sides = [change[(part & near) > 0] for part in parts]
    changes = [np.median(side, axis=0) for side in sides if len(side)]
    return all(float(one @ changes[0]) > 0 for one in changes)


def _smooth(nats: np.ndarray) -> np.ndarray:
    nats = cv2.blur(np.clip(nats, -_MOST_EVIDENCE, _MOST_EVIDENCE), (3, 3))
    return cv2.morphologyEx((nats > 0).view(np.uint8), cv2.MORPH_OPEN, square(3))


def _solid(things: np.ndarray, min_area: float) -> Optional[np.ndarray]:
    """Keep the parts that are wide enough for a window; None where much else is left out."""
    kept = np.zeros_like(things)
    core = cv2.erode(things, square(_SIZE))
    solid = thin = 0.0
    for outline in outlines_in(things):
        area = enclosed(outline)
        inside = filled(outline, Box(0, 0, *things.shape[::-1]))
        if area >= min_area and cv2.countNonZero(core & inside) >= _LEAST_CORE * area:
            solid += area
            kept |= inside
        else:
            thin += area
    return None if thin > max(min_area, _MOST_THIN * solid) else kept


def _up_to_edges(
    things: np.ndarray, changed: np.ndarray, found: _Evidence, frame: np.ndarray
) -> np.ndarray:
    """Give what is not clear to the things or to the light, up to the frame's edges."""
    # Only where the frame has no step between them: else it is their shade, or not clear.
    unknown = changed & (found.nats > -_CLEAR).view(np.uint8) & (1 - things)
    seeds = np.int32(things) + 2 * (1 - np.int32(cv2.dilate(unknown | things, square(3))))
    reached = (cv2.watershed(np.ascontiguousarray(frame), seeds) == 1).view(np.uint8)
    logs = cv2.LUT(frame, _log_levels())
    for outline in outlines_in(reached & (1 - things)):
        part = filled(outline, Box(0, 0, *things.shape[::-1])) & reached & (1 - things)
        if not _has_step(logs, things, part):
            things = things | part
    return things


def _has_step(logs: np.ndarray, one: np.ndarray, other: np.ndarray) -> bool:
    # Not at the border itself, where pixels are mixed.
    sides = [cv2.erode(side, square(3)) & cv2.dilate(beyond, square(9))
             for side, beyond in ((one, other), (other, one))]
    if not all(map(cv2.countNonZero, sides)):
        return False
    levels = [quantile(chosen(logs, side)) for side in sides]
    return bool(np.abs(levels[0] - levels[1]).max() > _LEAST_STEP)


def _is_clear(
    things: np.ndarray, changed: np.ndarray, found: _Evidence, has_highlight: bool
) -> bool:
    rest = changed & (1 - cv2.dilate(things, square(7)))
    count, total = cv2.countNonZero(rest), cv2.countNonZero(changed)
    if count < _LEAST_REST * total:
        return count < total
    # What light explains badly is neither.
    if cv2.countNonZero(rest & (found.light > _WORST_LIGHT).view(np.uint8)) > _MOST_BAD * count:
        return False
    sure = cv2.countNonZero(rest & (found.nats < -_CLEAR).view(np.uint8))
    if not things.any():
        return sure > _MOSTLY * count and _follows(found, rest)
    # A highlight or a lamp's mirror image is small and surrounded; a thing is not.
    return sure > _MOSTLY * count or not has_highlight and (
        cv2.countNonZero(things) > _LEAST_SHARE * total
        or has_free_rim(things, changed | things))


def _follows(found: _Evidence, rest: np.ndarray) -> bool:
    """Tell whether the table's own detail is seen in a part, so that light alone has changed."""
    own, detail = (level - _mean(level, _SIZE) for level in (found.usual, found.seen))
    inside = cv2.erode(rest, square(_SIZE))
    both, own = (cv2.mean(product / found.variance, inside)[0]
                 for product in (own * detail, own * own))
    return own > _LEAST_DETAIL and both > _LEAST_SLOPE * own
