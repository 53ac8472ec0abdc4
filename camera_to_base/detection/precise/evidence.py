# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
What speaks for a thing at each pixel, and what for light: two chi-squares in small windows.

On the table, a frame is `log frame = log background + level + tint + noise`: light changes the
level smoothly or with an edge, and hardly the chroma; the table's own texture stays. A thing has a
colour of its own, and the texture below it is gone. By the known noise of each grey level:

- light: the chroma of frame / background is none or the shade's tint, and its level is a plane;
  or the same is true of frame - background, where a reflection adds a lamp's light,
- thing: the chroma of the frame is constant, and its level is a plane. A thing may have a texture
  of its own: it costs no more than to describe each pixel on its own.

Each takes the best of the windows that contain the pixel, so that nothing leaks over a border.
"""

import math
from typing import List, NamedTuple, Optional, Sequence

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.light import (
    AXES, LEVEL_SCALE, LINEAR, log_levels, SATURATED, UNSEEN)
from camera_to_base.detection.precise.noise import Noise
from camera_to_base.detection.precise.piece import grown, slices, square
from camera_to_base.detection.precise.shade import (
    DARKEST, FAINTEST, GREY, Shade, without)
import cv2
import numpy as np

# The edge of a window, and of one for narrow shade, in px.
_SIZE, _NARROW = 5, 3
# How much of a step of colour is seen beside it.
_BLEED = 0.1
# What JPEG leaves of a step beside it, on both axes of chroma and on the level: as a part of the
# step, and in a window of so many px: its blocks. Chosen on 1349 things in 20 rendered cells.
_BLOCKS = (0.02, 17), (0.02, 17), (0.0075, 9)
# How much chroma light may change for each change of the level, and anyway (steps of the gain,
# rounding); how far a camera trembles, in px.
_TINT, _LEAST_TINT, _TREMBLE = 0.02, 0.008, 0.12
_NOTHING = 1e-9
# A channel is nearly black where this part of its changes is not seen, in the mean.
_LEAST_UNSEEN = 0.05
# Nats: how much clearer than light a thing must be; what a pixel's channel costs that is described
# on its own (the range of logarithms over the noise).
PRIOR, _OWN = 12.0, 3.5
# A thing of just the colour that a coloured table has is rare: nats for each unit of the table's
# chroma (logarithm) above what a grey one has, and at most. So light may change the chroma more
# there, for each change of the level.
_OF_CHROMA, _MOST_OF_CHROMA, _COLOURED_TINT = 40.0, 30.0, 0.04
# How much chroma a lamp's light may have in a reflection, by its level; what is lighter by this
# logarithm may be one, where the table has this chroma (logarithm) or a slope of this variance.
_LAMP_TINT, _LIGHTER, _HARDLY_GREY, _TEXTURE = 0.03, 0.1, 0.25, 5.0
# What the sensor has cut off tells no light: its logarithm's variance.
_UNKNOWN = 0.1
# What is cut off does not drift: the largest variance that does.
_MOST_DRIFT = 0.01
# Logarithm of the ratio: sun is 2.5 times as bright as shade. What is brighter is a thing, where
# it ends within some px on this part of its rim; a lamp's mirror image fades away.
BRIGHTEST, _FADES, _LEAST_SHARP, _NEAR_RIM, _BEYOND_RIM = 1.0, 0.4, 0.75, 5, 9
# Chi-square of the light, over its degrees of freedom: from here on it is none.
WORST_LIGHT = 3.0
# How much of the table's detail is seen where only the light has changed; how many deviations of
# chance tell that, and tell that it may be; what may be left of the variance; how much more than
# the known noise is a texture's.
_LEAST_SLOPE, _MOST_SLOPE, _LEAST_LIKENESS, _SOME_LIKENESS = 0.3, 1.6, 8.0, 4.0
_MOST_LEFT, _SURE_NOISE = 2.5, 1.4
# From this part of the table's power on, what is seen is a texture of another kind.
_OTHER_TEXTURE = 0.5
# A pixel's detail, by its variance, counts no more than so much where a few pixels are asked.
_MOST_OF_A_PIXEL = 9.0
# How many pixels tell as much of a texture as one whose noise is its own: demosaicing and JPEG
# spread noise.
_SPREAD = 3


class Evidence(NamedTuple):
    """
    What speaks for a thing, pixel by pixel, each of shape (h, w), float32.

    :param nats: How much more likely a thing is than light, but for `is_dark`.
    :param is_dark: Whether it is darker than shade is, unless the room is dark, uint8.
    :param is_black: Whether it is darker than any shade in this room, uint8.
    :param light: Chi-square of the light, by its degrees of freedom.
    :param usual: The background's level.
    :param seen: The frame's.
    :param variance: Of a difference of both, by noise alone.
    :param colour: What speaks against a thing of the table's chroma, nats.
    :param shade: What shade does on the frame.
    :param detail: Products of the background's detail and the frame's, over the variance, shape
        (h, w, 4): of both, of the background's, of the frame's; and the background's own variance.
    :param chroma: How the chroma has changed, logarithms on both axes of it.
    :param level: How the level has changed: what is seen, less what is usual.
    """

    nats: np.ndarray
    is_dark: np.ndarray
    is_black: np.ndarray
    light: np.ndarray
    usual: np.ndarray
    seen: np.ndarray
    variance: np.ndarray
    colour: np.ndarray
    shade: Shade
    detail: np.ndarray
    chroma: Sequence[np.ndarray]
    level: np.ndarray

    @property
    def is_light(self) -> np.ndarray:
        """What light explains better than a thing: shape (h, w), uint8, 1 there."""
        return (self.nats < 0).view(np.uint8) & (1 - self.is_black)

    @property
    def is_deep(self) -> np.ndarray:
        """What may be an umbra of a dark room, or black: shape (h, w), uint8, 1 there."""
        return self.is_dark & (1 - self.is_black)

    @property
    def off_tints(self) -> np.ndarray:
        """How far the chroma is off what the tints of shade may do: logarithm, shape (h, w)."""
        return np.hypot(*self.shade.off_tints(self.chroma, self.level))

    @property
    def is_lighter(self) -> np.ndarray:
        """What is lighter than the table, and so no shade: shape (h, w), uint8, 1 there."""
        return (self.level * LEVEL_SCALE > -FAINTEST).view(np.uint8)


def evidence(
    frame: np.ndarray, background: np.ndarray, noise: Noise, shade: Shade
) -> Evidence:
    """
    Compare both explanations of a part of a frame.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :param noise: That of the frame, at its scale.
    :param shade: What shade does on the frame.
    """
    variances, drift = noise.variances(log_levels()), noise.drift
    variances[SATURATED:] = _UNKNOWN
    seen, seen_variance, usual, usual_variance, change, variance = _compared(
        frame, background, log_levels(), variances)
    noise_alone = variance[2]
    if noise.compression:
        for axis, (part, reach) in enumerate(_BLOCKS):
            step = cv2.morphologyEx(seen[axis], cv2.MORPH_GRADIENT, square(reach))
            beside = noise.compression * (part * step) ** 2
            seen_variance[axis] = seen_variance[axis] + beside
            variance[axis] = variance[axis] + beside
    chroma = cv2.magnitude(*usual[:2])
    colour = _nats_of_chroma(chroma)
    dark = _Dark.of(background)
    light = _light(change, variance, drift, shade, dark, colour, _SIZE)
    lighter = box_mean(change[2], _SIZE) * LEVEL_SCALE > _LIGHTER
    if lighter.any():
        # On a plain grey table a reflection is as any other light.
        lighter &= (chroma > _HARDLY_GREY) | (
            box_mean(gradient(usual[2]), _SIZE) > _TEXTURE * usual_variance[2])
    if lighter.any():
        light = cv2.min(light, _reflection(
            frame, background, noise.variances(LINEAR), drift, lighter))
    thing = _off_constant(seen, seen_variance, _SIZE)
    limit = 2 * _OWN * 3 * _SIZE ** 2
    if cv2.minMaxLoc(thing)[1] > limit:
        # Neither one colour nor one light: it may be a shade that is narrower than a window.
        # JPEG and a sensor's colour filter let colours bleed.
        for axis in range(2):
            step = cv2.morphologyEx(seen[axis], cv2.MORPH_GRADIENT, square(_SIZE))
            variance[axis] += (_BLEED * step) ** 2
        narrow = _light(change, variance, drift, shade, dark, colour, _NARROW)
        light[(narrow < WORST_LIGHT * 3 * _NARROW ** 2) & (light > limit)] = limit
    nats = (light - cv2.min(thing, limit)) / 2 - PRIOR
    ratio = cv2.blur(change[2], (3, 3)) * LEVEL_SCALE
    bright = _sharp_bright(ratio)
    is_dark, is_black = ((ratio < least).view(np.uint8) | bright
                         for least in (DARKEST, shade.darkest))
    return Evidence(nats, is_dark, is_black, light / (3 * _SIZE ** 2), usual[2], seen[2],
                    noise_alone, colour, shade,
                    _products(usual[2], seen[2], usual_variance[2], noise_alone),
                    change[:2], change[2])


def _nats_of_chroma(chroma: np.ndarray) -> np.ndarray:
    """Tell what speaks against a thing of the table's own chroma, in nats."""
    return np.clip(_OF_CHROMA * (chroma - GREY), 0, _MOST_OF_CHROMA)


