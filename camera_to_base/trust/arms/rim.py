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

"""Tells whether an object that was known still lies where it was, though a shadow falls on it."""

from typing import NamedTuple, Tuple

import cv2
import numpy as np

# How far the rim reaches to both sides of the outline, in px.
_RIM_PX = 4
# The rim is compared piece by piece: what covers or replaces a part of it is seen there.
_SECTORS, _LEAST_PIXELS = 8, 12
# Shade takes a part of the light, the same of an object and of the surface beside it: least and
# mean correlation of the sectors, their means, and their contrasts beside their means. An edge of
# a shadow that crosses a sector leaves this much.
_LEAST_CORRELATION, _LEAST_MEAN_CORRELATION = 0.7, 0.85
# As factors of the light and of the contrast at the start, least and most.
_LIGHTS, _CONTRASTS = (0.2, 1.3), (0.6, 1.6)


class Rim(NamedTuple):
    """
    The rim of an object as it looked when it was free.

    :param corner: The window's first column and row in the picture.
    :param picture: Shape (h, w, 3), uint8, BGR, the window.
    :param outline: Shape (n, 2), int32, columns u and v in px of the picture that it is from.
    """

    corner: Tuple[int, int]
    picture: np.ndarray
    outline: np.ndarray

    def is_unchanged(self, frame: np.ndarray, levels: float) -> bool:
        """
        Tell whether a frame shows the same in all of the window.

        :param frame: Shape (h, w, 3), uint8, BGR, of the same size and view.
        :param levels: By how much the noise makes two frames differ, at most.
        """
        return cv2.norm(self.picture, self._window(frame), cv2.NORM_INF) <= levels

    def is_in(self, frame: np.ndarray) -> bool:
        """
        Tell whether all of the rim is on a frame, at the same place, at any light.

        :param frame: Shape (h, w, 3), uint8, BGR, of the same size and view.
        """
        band = self._band()
        before, now = (picture[band].astype(np.float32)
                       for picture in (self.picture, self._window(frame)))
        # An object may have the surface's grey, but not its colour.
        channel = int(np.argmax(before.var(axis=0)))
        return _all_agree(before[:, channel], now[:, channel], self._sectors(band))

    def _window(self, frame: np.ndarray) -> np.ndarray:
        left, top = self.corner
        height, width = self.picture.shape[:2]
        return frame[top:top + height, left:left + width]

    def _band(self) -> np.ndarray:
        left, top = self.corner
        inside = cv2.fillPoly(np.zeros(self.picture.shape[:2], np.uint8), [self.outline], 1,
                              offset=(-left, -top))
        disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * _RIM_PX + 1,) * 2)
        return cv2.morphologyEx(inside, cv2.MORPH_GRADIENT, disc) > 0

    def _sectors(self, band: np.ndarray) -> np.ndarray:
        v, u = np.nonzero(band)
        centre_u, centre_v = self.outline.mean(axis=0) - self.corner
        turn = np.arctan2(v - centre_v, u - centre_u) / (2 * np.pi) + 0.5
        return np.minimum((turn * _SECTORS).astype(int), _SECTORS - 1)


def rim_of(frame: np.ndarray, outline: np.ndarray) -> Rim:
    """
    Keep the rim of an object.

    :param frame: Shape (h, w, 3), uint8, BGR, that shows it without shade.
    :param outline: Shape (n, 2), int32, columns u and v in px.
    """
    left, top, width, height = cv2.boundingRect(outline)
    right, bottom = left + width + 2 * _RIM_PX, top + height + 2 * _RIM_PX
    left, top = max(left - 2 * _RIM_PX, 0), max(top - 2 * _RIM_PX, 0)
    return Rim((left, top), frame[top:bottom, left:right].copy(), outline)


def _all_agree(before: np.ndarray, now: np.ndarray, sectors: np.ndarray) -> bool:
    count = np.bincount(sectors, minlength=_SECTORS)
    is_full = count >= _LEAST_PIXELS
    if not is_full.any():
        return False

    def mean(values: np.ndarray) -> np.ndarray:
        return np.bincount(sectors, values, _SECTORS)[is_full] / count[is_full]

    level, level_now = mean(before), mean(now)
    spread = mean(before * before) - level ** 2
    spread_now = mean(now * now) - level_now ** 2
    common = mean(before * now) - level * level_now
    correlations = common / np.sqrt(np.maximum(spread * spread_now, 1e-6))
    lights = level_now / np.maximum(level, 1.0)
    contrasts = common / np.maximum(spread, 1e-6) / np.maximum(lights, 1e-6)
    return bool(correlations.min() >= _LEAST_CORRELATION
                and correlations.mean() >= _LEAST_MEAN_CORRELATION
                and _lie_within(lights, _LIGHTS) and _lie_within(contrasts, _CONTRASTS))


def _lie_within(values: np.ndarray, limits: Tuple[float, float]) -> bool:
    return bool(limits[0] <= values.min() and values.max() <= limits[1])
