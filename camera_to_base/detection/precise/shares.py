# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Places an object by how much of each pixel it covers.

A pixel on the rim shows `share * object + (1 - share) * table`, in linear light. The table's light
is taken from just outside of the rim, where a shadow may lie, and the object's colour from just
inside; the share follows by projection, from all three colours. The pixels of which more than half
is covered make the next, better mask: three turns are enough.

The shade of a flat thing is too narrow for that: a pixel in it is off all such mixtures, and is
one of both colours in less light. The thing's wall has that light, too, so the share follows from
the mixture's colour alone.
"""

import math
from typing import Dict, NamedTuple, Optional, Tuple

from camera_to_base.detection.precise.gloss import complete_shares, find_highlight
from camera_to_base.detection.precise.light import LEAST_LIGHT
from camera_to_base.detection.precise.piece import (
    channel_sum, chosen, disc, Piece, quantile, square)
from camera_to_base.detection.precise.shade import DARKEST
import cv2
import numpy as np

# Turns at most, and which part of an object may still change in the last one.
_TURNS, _SETTLED = 3, 0.005
# Where less than this part of a right mask is left, its colours have misled.
_LEAST_KEPT = 0.9
# How far a shadow's light changes on the way from where it is seen to the rim, at most; and
# which part of that way is still to go.
_STEEPEST = 0.3
_CORE_WINDOW, _TABLE_WINDOW, _WIDER_WINDOW = 5, 7, 15
_WIDER, _ANYWHERE = 1e-3, 1e-7
_LEAST_POWER = 1e-4
# A rim with less contrast than this part of the usual tells no share.
_LEAST_CONTRAST, _OTHER_COLOUR = 0.03, 0.05
# A rim whose colour is of a texture: the variance of its colour, times this, reaches the contrast.
_TEXTURED = 4.0
_BRIGHTEST_RATIO = 4.0
# A lighter part of a dark object has a negative share of its usual colour.
_LIGHTER = -0.15
_LEAST_CORE = 6
# How much nearer to a mixture in less light a pixel of a narrow shade is: the square of the light,
# as a part of its own, and by noise. From which angle on the colours tell that, its sine squared.
_NEARER, _NOISE, _OTHER_CHROMA = 0.005, 1e-4, 0.01
# How much the colour of most of a thing of one colour varies, beside its contrast.
_ONE_COLOUR, _MOSTLY = 0.15, 0.85


class Placed(NamedTuple):
    """
    An object in its piece.

    :param shares: How much of each pixel it covers, shape (h, w), float32.
    :param mask: The pixels of which it covers more than half, without holes, uint8.
    :param outline: The mask's outline, shape (n, 1, 2), int32, in px of the picture; None if it is
        not known yet.
    """

    shares: np.ndarray
    mask: np.ndarray
    outline: Optional[np.ndarray] = None

    def moments(self, left: int, top: int) -> Dict[str, float]:
        """Give the moments of what is covered, as cv2.moments, in px of the picture."""
        moments = cv2.moments(self.shares)
        moments['m10'] += left * moments['m00']
        moments['m01'] += top * moments['m00']
        return moments


def place(piece: Piece) -> Placed:
    """Place a region's object."""
    highlight = find_highlight(piece)
    placed, _ = _turns(piece, _of_highlight(highlight, piece.mask))
    if highlight is None:
        return placed
    return placed._replace(shares=complete_shares(placed.shares, piece.mask, highlight))


def place_thing(
    piece: Piece, others: Optional[np.ndarray] = None, is_settled: bool = False
) -> Tuple[Placed, np.ndarray]:
    """
    Place a thing whose mask is right to a pixel.

    :param others: The things near it, shape (h, w), uint8, 1 inside: no table is seen there.
    :param is_settled: Whether the mask is one that a last turn began with: there is one turn then.
    :returns: Its place, and the mask that the last turn began with, which is empty where one turn
        from there would not end in the same place. The place's own mask has two parts where a gap
        shows that these are two things.
    """
    known = _of_highlight(find_highlight(piece), piece.mask)
    placed, last = _turns(piece, known, others, is_settled)
    least = _LEAST_KEPT * cv2.countNonZero(piece.mask)
    if cv2.countNonZero(placed.mask) > least or _is_of_one_colour(piece):
        return placed, last
    # The rim of a rod is far from its colour farther inside, so that each turn cuts more off.
    placed, _ = _turns(piece, known | cv2.erode(piece.mask, square(5)), others)
    return placed, np.zeros_like(piece.mask)