def _products(
    usual: np.ndarray, seen: np.ndarray, usual_variance: np.ndarray, variance: np.ndarray
) -> np.ndarray:
    own, now = (level - box_mean(level, _SIZE) for level in (usual, seen))
    per_noise = own / variance
    return cv2.merge([per_noise * now, per_noise * own, now * now / variance,
                      usual_variance / variance])


def _sharp_bright(ratio: np.ndarray) -> np.ndarray:
    bright = (ratio > BRIGHTEST).view(np.uint8)
    if not bright.any():
        return bright
    rim = cv2.dilate(bright, square(_BEYOND_RIM)) & (1 - cv2.dilate(bright, square(_NEAR_RIM)))
    soft = rim & (ratio > _FADES).view(np.uint8)
    count, labels = cv2.connectedComponents(cv2.dilate(bright, square(_BEYOND_RIM)))
    of_rim, of_soft = (np.bincount(labels[one > 0], minlength=count) for one in (rim, soft))
    is_sharp = of_soft <= (1 - _LEAST_SHARP) * of_rim
    return bright & is_sharp[labels].view(np.uint8)


def _on_axes(picture: np.ndarray, table: np.ndarray, axes: np.ndarray) -> List[np.ndarray]:
    values = cv2.LUT(picture, table)
    return [cv2.transform(values, axis[None]) for axis in axes]


