# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures what shade does on a frame: how it tints the table, and how dark it is.

All things of a frame lie in the same lamps' light, so their shades are alike: below one hard lamp
each is as dark as the others, below two lamps there are three levels. A grey thing's faces seldom
have just these levels. Where lamps differ in colour, the shade of each has the others' tint; where
the sensor has cut off the table's light, and with it some of its tint, shade shows that. All this
is measured beside coloured and black things: what is darker there, and not of their colour, is
shade.
"""

import math
import operator
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.light import AXES, LEVEL_SCALE, log_levels, SATURATED, UNSEEN
from camera_to_base.detection.precise.piece import channel_extremes, filled, slices
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import Region
import cv2
import numpy as np

# Logarithm of the ratio: a sixth of the light.
DARKEST = float(np.log(1 / 6))
# The tints of a frame's shade: how strong on each axis, in how many bins, how many of them, and
# how common each is: beside coloured things, and anywhere. The same for the chroma that shade of
# one level has; and which of the faintest have how much of it where the table is cut off.
_BESIDE_COLOURED, _ANYWHERE = (0.48, 48, 3, 0.08), (0.12, 24, 1, 0.3)
_AT_A_LEVEL, _FAINT_LEVELS, _LOST_CHROMA = (0.25, 25, 2, 0.15), 4, 0.05
# On how many places, and how much darker these are, logarithm; what is called a tint.
_LEAST_PLACES, _LEAST_SHADE, _LEAST_TINT = 60, -0.25, 0.04
# Where this part of what is darker has no tint, shade has none.
_LEAST_NEUTRAL_SHARE = 0.1
_MOST_REGIONS, _MOST_PLACES = 30, 4000
# A place shows a thing and no shade from this chroma on, logarithm, or where it is darker than all
# shade; on which part of a region.
_COLOURED, _LEAST_THING = 0.15, 0.4
# Shade has less chroma, and less than this part of its level; on so many places of a region.
NEUTRAL, _OF_LEVEL, _LEAST_NEUTRAL = 0.04, 0.1, 15
# How far a level may be cut off, logarithm; to how many levels a mean is known. The variance of
# that, over that of a neutral colour.
_CUT_OFF, _KNOWN_TO = 0.3, 1.5
_LOGS = log_levels().tolist()
_UNKNOWN = ((np.where(
    np.arange(256) < SATURATED, _KNOWN_TO * np.gradient(_LOGS) + UNSEEN, _CUT_OFF)
             / NEUTRAL) ** 2).tolist()
# How much chroma a grey table has at most, logarithm; two colours are one below this change.
GREY, _ALIKE = 0.5, 0.16
# What each channel keeps of its light in shade, at least and at most, and how much more than
# another: so that it can be asked pixel by pixel.
_DEEPEST, SHADED, _TINT = 0.25, 0.985, 1.25
# The faintest shade, logarithm of the ratio; the bins of the levels.
FAINTEST, _STEP, _LEVELS = -0.1, 0.05, 40
# How many regions' shade is of any level, besides those that are seen; how many nats one of the
# odds counts. Chosen on 164 rendered things in a hard lamp's light, and right on 485 others.
_ANY, _WEIGHT = 0.3, 8.0
# An umbra that is darker than usual: the bins of its logarithm; which part of a region is lit or
# coloured, which part of it is umbra, and in how many regions. The sum of these parts; how much
# more common it is than lighter shade; how far below it shade still lies. None of 56 sets of real
# pictures has one, with black chessmen, tiles, letters and cables.
_DEPTHS, _LEAST_LIT, _LEAST_IN, _LEAST_UMBRAS = np.arange(-3.4, -0.29, 0.1), 0.25, 0.04, 2
_LEAST_UMBRA, _CLEARLY, _BELOW = 0.1, 2.0, 0.3
_NOTHING = 1e-9


class Shade(NamedTuple):
    """
    What shade does on a frame.

    :param tints: By how much it changes the chroma at each level, shape (2, n) each, one for each
        lamp: logarithms on both axes.
    :param levels: What is known of shade: the region's box, if it is one's, and how common each
        level is in its shade, shape (n,), with the sum 1.
    :param darkest: Logarithm of the ratio: what is darker is no shade.
    """

    tints: Sequence[np.ndarray] = ()
    levels: Sequence[Tuple[Optional[Box], np.ndarray]] = ()
    darkest: float = DARKEST

    def off_tints(self, chroma: Sequence[Any], level: Any) -> Sequence[Any]:
        """
        Take out of a chroma what shade may have of it: what is left, on both axes.

        :param level: By how much the level has changed, of the chroma's shape.
        """
        if not self.tints:
            return chroma
        ratio = LEVEL_SCALE * np.minimum(level, 0)
        number = _bin(ratio)
        most = np.minimum(-2 / _STEP * ratio, 1)
        least, *others = [without(chroma, [axis[number] for axis in one], 0, most)
                          for one in self.tints]
        for one in others:
            is_less = one[0] ** 2 + one[1] ** 2 < least[0] ** 2 + least[1] ** 2
            least = [np.where(is_less, *pair) for pair in zip(one, least)]
        return least

    def beside(self, box: Box) -> 'Shade':
        """Give what is known without a region: it does not speak for itself."""
        return self._replace(levels=[one for one in self.levels if one[0] != box])

    def with_levels(self, ratios: Sequence[float]) -> 'Shade':
        """Add the levels of what is surely shade: logarithms of the ratio to the table's."""
        return self._replace(levels=[*self.levels, *(
            (None, _common(np.array([ratio]))) for ratio in ratios if ratio < FAINTEST)])

    def nats(self, ratio: float) -> float:
        """
        Tell what speaks for a thing because other shade does not have its level, in nats.

        :param ratio: Logarithm of the level / the table's.
        """
        if not self.levels or ratio > FAINTEST:
            return 0.0
        common = sum(float(levels[_bin(ratio)]) for _, levels in self.levels)
        return -_WEIGHT * math.log(
            (_LEVELS * common + _ANY) / (len(self.levels) + _ANY))


