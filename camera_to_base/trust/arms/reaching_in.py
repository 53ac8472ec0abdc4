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

"""What reaches in from the picture's edge: a hand, a sleeve, an arm, and their shadows."""

from typing import NamedTuple

import cv2
import numpy as np

# The picture is made this long at most, in px: a quarter of 640 px.
_LONGEST = 160
# What differs from the background by more than this in one channel is there, in levels at the
# background's light; in a dark frame not less than the second, for it is rounded.
_FAINTEST, _FAINTEST_IN_THE_DARK = 3.0, 2.5
# The same in standard deviations of the noise.
_NOISE_DEVIATIONS = 4.5
# What is left of a shift of the camera that was measured, in px.
_SHIFT_ERROR_PX = 0.3
# Where a change reaches more of the edge than this it may be the light, which changes smoothly.
_EDGE_SHARE = 0.4
# What reaches in everywhere is another view, or other light, and nothing that reaches in.
_WHOLE_EDGE = 0.8
# Rounds of the fit of smooth light, and what counts half in it, in shares of the light.
_ROUNDS, _HALF_WEIGHT = 8, 0.03
_GRID_STEP = 4
# On a surface whose own levels vary by this much, an arm is like it here and there: gaps of up to
# 4 cells are closed there.
_TEXTURE_LEVELS, _CLOSING = 2.0, np.ones((5, 5), np.uint8)
# Of a large picture some pixels are enough: this many along a cell.
_SAMPLES = 4


class Changes(NamedTuple):
    """
    Where a frame differs from the background, in cells of some px.

    :param reaching_in: Shape (h / scale, w / scale), uint8, 1 where something reaches in.
    :param differs: The same, 1 where anything differs.
    :param gain: How much brighter the frame is.
    """

    reaching_in: np.ndarray
    differs: np.ndarray
    gain: float

    @property
    def edge_share(self) -> float:
        """How much of the picture's edge something reaches in from, 0..1."""
        mask = self.reaching_in
        return float(np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]]).mean())