def _of_highlight(highlight: Optional[np.ndarray], mask: np.ndarray) -> np.ndarray:
    """Give what is the object's for sure because a highlight is near: its light is no table's."""
    return (np.zeros_like(mask) if highlight is None
            else highlight & cv2.erode(mask, square(3)))


def _turns(
    piece: Piece, known: np.ndarray, others: Optional[np.ndarray] = None,
    is_settled: bool = False,
) -> Tuple[Placed, np.ndarray]:
    """Place an object turn by turn; `known` is surely its, shape (h, w), uint8, 1 there."""
    values, mask = _values(piece, _ratio(piece)), piece.mask
    sure = square(5 if _is_of_one_colour(piece) else 3)
    for _ in range(1 if is_settled else _TURNS):
        shares = _shares(values, mask, cv2.erode(mask, sure) | known, others)
        if others is not None:
            shares *= 1 - others
        before, mask = mask, (shares > 0.5).view(np.uint8)
        if cv2.countNonZero(mask ^ before) <= _SETTLED * cv2.countNonZero(mask):
            break
    return Placed(shares, mask), before


def _is_of_one_colour(piece: Piece) -> bool:
    """Tell whether a thing has one colour: then its shares are right farther from its rim, too."""
    core = cv2.erode(piece.mask, square(5))
    if cv2.countNonZero(core) < _LEAST_CORE:
        return False
    levels = chosen(piece.frame, core)
    usual = quantile(levels)
    off = np.linalg.norm(levels - usual, axis=1)
    contrast = float(np.linalg.norm(usual - cv2.mean(piece.table, core)[:3]))
    return float(quantile(off, _MOSTLY)) < _ONE_COLOUR * contrast


def _ratio(piece: Piece) -> np.ndarray:
    return np.minimum(piece.frame / np.maximum(piece.table, LEAST_LIGHT), _BRIGHTEST_RATIO)


class _Values(NamedTuple):
    """
    What is seen in a piece, float32.

    :param frame: Its light, shape (h, w, 3).
    :param table: The table's, of the same shape.
    :param colours: The frame's light, with a channel of ones, shape (h, w, 4).
    :param powers: The sum of its squares, in the same way, shape (h, w, 2).
    :param ratios: The frame's light / the table's, in the same way, shape (h, w, 4).
    """

    frame: np.ndarray
    table: np.ndarray
    colours: np.ndarray
    powers: np.ndarray
    ratios: np.ndarray


def _values(piece: Piece, ratio: np.ndarray) -> _Values:
    colours, ratios = (cv2.cvtColor(values, cv2.COLOR_BGR2BGRA)
                       for values in (piece.frame, ratio))
    powers = cv2.merge([channel_sum(piece.frame ** 2), np.ones_like(colours[..., 3])])
    return _Values(piece.frame, piece.table, colours, powers, ratios)


def _shares(
    values: _Values, mask: np.ndarray, sure: np.ndarray, others: Optional[np.ndarray] = None
) -> np.ndarray:
    """
    Give the shares, shape (h, w), float32.

    :param sure: What the object surely covers; only the others are computed.
    """
    rim = np.flatnonzero(cv2.dilate(mask, square(3)) > sure)
    shares = sure.astype(np.float32)
    if len(rim):
        shares.ravel()[rim] = _shares_at(
            rim, values, mask, mask if others is None else mask | others)
    return shares