def without(
    chroma: Sequence[Any], direction: Sequence[Any], least: Any, most: Any
) -> Sequence[Any]:
    """Take a direction out of a chroma, as far as it may be there: between `least` and `most`."""
    x, y = map(np.float32, direction)
    along = (chroma[0] * x + chroma[1] * y) / (x * x + y * y + _NOTHING)
    part = np.minimum(np.maximum(along, least), most)
    return [chroma[0] - part * x, chroma[1] - part * y]


def measure_shade(frame: np.ndarray, regions: List[Region], reference: Reference) -> Shade:
    """
    Measure what the shade of a frame's regions does.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param regions: The largest first; more than 30 take no more time.
    :param reference: The background at the frame's light.
    """
    changes = [_change(frame, region, reference) for region in regions[:_MOST_REGIONS]]
    darkest = _darkest(changes)
    shades = [_shade_in(change, darkest) for change in changes]
    shade = Shade(_tints(changes, shades, darkest), darkest=darkest)
    levels = [(region.box, _levels(one, shade))
              for region, one in zip(regions, shades) if one is not None]
    return shade._replace(levels=[(box, one) for box, one in levels if one is not None])


def _change(frame: np.ndarray, region: Region, reference: Reference) -> np.ndarray:
    """Give the change of chroma and level at some places of a region, shape (n, 3)."""
    part, box = slices(region.box), region.box
    scale = max(2, math.ceil(math.sqrt(box.width * box.height / _MOST_PLACES)))
    # Means of two px at each place.
    seen, usual = (cv2.transform(cv2.LUT(np.ascontiguousarray(cv2.blur(
        picture[part][::scale], (2, 1))[:, ::scale]), log_levels()), AXES)
        for picture in (frame, reference.lit))
    return (seen - usual)[filled(region.outline, box)[::scale, ::scale] > 0]


