# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What an object's rim tells: whether it still lies there, and whether it is another's remains."""

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

# Width of the rim on which edges are compared, in px, and how far one reaches into it.
_OUTER_RIM_PX, _EDGE = 3, np.ones((5, 5), np.uint8)
_RIM = np.ones((_OUTER_RIM_PX, _OUTER_RIM_PX), np.uint8)
# An edge of the background is strong from this part of the rim's strongest edges on, and lost
# where the frame has less than that part of it.
_STRONG, _LOST = 0.5, 0.4
# The least strength, in levels, and how much of the rim such edges are.
_LEAST_LEVELS, _LEAST_SHARE = 12.0, 0.12
# From this level on a picture saturates.
_SATURATED = 250
# An edge runs along the outline: the square of the cosine between their normals.
_LEAST_ALONG = 0.5


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


class LeftBehind:
    """
    Finds outlines along which the background has an edge and the frame has none.

    Where an object of the background has moved by less than its width, its old and its new place
    make up one region. An object that is there has an edge all around it.

    :param background: Shape (h, w, 3), uint8, BGR.
    """

    def __init__(self, background: np.ndarray) -> None:
        self._picture, self._edges = background, _edges(background)

    def is_part_of(self, frame: np.ndarray, outline: np.ndarray, gain: float) -> bool:
        """
        Tell whether an outline is partly that of an object which has left.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param outline: Shape (n, 2), int32, columns u and v in px.
        :param gain: How much brighter the frame is than the background.
        """
        left, top, width, height = cv2.boundingRect(outline)
        left, top = max(left - _OUTER_RIM_PX, 0), max(top - _OUTER_RIM_PX, 0)
        window = np.s_[top:top + height + 2 * _OUTER_RIM_PX, left:left + width + 2 * _OUTER_RIM_PX]
        before = self._edges[window]
        if cv2.norm(before, cv2.NORM_INF) * gain < _LEAST_LEVELS:
            return False
        before = cv2.convertScaleAbs(before, alpha=gain)
        rim = _rim(outline, left, top, before)
        clear = cv2.bitwise_and(
            rim, cv2.threshold(before, _LEAST_LEVELS, 1, cv2.THRESH_BINARY)[1])
        least = _LEAST_SHARE * cv2.countNonZero(rim)
        if cv2.countNonZero(clear) < least:
            return False
        now = _edges(frame[window])
        # Hardly any object gets farther than this: a little more than what is lost.
        faint = cv2.compare(now, cv2.convertScaleAbs(before, alpha=_LOST, beta=0.5), cv2.CMP_LT)
        if cv2.countNonZero(cv2.bitwise_and(clear, faint)) < least:
            return False
        # Where the picture saturates, it has no edges.
        rim = rim.view(bool) & (cv2.dilate(frame[window].max(axis=2), _EDGE) < _SATURATED)
        if not rim.any():
            return False
        before, now = before[rim], now[rim]
        strong = max(_STRONG * _upper_tenth(np.maximum(before, now)), _LEAST_LEVELS)
        is_lost = (before > strong) & (now < _LOST * before)
        if np.count_nonzero(is_lost) < least:
            return False
        # A line that is printed on the surface, and goes on below an object, crosses its rim.
        is_along = _runs_along(self._picture[window], outline - (left, top))[rim]
        return np.count_nonzero(is_lost & is_along) >= least


def _rim(outline: np.ndarray, left: int, top: int, window: np.ndarray) -> np.ndarray:
    rim = np.zeros(window.shape[:2], np.uint8)
    # To draw a line of the rim's width takes three times as long.
    cv2.drawContours(rim, [outline], 0, 1, offset=(-left, -top))
    return cv2.dilate(rim, _RIM)


def _runs_along(picture: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Tell where the edges of a picture have an outline's direction: shape (h, w), bool."""
    inside = cv2.fillPoly(np.zeros(picture.shape[:2], np.float32), [outline], 1.0)
    smooth = cv2.GaussianBlur(inside, (0, 0), _OUTER_RIM_PX)
    across, down = (cv2.Sobel(smooth, cv2.CV_32F, *way) for way in ((1, 0), (0, 1)))
    u, v = (cv2.Sobel(picture, cv2.CV_32F, *way) for way in ((1, 0), (0, 1)))
    steep = (u ** 2 + v ** 2).sum(axis=2) * (across ** 2 + down ** 2)
    normal = (u * across[..., None] + v * down[..., None]) ** 2
    return normal.sum(axis=2) > _LEAST_ALONG * steep


def _upper_tenth(levels: np.ndarray) -> float:
    place = int(0.9 * (levels.size - 1))
    return float(np.partition(levels, place)[place])


def _edges(picture: np.ndarray) -> np.ndarray:
    edges = cv2.split(cv2.morphologyEx(picture, cv2.MORPH_GRADIENT, _EDGE))
    return cv2.max(cv2.max(edges[0], edges[1]), edges[2])
