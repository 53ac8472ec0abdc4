# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The light of a frame: its curve and gain, its noise, and the limits that follow from them.

`Reference` is the background as it looks at a frame's light.
"""

from functools import lru_cache
import math
import operator
from typing import Any, List, NamedTuple, Optional, Sequence

import cv2
import numpy as np

# The gain is rounded to this many steps per factor e.
_STEPS = 100
_POINTS = 24, 24  # rows and columns
# Darker levels are mostly noise, lighter ones may be cut off.
_DARKEST, _LIGHTEST = 8, 247
LEAST_LIGHT = 1e-3
_LEAST_USABLE = 1 / 12
_DARKEST_GAIN, _ALIKE, _LEAST_ALIKE, _NEAR = 0.06, 0.25, 0.2, 0.05
# From which grey level on the sensor may have cut off the light.
SATURATED = 250
# Grey levels grow with about this power of the light.
POWER = 1 / 2.2

# A camera that trembles shows at a place what lies beside it on the background.
_TREMBLE = np.ones((3, 3), np.uint8)
# An edge that has moved, or is sharpened otherwise, leaves that range by this part of its step.
_MOVED = 0.2
# Grey levels beyond the background's own range, and deviations of the noise: where an object's
# rim still counts, and what an object must have somewhere.
WEAK_LEVELS, _WEAK_DEVIATIONS, STRONG_DEVIATIONS = 5.0, 4.5, 10.0
# Which of the two limits; all of a picture, as indices.
_STRONG, _WEAK = range(2)
_ALL = slice(None), slice(None)

# Places that are compared, about, and how far apart the two of a pair are, in px.
_PLACES, _APART, _NEXT = 9000, 3, 1
# The same for what neighbours have in common, how much larger its deviation is at least, and by
# less than how many levels the two places differ on the background.
_FAR_APART, _LEAST_DRIFT, _SAME_PRINT = 24, 1.3, 32
_BIN, _LEAST_IN_BIN = 16, 60
_BINS, _DIFFERENCES = 256 // _BIN, 2 * 255 + 1
# A difference of whole numbers has a median of 0 on a quiet picture.
_QUIETEST = 0.3
# The median of a normal distribution's absolute values is 0.6745 of its deviation.
_DEVIATION = 1 / 0.6745
# The least that is measured, see `_by_level`, and a little more.
_NO_NOISE = 1.01 * _QUIETEST * _DEVIATION / 2

# The noise is measured in frames 1, 2, 4, 8 and so on, and in each of this number.
_NOISE_PERIOD = 64


def _linear_levels() -> np.ndarray:
    # The curve of sRGB (IEC 61966-2-1), which cameras follow more or less.
    coded = np.arange(256) / 255
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def _coded(light: np.ndarray) -> np.ndarray:
    light = np.clip(light, 0, 1)
    return 255 * np.where(
        light <= 0.0031308, 12.92 * light, 1.055 * np.power(light, 1 / 2.4) - 0.055)


# The light that makes a grey level, 0..1.
LINEAR = _linear_levels().astype(np.float32)
# Which part of a change of its logarithm is not seen, since a level is nearly black.
UNSEEN = LEAST_LIGHT / (LINEAR + LEAST_LIGHT)
# Two axes of chroma and one of level, of the logarithms of B, G and R; orthonormal.
AXES = np.float32([[1, 0, -1], [-1, 2, -1], [1, 1, 1]]) / np.sqrt(
    np.float32([[2], [6], [3]]))
LEVEL_SCALE = 1 / math.sqrt(3)


@lru_cache(maxsize=1)
def log_levels() -> np.ndarray:
    """Give the logarithm of each grey level's light: shape (256,), float32."""
    return np.log(LINEAR + LEAST_LIGHT).astype(np.float32)


def log_light(picture: np.ndarray) -> np.ndarray:
    """Give the logarithm of all channels' light: shape (h, w, 3), uint8, to (h, w), float32."""
    light = cv2.transform(cv2.LUT(picture, LINEAR), np.ones((1, 3), np.float32))
    return cv2.log(cv2.max(light, LEAST_LIGHT))