class _Compared(NamedTuple):
    """What two pictures show on the axes of :data:`light.AXES`, and its variances: (h, w) each."""

    seen: List[np.ndarray]
    seen_variance: List[np.ndarray]
    usual: List[np.ndarray]
    usual_variance: List[np.ndarray]
    change: List[np.ndarray]
    variance: List[np.ndarray]


def _compared(
    frame: np.ndarray, background: np.ndarray, curve: np.ndarray, variances: np.ndarray
) -> _Compared:
    """Compare two pictures by what their grey levels are on a curve."""
    (seen, seen_variance), (usual, usual_variance) = (
        (_on_axes(picture, curve, AXES), _on_axes(picture, variances, AXES ** 2))
        for picture in (frame, background))
    return _Compared(
        seen, seen_variance, usual, usual_variance,
        [cv2.subtract(*pair) for pair in zip(seen, usual)],
        [one + other + _TREMBLE ** 2 * gradient(detail)
         for one, other, detail in zip(seen_variance, usual_variance, usual)])


class _Dark(NamedTuple):
    """
    What light does to the chroma where a channel is nearly black.

    :param axis: Where the channel lies on both axes of chroma, shape (2,).
    :param unseen: Which part of its change is not seen, shape (h, w), float32.
    """

    axis: np.ndarray
    unseen: np.ndarray

    @classmethod
    def of(cls, background: np.ndarray) -> Optional['_Dark']:
        """Take the darkest channel of a background; None where none is dark."""
        darkest = int(np.argmin(cv2.mean(background)[:3]))
        unseen = cv2.LUT(cv2.extractChannel(background, darkest), UNSEEN)
        return cls(AXES[:2, darkest], unseen) if cv2.mean(unseen)[0] > _LEAST_UNSEEN else None