def is_neutral(chroma: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """
    Tell where the chroma has changed by no more than shade or sun does.

    :param chroma: By how much, logarithm.
    :param ratio: Logarithm of the level / the table's.
    """
    return chroma < np.maximum(NEUTRAL, _OF_LEVEL * np.abs(ratio))


def like_light(ratio: np.ndarray, most: float) -> np.ndarray:
    """
    Find where all channels have changed nearly alike: shape (h, w), uint8, 1 there.

    :param ratio: Of the light to the table's, shape (h, w, 3), float32.
    :param most: The largest ratio in a channel, as `SHADED`.
    """
    smallest, largest = channel_extremes(ratio)
    return ((smallest > _DEEPEST) & (largest < most) & (largest < _TINT * smallest)).view(np.uint8)


def change_of(level: Sequence[float], usual: Sequence[float]) -> Tuple[float, float]:
    """
    Give by how much the chroma and the level of a colour have changed, logarithms.

    What is nearly black, or cut off by the sensor, tells little.

    :param level: Mean grey levels, B, G and R.
    :param usual: The table's.
    """
    pairs = [(round(one), round(other)) for one, other in zip(level, usual)]
    changes = [_LOGS[now] - _LOGS[before] for now, before in pairs]
    weights = [1 / (1 + _UNKNOWN[now] + _UNKNOWN[before]) for now, before in pairs]
    ratio = sum(map(operator.mul, weights, changes)) / sum(weights)
    return math.sqrt(sum(weight * (change - ratio) ** 2
                         for weight, change in zip(weights, changes))), ratio


def is_of_its_colour(level: Sequence[float], usual: Sequence[float]) -> bool:
    """
    Tell whether a colour is that of a coloured table, but for its level: a thing's seldom is.

    :param level: Mean grey levels, B, G and R.
    :param usual: The table's.
    """
    table = [_LOGS[round(one)] for one in usual]
    grey = [sum(table) / 3] * 3
    return change_of(level, usual)[0] < _ALIKE and math.dist(table, grey) > GREY


def _darkest(changes: Sequence[np.ndarray]) -> float:
    """
    Tell how dark shade may be: below one lamp in a dark room, all umbras have one level.

    A black thing may have it, too, but not where shade that is lighter is nearly as common.
    """
    counts = []
    for change in changes:
        ratio, chroma = LEVEL_SCALE * change[:, 2], np.hypot(change[:, 0], change[:, 1])
        neutral = is_neutral(chroma, ratio)
        is_lit = (ratio > FAINTEST) | ~neutral & (ratio > _DEPTHS[0])
        if np.count_nonzero(is_lit) > _LEAST_LIT * len(change):
            counts.append(np.histogram(ratio[neutral], _DEPTHS)[0] / len(change))
    if len(counts) < _LEAST_UMBRAS:
        return DARKEST
    near = [np.convolve(one, np.ones(3), 'same') for one in counts]
    common = np.sum(near, axis=0)
    dark = _DEPTHS[1:] < DARKEST
    deepest = int(np.argmax(common * dark))
    if common[deepest] < max(_CLEARLY * common[~dark].max(), _LEAST_UMBRA) or sum(
            one[deepest] > _LEAST_IN for one in near) < _LEAST_UMBRAS:
        return DARKEST
    return float(_DEPTHS[deepest] - _BELOW)


def _shade_in(change: np.ndarray, darkest: float) -> Optional[np.ndarray]:
    """Give the shade in a region, shape (n, 3); None without a coloured or black thing in it."""
    ratio = LEVEL_SCALE * change[:, 2]
    is_thing = (np.hypot(change[:, 0], change[:, 1]) > _COLOURED) | (ratio < darkest)
    if np.count_nonzero(is_thing) < _LEAST_THING * len(ratio):
        return None
    return change[~is_thing & (ratio < -_STEP)]


def _tints(
    changes: Sequence[np.ndarray], shades: Sequence[Optional[np.ndarray]], darkest: float
) -> List[np.ndarray]:
    """Give the tints, shape (2, n) each: any beside coloured things, a faint one elsewhere."""
    nothing = np.zeros((0, 3), np.float32)
    shade = np.concatenate([nothing, *(one for one in shades if one is not None)])
    slopes = _slopes(_without_faint(shade), *_BESIDE_COLOURED)
    if not slopes:
        change = np.concatenate([nothing, *changes])
        change = change[(change[:, 2] < _LEAST_SHADE) & (change[:, 2] > darkest / LEVEL_SCALE)]
        slopes = _slopes(change, *_ANYWHERE)
        if slopes and _has_neutral(change):
            # All shade would have the tint: this is the colour of a thing.
            slopes = []
    tints = np.zeros((_BESIDE_COLOURED[2], 2, _LEVELS), np.float32)
    levels = -_STEP / LEVEL_SCALE * (np.arange(_LEVELS) + 0.5)
    for tint, slope in zip(tints, slopes):
        tint[:] = np.outer(slope, levels)
    for number, own in enumerate(_of_a_cut_off_table(shade)):
        if own:
            tints[..., number] = 0
            tints[:len(own), :, number] = own
    return [one for one in tints if one.any()]


def _slopes(change: np.ndarray, *commonest: Any) -> List[np.ndarray]:
    slopes = _commonest(change[:, :2] / change[:, 2:], *commonest)
    # Less than that is no more than any light may change.
    return [one for one in slopes if np.hypot(*one) > _LEAST_TINT]


def _has_neutral(change: np.ndarray) -> bool:
    """Tell whether some of what is darker has less chroma than a tint gives it."""
    neutral = np.hypot(*change.T[:2]) < -_LEAST_TINT * change[:, 2]
    return np.count_nonzero(neutral) > _LEAST_NEUTRAL_SHARE * len(change)


def _of_a_cut_off_table(shade: np.ndarray) -> List[List[np.ndarray]]:
    """
    Give the commonest chroma at each level, if the sensor has cut off the table; else nothing.

    Then faint shade may have the most of it, and no slope tells that.
    """
    numbers = _bin(LEVEL_SCALE * shade[:, 2])
    commonest: List[List[np.ndarray]] = []
    for number in range(_LEVELS):
        if number == _FAINT_LEVELS and not any(
                own and np.hypot(*own[0]) > _LOST_CHROMA for own in commonest):
            return []
        commonest.append(_commonest(shade[np.abs(numbers - number) <= 1, :2], *_AT_A_LEVEL))
    return commonest


def _without_faint(change: np.ndarray) -> np.ndarray:
    return change[LEVEL_SCALE * change[:, 2] < FAINTEST]


def _commonest(
    values: np.ndarray, largest: float, bins: int, most: int, least_common: float
) -> List[np.ndarray]:
    """
    Give the commonest values, shape (2,) each.

    :param values: Shape (n, 2).
    :param largest: The largest that is looked for, on each axis, in so many bins.
    :param most: How many are looked for.
    :param least_common: Which part of the values each must have.
    """
    places = np.floor((values / largest + 1) * (bins / 2)).astype(int)
    places = places[((places >= 0) & (places < bins)).all(axis=1)] @ (bins, 1)
    counts = np.bincount(places, minlength=bins ** 2).reshape(bins, bins).astype(np.float32)
    found: List[np.ndarray] = []
    for _ in range(most):
        near = 9 * cv2.blur(counts, (3, 3))
        if near.max() < max(least_common * len(values), _LEAST_PLACES):
            break
        row, column = np.unravel_index(near.argmax(), near.shape)
        found.append(((np.array([row, column]) + 0.5) / (bins / 2) - 1) * largest)
        counts[max(row - 2, 0):row + 3, max(column - 2, 0):column + 3] = 0
    return found


def _levels(change: np.ndarray, shade: Shade) -> Optional[np.ndarray]:
    """Tell how common each level is in the shade beside a thing; None where that is not seen."""
    change = _without_faint(change)
    ratio = LEVEL_SCALE * change[:, 2]
    off = shade.off_tints([change[:, 0], change[:, 1]], change[:, 2])
    neutral = ratio[is_neutral(np.hypot(*off), ratio)]
    return None if len(neutral) < _LEAST_NEUTRAL else _common(neutral)


def _common(ratios: np.ndarray) -> np.ndarray:
    """Tell how common each level is, shape (n,), by the logarithms of ratios."""
    counts = np.bincount(_bin(ratios), minlength=_LEVELS)
    # A lamp is nearer to some things than to others.
    return np.convolve(counts, np.float32([1, 2, 3, 2, 1]) / 9, 'same') / len(ratios)


def _bin(ratios: np.ndarray) -> np.ndarray:
    return np.minimum(-ratios / _STEP, _LEVELS - 1).astype(int)