def grey_factors(light: np.ndarray) -> np.ndarray:
    """Give the factors on grey levels, times 128, uint8, of the logarithms of factors on light."""
    return np.clip(np.rint(128 * np.exp(POWER * light)), 1, 255).astype(np.uint8)


class Gain(NamedTuple):
    """How much more light there is than on the background, in steps, for B, G and R."""

    blue: int
    green: int
    red: int

    @property
    def factors(self) -> np.ndarray:
        """The gain as three factors on light, float32."""
        return np.exp(np.float32(self) / _STEPS)

    @property
    def linear_levels(self) -> np.ndarray:
        """Light of the background's levels at this gain, shape (256, 1, 3), float32."""
        light = LINEAR[:, None, None] * self.factors
        # What the sensor has cut off may have been as bright as this.
        light[SATURATED:] = np.maximum(light[SATURATED:], LINEAR[SATURATED:, None, None])
        return light

    @property
    def coded_levels(self) -> np.ndarray:
        """Grey levels that the background's levels have at this gain, shape (256, 3)."""
        return _coded(self.linear_levels[:, 0])

    def lit(self, picture: np.ndarray, darkest: bool = False) -> np.ndarray:
        """
        Give a picture, shape (h, w, 3), uint8, BGR, as it looks at this gain.

        :param darkest: Whether what the sensor has cut off is taken for as dark as it may be; or
            as bright.
        """
        if self == NO_GAIN:
            return picture
        # Above its first ten levels, the curve is a power: there a gain is a straight line.
        slopes = self.factors ** (1 / 2.4)
        line = np.column_stack([np.diag(slopes), 255 * 0.055 * (slopes - 1)])
        dimmed = cv2.transform(picture, line.astype(np.float32))
        if darkest or min(self) >= 0:
            return dimmed
        return cv2.max(dimmed, cv2.threshold(picture, SATURATED - 1, 0, cv2.THRESH_TOZERO)[1])


NO_GAIN = Gain(0, 0, 0)


class GainMeter:
    """
    Follows the frames' gain: the median of frame / background over a coarse grid.

    It is that of the surface as long as objects cover less than half of it. A gain stays in use
    until the median is more than a grey level off: a new one costs time.

    :param background: Shape (h, w, 3), uint8, BGR.
    """

    def __init__(self, background: np.ndarray) -> None:
        self._grid = tuple(map(_grid, background.shape[:2], _POINTS))
        levels = background[self._grid]
        usable = (levels >= _DARKEST) & (levels <= _LIGHTEST)
        # In a channel without enough such places all are used.
        self._usable = usable | (usable.mean(axis=(0, 1)) < _LEAST_USABLE)
        self._usable_share = self._usable.mean(axis=(0, 1)).tolist()
        self._light = np.maximum(LINEAR[levels], LEAST_LIGHT)
        self._gain: Optional[Gain] = None

    def follow(self, frame: np.ndarray) -> Gain:
        """Give the gain of a frame of the background's shape."""
        levels = np.ascontiguousarray(frame[self._grid])
        if self._gain is None or not self._holds(levels):
            self._gain = self._measured(levels)
            lit = np.rint(_coded(self._light * self._gain.factors)).astype(np.uint8)
            self._lowest, self._highest = (np.where(self._usable, lit, end).astype(np.uint8)
                                           for end in (0, 255))
        return self._gain

    def _holds(self, levels: np.ndarray) -> bool:
        # The median of whole levels, as in grouped data: half of those at a limit lie beyond it.
        return not (self._is_most(cv2.subtract(self._lowest, levels))
                    or self._is_most(cv2.subtract(levels, self._highest)))

    def _is_most(self, beyond: np.ndarray) -> bool:
        halves = cv2.mean(cv2.threshold(beyond, 2, 0, cv2.THRESH_TRUNC)[1])
        return any(map(operator.gt, halves, self._usable_share))

    def _measured(self, levels: np.ndarray) -> Gain:
        ratios = LINEAR[levels] / self._light
        steps = []
        for channel in range(3):
            chosen = ratios[..., channel][self._usable[..., channel]]
            median = float(np.median(chosen))
            alike = np.abs(chosen - median) < _ALIKE * median
            if median < _DARKEST_GAIN or alike.mean() < _LEAST_ALIKE:
                # The surface cannot be seen: all of it is covered, or it is dark.
                return NO_GAIN
            # Whole levels make the median jump; the mean around it does not.
            near = chosen[np.abs(chosen - median) < _NEAR * median]
            steps.append(round(_STEPS * math.log(near.mean() if len(near) else median)))
        return Gain(*steps)


