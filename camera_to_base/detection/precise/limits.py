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

"""From which grey levels on a pixel shows something else than the background."""

from typing import NamedTuple

from camera_to_base.detection.precise.light import Gain
import cv2
import numpy as np

# A camera that trembles shows at a place what lies beside it on the background.
_TREMBLE = np.ones((3, 3), np.uint8)
_BLOCK = 32
# Grey levels beyond the background's own range, and deviations of the noise: where an object's
# rim still counts, and what an object must have somewhere.
WEAK_LEVELS, _WEAK_DEVIATIONS, STRONG_DEVIATIONS = 5.0, 4.5, 10.0


class Range(NamedTuple):
    """Darkest and lightest levels that are the background's, each of shape (h, w, 3), uint8."""

    darkest: np.ndarray
    lightest: np.ndarray

    def outside(self, frame: np.ndarray) -> np.ndarray:
        """Find the pixels beyond it in any channel: shape (h, w), uint8, 255 or 0."""
        return cv2.bitwise_not(cv2.inRange(frame, self.darkest, self.lightest))


class Limits:
    """
    The background's own range of levels, at some light and with some noise.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param faintest: Grey levels that an object must at least differ by somewhere.
    """

    def __init__(self, background: np.ndarray, faintest: float) -> None:
        usual = Range(cv2.erode(background, _TREMBLE), cv2.dilate(background, _TREMBLE))
        self._strong, self._weak = _LitRange(usual), _LitRange(usual)
        self._faintest = faintest
        self.least = faintest

    def set_light(self, gain: Gain, noise: np.ndarray) -> None:
        """
        Follow the light and the noise, see :func:`measure_noise`.

        A level that is beyond the strong range differs by more than `least` from the background.
        """
        levels = gain.coded_levels
        noise = np.take_along_axis(noise, np.rint(levels).astype(int), axis=0)
        weak = np.maximum(min(WEAK_LEVELS, self._faintest), _WEAK_DEVIATIONS * noise)
        strong = np.maximum(self._faintest, STRONG_DEVIATIONS * noise)
        self.least = max(float(strong.min()) - 0.01, 0.0)
        self._weak.set_levels(levels - weak, levels + weak)
        self._strong.set_levels(levels - strong, levels + strong)

    def strong(self, part: tuple) -> Range:
        """Give the range that an object must leave somewhere, for a part of the picture."""
        return self._strong.part(part)

    def weak(self, part: tuple) -> Range:
        """Give the range that each pixel of an object leaves, for a part of the picture."""
        return self._weak.part(part)


class _LitRange:
    # A range at the frame's light: made block by block, where it is asked for.

    def __init__(self, usual: Range) -> None:
        self._usual = usual
        self._lit = Range(*(np.empty_like(bound) for bound in usual))
        self._missing = np.ones(
            [-(-length // _BLOCK) for length in usual.darkest.shape[:2]], np.uint8)
        self._tables = np.empty(0), np.empty(0)

    def set_levels(self, darkest: np.ndarray, lightest: np.ndarray) -> None:
        tables = tuple(np.clip(np.rint(levels), 0, 255).astype(np.uint8)[:, None]
                       for levels in (darkest, lightest))
        if not all(map(np.array_equal, tables, self._tables)):
            self._tables = tables
            self._missing[:] = 1

    def part(self, part: tuple) -> Range:
        blocks = tuple([slice(side.start // _BLOCK, -(-side.stop // _BLOCK)) for side in part])
        if cv2.countNonZero(self._missing[blocks]):
            around = tuple(slice(side.start * _BLOCK, side.stop * _BLOCK) for side in blocks)
            for usual, table, lit in zip(self._usual, self._tables, self._lit):
                cv2.LUT(usual[around], table, dst=lit[around])
            self._missing[blocks] = 0
        return Range(self._lit.darkest[part], self._lit.lightest[part])
