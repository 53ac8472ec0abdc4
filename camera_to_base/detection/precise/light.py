# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The light of a frame: the curve of its levels, and its gain over the background's."""

from functools import lru_cache
import math
import operator
from typing import NamedTuple, Optional

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