def _shares_at(
    rim: np.ndarray, values: _Values, mask: np.ndarray, covered: np.ndarray
) -> np.ndarray:
    """Give the shares at some places of a piece, by their indices: colours are of shape (3, n)."""
    core = _core(mask)
    frame = _at(rim, values.frame)
    table = _at(rim, values.table) * _light_at_rim(rim, values.ratios, covered)
    usual = quantile(chosen(values.frame, core))[:, None]
    usual_contrast = table - usual
    usual_power = _dot(usual_contrast, usual_contrast)
    # A part of another colour counts with its own, small differences are noise.
    near = _continued(rim, values.colours, core, _CORE_WINDOW)
    spread = _continued(rim, values.powers, core, _CORE_WINDOW)[0] - _dot(near, near)
    other = near - usual
    is_other = _dot(other, other) > _OTHER_COLOUR * usual_power
    contrast = np.where(is_other, table - near, usual_contrast)
    power = _dot(contrast, contrast)
    away = table - frame
    is_in_mask = mask.ravel()[rim] > 0
    least = _LEAST_POWER
    if is_in_mask.any():
        least += _LEAST_CONTRAST * float(quantile(power[is_in_mask]))
    shares = np.where(
        power < least, is_in_mask, _dot(away, contrast) / np.maximum(power, 1e-9))
    # Of a texture, the rim happens to look like the table: its usual colour tells more. The dark
    # face of a box has one colour, and that is the rim's.
    by_usual = _dot(away, usual_contrast) / np.maximum(usual_power, 1e-9)
    is_texture = (power < np.minimum(usual_power, _TEXTURED * spread)) & (by_usual > _LIGHTER)
    shares = np.clip(np.where(is_texture, by_usual, shares), 0, 1)
    return _in_own_shade(frame, table - contrast, table, shares)


def _in_own_shade(
    frame: np.ndarray, thing: np.ndarray, table: np.ndarray, shares: np.ndarray
) -> np.ndarray:
    """Give shares, shape (n,), with those where both colours have less light: each (3, n)."""
    own, others, both = _dot(thing, thing), _dot(table, table), _dot(thing, table)
    by_thing, by_table = _dot(frame, thing), _dot(frame, table)
    # Least squares, with any two amounts of the colours.
    scale = np.maximum(own * others - both ** 2, 1e-9)
    of_thing = np.maximum(by_thing * others - by_table * both, 0) / scale
    of_table = np.maximum(by_table * own - by_thing * both, 0) / scale
    light = of_thing + of_table
    off, off_shade = (_dot(one, one) for one in (
        frame - shares * thing - (1 - shares) * table,
        frame - of_thing * thing - of_table * table))
    is_shade = ((off - off_shade > _NEARER * _dot(frame, frame) + _NOISE)
                & (light > math.exp(DARKEST)) & (light < 1)
                & (scale > _OTHER_CHROMA * own * others))
    return np.where(is_shade, of_thing / np.maximum(light, LEAST_LIGHT), shares)


def _core(mask: np.ndarray) -> np.ndarray:
    cores = (cv2.erode(mask, square(size)) for size in (5, 3))
    return next((core for core in cores if cv2.countNonZero(core) >= _LEAST_CORE), mask)


def _light_at_rim(rim: np.ndarray, ratios: np.ndarray, mask: np.ndarray) -> np.ndarray:
    # Seen 2 px outside of the rim and 4 px: what changes in between goes on towards the rim.
    covered = cv2.dilate(mask, disc(5))
    near, farther = 1 - covered, 1 - cv2.dilate(covered, disc(5))
    if not near.any():
        return np.ones((3, len(rim)), np.float32)
    light = _continued(rim, ratios, near, _TABLE_WINDOW)
    if not farther.any():
        return light
    beyond = np.maximum(_continued(rim, ratios, farther, _TABLE_WINDOW), LEAST_LIGHT)
    # The square root: half of the change, as the way to the rim is half as long.
    return light * np.sqrt(np.clip(light / beyond, 1 - _STEEPEST, 1 + _STEEPEST))


def _continued(
    rim: np.ndarray, values: np.ndarray, known: np.ndarray, window: int
) -> np.ndarray:
    """
    Continue values to some places by their mean over a window, over a wider one, or over all.

    :param values: Its last channel is 1 and counts the known pixels.
    """
    weighted = cv2.copyTo(values, known)
    total = _at(rim, cv2.blur(weighted, (window, window)))
    if not total[-1].all():
        anywhere = np.float32(cv2.mean(values, known)[:values.shape[-1]])
        wider = _at(rim, cv2.blur(weighted, (_WIDER_WINDOW, _WIDER_WINDOW)))
        total += np.float32(_WIDER) * wider + _ANYWHERE * anywhere[:, None]
    return total[:-1] / total[-1]


def _at(places: np.ndarray, values: np.ndarray) -> np.ndarray:
    # Long rows are faster than short ones.
    return values.reshape(-1, values.shape[-1]).take(places, axis=0).T.copy()


def _dot(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return (one * other).sum(axis=0)