class ReachingIn:
    """
    Finds what differs from the background and is connected to the picture's edge.

    A detector finds strong differences, so that a hand whose brightness is like the table's falls
    apart into islands. A faint difference shows that they belong together.

    :param background: Shape (h, w, 3), uint8, BGR.
    """

    def __init__(self, background: np.ndarray) -> None:
        height, width = background.shape[:2]
        self.scale = max(1, round(max(height, width) / _LONGEST))
        self._size = max(1, width // self.scale), max(1, height // self.scale)
        self._samples = _SAMPLES if self.scale >= _SAMPLES else min(self.scale, 2)
        small = self._small(background)
        self._background = np.maximum(small, 1).astype(np.float32)
        self._range = cv2.morphologyEx(small, cv2.MORPH_GRADIENT, np.ones((3, 3)))
        noise = np.median(np.abs(np.diff(background[::4].astype(np.int16), axis=1)))
        self._is_textured = cv2.dilate(
            (self._range.max(axis=2) > 2 * _TEXTURE_LEVELS).astype(np.uint8), np.ones((3, 3)))
        # Of the mean of a cell; that of a frame and the background's together.
        self._noise = float(noise) / 0.6745 / self._samples
        self._terms = _quadratic_terms(*self._size)

    def find(self, frame: np.ndarray, shift_px: float) -> Changes:
        """
        Find it on a frame of the background's size.

        :param shift_px: How far the view has moved, in px: so much blurs the surface's edges.
        """
        picture = self._small(frame)
        ratio = (picture[::_GRID_STEP, ::_GRID_STEP]
                 / self._background[::_GRID_STEP, ::_GRID_STEP]).reshape(-1, 3)
        gains = np.median(ratio, axis=0).tolist()
        gain = sorted(gains)[1]
        most = self._most(gain, shift_px)
        lit = cv2.multiply(self._background, (*gains, 0.0), dtype=cv2.CV_8U)
        found = self._changes(picture, lit, most, gain)
        if found.edge_share > _EDGE_SHARE:
            lit = cv2.multiply(self._background, self._smooth_light(ratio), dtype=cv2.CV_8U)
            other = self._changes(picture, lit, most, gain)
            found = min(found, other, key=lambda changes: changes.edge_share)
        if found.edge_share <= _WHOLE_EDGE:
            return found
        return found._replace(reaching_in=np.zeros_like(found.reaching_in))

    def _most(self, gain: float, shift_px: float) -> np.ndarray:
        # What the surface itself may differ by; half a level less, as both pictures are rounded.
        least = max(_FAINTEST * min(gain, 1.0), _FAINTEST_IN_THE_DARK,
                    _NOISE_DEVIATIONS * self._noise)
        slack = (shift_px + _SHIFT_ERROR_PX) / self.scale / 2
        return cv2.convertScaleAbs(self._range, alpha=slack, beta=least - 0.5)

    def _changes(self, picture: np.ndarray, lit: np.ndarray, most: np.ndarray,
                 gain: float) -> Changes:
        over = cv2.split(cv2.subtract(cv2.absdiff(picture, lit), most))
        differs = cv2.threshold(
            cv2.max(cv2.max(over[0], over[1]), over[2]), 0, 1, cv2.THRESH_BINARY)[1]
        closed = cv2.morphologyEx(differs, cv2.MORPH_CLOSE, _CLOSING) & self._is_textured
        # Around it is an edge from which all that touches it is filled.
        framed = cv2.copyMakeBorder(
            differs | closed, 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=1)
        cv2.floodFill(framed, None, (0, 0), 2, flags=8)
        return Changes((framed[1:-1, 1:-1] == 2).astype(np.uint8), differs, gain)

    def _smooth_light(self, ratio: np.ndarray) -> np.ndarray:
        grid = self._terms[::_GRID_STEP, ::_GRID_STEP].reshape(-1, self._terms.shape[2])
        weights = np.ones(len(grid))
        for _ in range(_ROUNDS):
            weighted = grid * weights[:, None]
            factors = np.linalg.lstsq(weighted.T @ grid, weighted.T @ ratio, rcond=None)[0]
            missed = np.abs(grid @ factors - ratio).max(axis=1)
            weights = 1 / (1 + (missed / _HALF_WEIGHT) ** 2) ** 2
        return (self._terms @ factors).astype(np.float32)

    def _small(self, picture: np.ndarray) -> np.ndarray:
        # Halving is several times as fast as other ratios.
        samples = self._samples
        while True:
            size = self._size[0] * samples, self._size[1] * samples
            halves = picture.shape[:2] == (2 * size[1], 2 * size[0])
            if picture.shape[1::-1] != size:
                picture = cv2.resize(picture, size, interpolation=(
                    cv2.INTER_AREA if halves else cv2.INTER_NEAREST))
            if samples == 1:
                return picture
            samples //= 2


def _quadratic_terms(width: int, height: int) -> np.ndarray:
    y, x = np.meshgrid(np.linspace(-1, 1, height), np.linspace(-1, 1, width), indexing='ij')
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=2)


def covered_share(mask: np.ndarray, outline: np.ndarray, scale: int) -> float:
    """
    Tell how much of an object overlaps a mask, 0..1.

    :param mask: Shape (h / scale, w / scale), uint8.
    :param outline: Shape (n, 2), int32, columns u and v in px.
    """
    cells = outline // scale
    left, top, width, height = cv2.boundingRect(cells)
    piece = mask[top:top + height, left:left + width]
    if not piece.any():
        return 0.0
    inside = np.zeros(piece.shape, np.uint8)
    cv2.fillPoly(inside, [cells], 1, offset=(-left, -top))
    return cv2.countNonZero(inside & piece) / max(cv2.countNonZero(inside), 1)