def _light(
    change: List[np.ndarray], variance: List[np.ndarray], drift: float, room: Shade,
    dark: Optional[_Dark], colour: np.ndarray, size: int
) -> np.ndarray:
    """Give the chi-square of the light in the best window around each pixel: shape (h, w)."""
    count = size ** 2
    windows = _windows(change, variance, size)
    means = windows.means
    shade = cv2.min(means[2], 0)
    # Tint and gain are the same all over a window; and no light is brighter than the sun.
    known = count * (_LEAST_TINT ** 2 + (_TINT * shade) ** 2 + (
        _COLOURED_TINT / _MOST_OF_CHROMA * colour * cv2.min(
            means[2], BRIGHTEST / LEVEL_SCALE)) ** 2)
    # The chroma may be any between none and the tint's.
    off = room.off_tints(means[:2], means[2])
    if dark is not None:
        # Nobody knows how much of this channel there is, besides what light changes.
        most = dark.unseen * (1 + LEVEL_SCALE * np.abs(means[2]))
        off = without(off, dark.axis, -most, most)
    return cv2.erode(_chi_square(windows, off, drift, known, size), square(size))


class _Windows(NamedTuple):
    """
    What the windows around each pixel hold of a picture on the axes, each of shape (h, w).

    :param means: On each axis; of the chroma by what is known of each pixel.
    :param variance: Of the two axes of chroma: that of a mean, times the number of pixels.
    :param spread: Chi-square of a level that is a plane and of any one chroma.
    """

    means: List[np.ndarray]
    variance: List[np.ndarray]
    spread: np.ndarray


def _windows(
    values: List[np.ndarray], variance: List[np.ndarray], size: int
) -> _Windows:
    """Sum up what a picture shows on the axes, with its variance, in each window."""
    means, variances, level = [], [], box_mean(values[2], size)
    spread = _off_plane(values[2], level, size) / box_mean(variance[2], size)
    for value, one in zip(values[:2], variance):
        # What the sensor has cut off, or an edge, must not hide what is seen beside it.
        weighted = value / one
        known = 1 / box_mean(1 / one, size)
        total = box_mean(weighted, size)
        spread += size ** 2 * (box_mean(weighted * value, size) - total ** 2 * known)
        means.append(total * known)
        variances.append(known)
    return _Windows([*means, level], variances, spread)


def _chi_square(
    windows: _Windows, off: List[np.ndarray], drift: float, known: np.ndarray, size: int
) -> np.ndarray:
    """
    Give the chi-square of a level that is a plane and of a chroma that light may have.

    :param off: How far the two axes of chroma are off what light may have.
    :param known: The variance of that besides the noise, times the number of pixels.
    """
    count, result = size ** 2, windows.spread
    for one, variance in zip(off, windows.variance):
        result = result + count * one ** 2 / (
            variance + count * drift * cv2.min(variance, _MOST_DRIFT) + known)
    return result


def _reflection(
    frame: np.ndarray, background: np.ndarray, variances: np.ndarray, drift: float,
    lighter: np.ndarray,
) -> np.ndarray:
    """
    Give the chi-square of a lamp's light that is added to the table's, as :func:`_light`.

    :param variances: Of the light of each grey level.
    :param lighter: Which windows may have such light, shape (h, w), bool.
    """
    # What the sensor has cut off is no sum of both: no reflection.
    added = _compared(frame, background, LINEAR, variances)
    windows = _windows(added.change, added.variance, _SIZE)
    light = _chi_square(windows, windows.means[:2], drift,
                        _SIZE ** 2 * (_LAMP_TINT * windows.means[2]) ** 2, _SIZE)
    light[~lighter] = np.inf
    return cv2.erode(light, square(_SIZE))


def _off_constant(
    seen: List[np.ndarray], variance: List[np.ndarray], size: int
) -> np.ndarray:
    """Give the chi-square of one colour in the best window around each pixel: shape (h, w)."""
    # Small numbers: squares are taken.
    seen = [one - np.float32(cv2.mean(one)[0]) for one in seen]
    return cv2.erode(_windows(seen, variance, size).spread, square(size))


def box_mean(values: np.ndarray, size: int) -> np.ndarray:
    """Give the mean of the window around each pixel, whose edge has `size` px."""
    return cv2.blur(values, (size, size))


