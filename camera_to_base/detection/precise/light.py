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

"""The camera's curve, and the light of a frame beside the background's."""

import math
from typing import NamedTuple, Tuple

import numpy as np

# The gain is rounded to this many steps per factor e: the limits are seldom made anew.
_STEPS = 100
_POINTS_PER_SIDE = 24
# Darker levels are mostly noise, lighter ones may be cut off.
_DARKEST, _LIGHTEST = 8, 247
_LEAST_LIGHT = 1e-3
_DARKEST_GAIN = 0.06


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
        return LINEAR[:, None, None] * self.factors

    @property
    def coded_levels(self) -> np.ndarray:
        """Grey levels that the background's levels have at this gain, shape (256, 3)."""
        return _coded(self.linear_levels[:, 0])


NO_GAIN = Gain(0, 0, 0)


class GainMeter:
    """
    Measures a frame's gain: the median of frame / background over a coarse grid.

    It is that of the surface as long as objects cover less than half of it.

    :param background: Shape (h, w, 3), uint8, BGR.
    """

    def __init__(self, background: np.ndarray) -> None:
        self._places = np.stack([_usable_places(background, channel) for channel in range(3)])
        light = LINEAR[background.reshape(-1)[self._places]]
        self._inverse = 1 / np.maximum(light, _LEAST_LIGHT)

    def measure(self, frame: np.ndarray) -> Gain:
        """Measure the gain of a frame of the background's shape."""
        ratios = LINEAR[frame.reshape(-1)[self._places]] * self._inverse
        middle = ratios.shape[1] // 2
        ratios.partition(middle, axis=1)
        medians = ratios[:, middle].tolist()
        if min(medians) < _DARKEST_GAIN:
            # The surface cannot be seen: all of it is covered, or it is dark.
            return NO_GAIN
        return Gain(*(round(_STEPS * math.log(median)) for median in medians))


def _usable_places(background: np.ndarray, channel: int) -> np.ndarray:
    height, width = background.shape[:2]
    rows, columns = (_grid(length) for length in (height, width))
    places = ((rows[:, None] * width + columns) * 3 + channel).ravel()
    levels = background.reshape(-1)[places]
    usable = places[(levels >= _DARKEST) & (levels <= _LIGHTEST)]
    # All channels have as many places, so that one array holds them.
    return np.resize(usable, len(places)) if len(usable) > len(places) // 12 else places


def _grid(length: int) -> np.ndarray:
    step = max(length // _POINTS_PER_SIDE, 1)
    return np.arange(step // 2, length, step)


def ratio_and_tint(light: np.ndarray, other: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """
    Compare two pictures in linear light.

    :param light: Shape (..., 3).
    :param other: Of the same shape.
    :returns: The largest ratio of a channel, and largest / smallest ratio: 1 where only the
        brightness differs; shape (...).
    """
    ratio = light / np.maximum(other, _LEAST_LIGHT)
    largest = ratio.max(axis=-1)
    return largest, largest / np.maximum(ratio.min(axis=-1), _LEAST_LIGHT)