def _grid(length: int, points: int) -> slice:
    step = max(length // points, 1)
    return slice(step // 2, None, step)


class Range(NamedTuple):
    """Darkest and lightest levels that are the background's, each of shape (h, w, 3), uint8."""

    darkest: np.ndarray
    lightest: np.ndarray

    def outside(self, frame: np.ndarray) -> np.ndarray:
        """Find the pixels beyond it in any channel: shape (h, w), uint8, 255 or 0."""
        return cv2.bitwise_not(cv2.inRange(frame, self.darkest, self.lightest))


class LevelLimits:
    """
    The background's own range of levels, at some light and with some noise.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param faintest: Grey levels that an object must at least differ by somewhere.
    """

    def __init__(self, background: np.ndarray, faintest: float) -> None:
        self._picture, self._faintest = background, faintest
        self._usual = Range(cv2.erode(background, _TREMBLE), cv2.dilate(background, _TREMBLE))
        self._moved = cv2.convertScaleAbs(
            cv2.subtract(*reversed(self._usual)), alpha=_MOVED)
        self._gain = NO_GAIN
        self._noise: Optional[np.ndarray] = None
        # For the strong and the weak limit: margins by level, and those of the whole picture; its
        # ranges at this light, and at the last one; the marks of one frame.
        self._margins: List[np.ndarray] = []
        self._wide_margins = _nothing_yet()
        self._ranges, self._old, self._masks = (_nothing_yet() for _ in range(3))
        self._marked: Optional[np.ndarray] = None
        self._print: Optional[np.ndarray] = None
        self.least = faintest

    def set_light(self, gain: Gain, noise: np.ndarray) -> None:
        """
        Follow the light and the noise, see :func:`measure_noise`.

        A level that is beyond the strong range differs by more than `least` from the background.
        """
        self._gain, self._ranges = gain, _nothing_yet()
        if noise is self._noise:
            return
        self._noise = noise
        noise = np.take_along_axis(noise, np.rint(gain.coded_levels).astype(int), axis=0)
        weak = np.maximum(min(WEAK_LEVELS, self._faintest), _WEAK_DEVIATIONS * noise)
        strong = np.maximum(self._faintest, STRONG_DEVIATIONS * noise)
        self.least = max(float(strong.min()) - 0.01, 0.0)
        self._margins = [np.uint8(np.minimum(np.rint(levels), 255))[:, None]
                         for levels in (strong, weak)]
        self._wide_margins = _nothing_yet()

    def mark(self, frame: Optional[np.ndarray]) -> None:
        """Compare all of a frame at once: faster where much of it has changed; None for parts."""
        if frame is None or frame is not self._marked:
            self._marked, self._masks = frame, _nothing_yet()

    def strong(self, frame: np.ndarray, part: tuple) -> np.ndarray:
        """Mark what an object must have somewhere, in a part: shape (h, w), uint8, 255 there."""
        return self._outside(frame, part, _STRONG)

    def weak(self, frame: np.ndarray, part: tuple) -> np.ndarray:
        """Mark what each pixel of an object shows, in a part: shape (h, w), uint8, 255 there."""
        return self._outside(frame, part, _WEAK)

    def has_print(self, part: tuple, levels: float) -> np.ndarray:
        """Mark where the background changes by some levels within 2 px: shape (h, w), uint8."""
        if self._print is None:
            change = cv2.subtract(*reversed(self._usual))
            blue, green, red = (cv2.extractChannel(change, channel) for channel in range(3))
            self._print = cv2.max(cv2.max(blue, green), red)
        return cv2.dilate(cv2.compare(self._print[part], levels, cv2.CMP_GT), _TREMBLE)

    def strong_range(self, part: tuple) -> Range:
        """Give the range that an object must leave somewhere, for a part of the picture."""
        return self._range_of(part, _STRONG)

    def _outside(self, frame: np.ndarray, part: tuple, which: int) -> np.ndarray:
        if self._marked is not frame:
            return self._range_of(part, which).outside(frame[part])
        if self._masks[which] is None:
            self._masks[which] = self._whole_range(which).outside(frame)
        return self._masks[which][part].copy()

    def _range_of(self, part: tuple, which: int) -> Range:
        known = self._ranges[which]
        if known is not None:
            return Range(*(bound[part] for bound in known))
        return self._range(part, self._margin(part, which))

    def _whole_range(self, which: int) -> Range:
        if self._ranges[which] is None:
            if self._wide_margins[which] is None:
                self._wide_margins[which] = self._margin(_ALL, which)
            # Where the last one was: the system gives new memory slowly.
            self._ranges[which] = self._old[which] = self._range(
                _ALL, self._wide_margins[which], self._old[which] or (None, None))
        return self._ranges[which]

    def _range(
        self, part: tuple, margin: np.ndarray,
        into: Sequence[Optional[np.ndarray]] = (None, None)
    ) -> Range:
        darkest, lightest = (bound[part] for bound in self._usual)
        return Range(cv2.subtract(self._gain.lit(darkest, darkest=True), margin, dst=into[0]),
                     cv2.add(self._gain.lit(lightest), margin, dst=into[1]))

    def _margin(self, part: tuple, which: int) -> np.ndarray:
        known = self._wide_margins[which]
        if known is not None:
            return known[part]
        levels = cv2.LUT(self._picture[part], self._margins[which])
        # A thing's rim is still seen on an edge; no edge makes a thing.
        return cv2.add(levels, self._moved[part]) if which == _STRONG else levels


def _nothing_yet() -> List[Any]:
    return [None, None]


def measure_noise(
    frame: np.ndarray, background: np.ndarray, apart: int = _APART, alike: int = 256
) -> np.ndarray:
    """
    Measure how much a frame differs from the background by noise alone.

    The differences at two places that are a few px apart are compared: light that has changed
    drops out, and so does what covers less than half of the places of a level.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :param apart: How far the two places of a pair are apart, in px.
    :param alike: By less than so many levels they differ on the background.
    :returns: Shape (256, 3): the deviation of one frame's grey levels, by level and channel.
    """
    step = max(int(np.sqrt(frame.shape[0] * frame.shape[1] / _PLACES)), 1)
    rows = slice(step // 2, None, step)
    usual = background[rows].astype(np.int16)
    change = frame[rows] - usual
    if change.shape[1] <= 2 * apart:
        return np.full((256, 3), _QUIETEST, np.float32)
    pairs, contrast = (np.abs(one[:, :-apart:step] - one[:, apart::step])
                       for one in (change, usual))
    bins = usual[:, :-apart:step] // _BIN
    return np.stack([_by_level(*(one[..., channel][contrast[..., channel] < alike]
                                 for one in (pairs, bins))) for channel in range(3)], axis=1)


def _by_level(differences: np.ndarray, bins: np.ndarray) -> np.ndarray:
    # How often each difference occurs at each level.
    counts = np.bincount(bins * _DIFFERENCES + differences, minlength=_BINS * _DIFFERENCES)
    counts = counts.reshape(_BINS, _DIFFERENCES)
    known = np.flatnonzero(counts.sum(axis=1) >= _LEAST_IN_BIN)
    medians = [_median(counts[number]) for number in known]
    if not medians:
        known = np.array([0])
        medians = [_median(counts.sum(axis=0)) if len(differences) else 0.0]
    deviations = np.interp(np.arange(256), known * _BIN + _BIN / 2, medians)
    # Two frames at two places each: four times one frame's variance.
    return (np.maximum(deviations, _QUIETEST) * _DEVIATION / 2).astype(np.float32)


def _median(counts: np.ndarray) -> float:
    # Between whole numbers: by how many values lie below, as in grouped data.
    upto = np.cumsum(counts)
    half = upto[-1] / 2
    whole = int(np.searchsorted(upto, int(half), side='right'))
    below = upto[whole] - counts[whole]
    low = max(whole - 0.5, 0.0)
    return float(low + (whole + 0.5 - low) * (half - below) / counts[whole])


class Reference:
    """
    A background that follows the frames' light and noise; its picture never changes.

    :param picture: Shape (h, w, 3), uint8, BGR.
    :param faintest: Grey levels that an object must at least differ by somewhere.
    """

    def __init__(self, picture: np.ndarray, faintest: float) -> None:
        self.picture = picture
        self.limits = LevelLimits(picture, faintest)
        self.noise: Optional[np.ndarray] = None
        self.mean_noise: Optional[float] = None
        # The variance that neighbours have in common (JPEG, video), by that of the noise.
        self.drift = 0.0
        # Which part of the noise neighbours have alike: compression makes it so.
        self.compression = 0.0
        self._faintest = faintest
        self._meter = GainMeter(picture)
        self._frame_count = 0
        self._edges: Optional[np.ndarray] = None
        self._usual_level = int(np.median(picture[::8, ::8]))
        self._use_gain(NO_GAIN)

    def follow(self, frame: np.ndarray) -> bool:
        """
        Take a frame's light, and now and then its noise, for this and the next frames.

        :returns: Whether `lit` or `limits` have changed.
        """
        gain = self._meter.follow(frame)
        self.limits.mark(None)
        self._frame_count += 1
        count = self._frame_count
        is_noise_due = count & (count - 1) == 0 or count % _NOISE_PERIOD == 0
        if gain == self.gain and not is_noise_due:
            return False
        if gain != self.gain:
            self._use_gain(gain)
        if is_noise_due:
            self.noise = measure_noise(frame, self.lit)
            self.mean_noise = self._usual_noise(self.noise)
            near = self._usual_noise(measure_noise(frame, self.lit, _NEXT)) / self.mean_noise
            # A tone curve that has changed shows where a print does, too: that is no drift.
            own, far = (self._usual_noise(measure_noise(frame, self.lit, apart, _SAME_PRINT))
                        for apart in (_APART, _FAR_APART))
            self.drift = (far / own) ** 2 - 1 if far > _LEAST_DRIFT * own else 0.0
            # Each camera has noise: where there is none, it was compressed away.
            self.compression = (1.0 if self.mean_noise < _NO_NOISE
                                else 1 - min(near, 1.0) ** 2)
        self.limits.set_light(gain, self.noise)
        return True

    def _usual_noise(self, noise: np.ndarray) -> float:
        return float(noise[self._usual_level].mean())

    def _use_gain(self, gain: Gain) -> None:
        self.gain = gain
        self._linear_levels = gain.linear_levels
        self.lit = gain.lit(self.picture)

    def has_edges(self, part: tuple) -> bool:
        """Tell whether a part of the background changes by as much as an object within 5 px."""
        if self._edges is None:
            size = np.ones((5, 5), np.uint8)
            gradient = cv2.morphologyEx(cv2.blur(self.picture, (3, 3)), cv2.MORPH_GRADIENT, size)
            self._edges = cv2.bitwise_not(cv2.inRange(gradient, 0, (self._faintest,) * 3))
        return cv2.countNonZero(self._edges[part]) > 0

    def at_this_light(self, picture: np.ndarray) -> np.ndarray:
        """Give a picture of the background's shape as it looks at the frame's light."""
        return self.gain.lit(picture)

    def light(self, part: tuple) -> np.ndarray:
        """Give the light of a part of the background at the frame's light, float32."""
        return cv2.LUT(self.picture[part], self._linear_levels)