def _off_plane(level: np.ndarray, mean: np.ndarray, size: int) -> np.ndarray:
    """Sum up the squares of what a plane leaves of a level in each window: shape (h, w)."""
    left = size ** 2 * (box_mean(level ** 2, size) - mean ** 2)
    ramp, flat = np.arange(size, dtype=np.float32) - size // 2, np.ones(size, np.float32)
    power = size * float((ramp ** 2).sum())
    for across, down in ((ramp, flat), (flat, ramp)):
        left -= cv2.sepFilter2D(level, -1, across, down) ** 2 / np.float32(power)
    return cv2.max(left, 0)


def gradient(values: np.ndarray) -> np.ndarray:
    return (cv2.Sobel(values, -1, 1, 0, scale=1 / 8) ** 2
            + cv2.Sobel(values, -1, 0, 1, scale=1 / 8) ** 2)


class Detail(NamedTuple):
    """
    How the detail of a frame follows the background's.

    :param likeness: How many deviations of chance they have in common.
    :param slope: How much of the background's is seen.
    :param left: The variance of the rest, over the noise.
    :param nats: How much more likely it is that none of it is seen than that all of it is; 0
        where the background has none.
    :param added: Which part of the light is the table's, if a reflection was added to it.
    """

    likeness: float
    slope: float
    left: float
    nats: float
    added: float

    @property
    def is_table(self) -> bool:
        """Whether the table is seen, so that light alone has changed."""
        return (self.likeness > _LEAST_LIKENESS and self.may_be_table
                and self.left < _MOST_LEFT)

    @property
    def may_be_table(self) -> bool:
        """Whether something like the table is seen."""
        # Where far more light was added than the table has, its texture could not be seen.
        least = _LEAST_SLOPE * max(self.added, math.exp(-BRIGHTEST))
        return self.likeness > _SOME_LIKENESS and least < self.slope < _MOST_SLOPE


def detail_of(found: Evidence, part: np.ndarray) -> Detail:
    near = slices(grown(Box(*cv2.boundingRect(part)), _SIZE // 2, part))
    inside = cv2.erode(part[near], square(_SIZE))
    both, own, seen, own_noise = cv2.mean(found.detail[near], inside)
    count = cv2.countNonZero(inside)
    # The noise of the background alone makes the slope less steep.
    texture = max(1 - _SURE_NOISE * own_noise / max(own, _NOTHING), 0.0)
    # A reflection adds light, so that all of the detail is a smaller part of it.
    added = _added(found, near, inside)
    nats = count / _SPREAD * texture * min(
        part * (texture * part / 2 * own - both) for part in (1.0, added))
    if nats > 0 and seen - (1 - own_noise) > _OTHER_TEXTURE * (own - own_noise):
        # Another texture: a thing's own, or the table's, from where the camera was before a push.
        nats = 0.0
    if both <= 0:
        return Detail(0.0, 0.0, seen, nats, added)
    slope = both / max(own - own_noise, own / 4)
    likeness = both * np.sqrt(count / (own * seen))
    return Detail(likeness, slope, (seen - slope * both) / (1 + own / 4), nats, added)


def detail_nats(found: Evidence, inside: np.ndarray, size: int) -> np.ndarray:
    """
    Tell what speaks against the table's texture in the window around each pixel: nats, (h, w).

    :param inside: Where to look, shape (h, w), uint8, 1 there.
    :param size: The edge of a window, px.
    """
    # One edge of the background, where an object has left, is no texture.
    own = cv2.extractChannel(found.detail, 1)
    weight = (inside * cv2.min(_MOST_OF_A_PIXEL / cv2.max(own, _NOTHING), 1))[..., None]
    both, own, _, own_noise = cv2.split(cv2.boxFilter(
        found.detail * weight, -1, (size, size), normalize=False))
    texture = cv2.max(1 - _SURE_NOISE * own_noise / cv2.max(own, _NOTHING), 0)
    return texture * (texture / 2 * own - both) / _SPREAD


def _added(found: Evidence, near: tuple, inside: np.ndarray) -> float:
    """Tell which part of a light is left of the table's, if the rest was added; 1 where darker."""
    seen, usual = (cv2.mean(level[near], inside)[0] for level in (found.seen, found.usual))
    return math.exp(min((usual - seen) * LEVEL_SCALE, 0.0))
