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

"""
Light and shade that come from outside of the picture: a cloud, a person who stands by.

They change a part of the picture that reaches its border, smoothly or with an edge, and by about
one factor for all colours. What is small beside a median filter's window is no such light.
A lamp that flickers makes bands of rows.
"""

from typing import Optional

from camera_to_base.detection.precise.light import LINEAR
from camera_to_base.detection.precise.limits import Range
from camera_to_base.detection.precise.piece import channel_extremes, channel_sum, quantile
import cv2
import numpy as np

_SHRINK, _WINDOW = 4, 25
# Light that differs by less is no reason for a second look; logarithm of the ratio.
_LEAST_CHANGE = 0.03
# Steps per factor e while the ratio is filtered as bytes.
_STEPS = 64
# The median rounds the corners of an edge: beside one, either light counts, in shrunk px.
_EDGE = np.ones((9, 9), np.uint8)
# Grey levels grow with about this power of the light.
_POWER = 1 / 2.2
# Shade takes this much light at most, and colours it little.
_DEEPEST, _BRIGHTEST, _STRONGEST_TINT, _LEAST_SHARE = 0.2, 2.0, 1.25, 0.6
_LEAST_MARKED, _LEAST_LIGHT = 0.1, 1e-3
# Bands of rows: how far they are apart from one another at least, and from the picture's light at
# most, logarithms; the rows of a mean; the part of all rows that must tell their light; how much
# larger they are than what is left.
_LEAST_BAND, _STRONGEST_BAND, _BAND_WINDOW, _LEAST_ROWS = 0.03, 0.25, 5, 0.4
_SMOOTH = 8


def looks_like_light(frame: np.ndarray, background: np.ndarray, mask: np.ndarray) -> bool:
    """
    Tell whether what differs in a part of a frame may be light: of the table's own colours.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :param mask: Shape (h, w), not 0 where they differ.
    """
    step = np.s_[::_SHRINK, ::_SHRINK]
    light, usual = (cv2.LUT(picture[step], LINEAR) for picture in (frame, background))
    smallest, largest = channel_extremes(light / np.maximum(usual, _LEAST_LIGHT))
    tint = largest / np.maximum(smallest, _LEAST_LIGHT)
    marked = (mask[step] > 0) & (np.abs(cv2.log(np.maximum(largest, 1e-3))) > _LEAST_MARKED)
    is_light = (largest > _DEEPEST) & (largest < _BRIGHTEST) & (tint < _STRONGEST_TINT)
    return np.count_nonzero(is_light & marked) > _LEAST_SHARE * np.count_nonzero(marked)


def find_bands(frame: np.ndarray, background: np.ndarray) -> Optional[np.ndarray]:
    """
    Find the bands of a lamp that flickers: each row is read at its own moment, and its own light.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :returns: Logarithm of the light's factor, shape (h / 4, 1), float32; None without bands.
    """
    step = np.s_[::_SHRINK, ::_SHRINK]
    ratio = _log_ratio(frame[step], background[step])
    thirds = np.array([quantile(part.T) for part in np.array_split(ratio, 3, axis=1)])
    bands = quantile(thirds)
    # A band goes from side to side; an object or a shadow does not. There, the rows beside count.
    is_light = (np.abs(bands) < _STRONGEST_BAND) & (np.ptp(thirds, axis=0) < 2 * _LEAST_BAND)
    if is_light.mean() < _LEAST_ROWS:
        return None
    rows = np.arange(len(bands))
    bands = np.interp(rows, rows[is_light], bands[is_light])
    bands = bands.astype(np.float32)[:, None]
    smooth = cv2.blur(cv2.blur(bands, (1, _BAND_WINDOW)), (1, _BAND_WINDOW))
    # A camera that trembles over a grain changes rows, too, but not smoothly.
    is_smooth = np.ptp(smooth) > max(_LEAST_BAND, _SMOOTH * np.abs(bands - smooth).mean())
    return smooth[:max(frame.shape[0] // _SHRINK, 1)] if is_smooth else None


def find_field(
    frame: np.ndarray, background: np.ndarray, bands: Optional[np.ndarray] = None
) -> Optional[Range]:
    """
    Find light that comes from outside of the picture.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :param bands: See :func:`find_bands`; they are a part of the result.
    :returns: Factors on the background's grey levels, times 128; None where there is none.
    """
    bands = np.float32(0) if bands is None else bands
    field = _smooth_ratio(frame, background, bands)
    field[~_reaches_border(np.abs(field) > _LEAST_CHANGE)] = 0
    if not field.any() and not np.any(bands):
        return None
    size = frame.shape[1], frame.shape[0]
    return Range(_factors(cv2.erode(field, _EDGE) + bands, size),
                 _factors(cv2.dilate(field, _EDGE) + bands, size))


def field_of_bands(bands: np.ndarray, frame: np.ndarray) -> Range:
    """Give the field of bands alone, see :func:`find_bands`."""
    factors = _factors(bands, (1, frame.shape[0]))
    factors = np.ascontiguousarray(np.broadcast_to(factors, frame.shape))
    return Range(factors, factors)


def _log_ratio(frame: np.ndarray, background: np.ndarray) -> np.ndarray:
    light, usual = (np.maximum(channel_sum(cv2.LUT(picture, LINEAR)), _LEAST_LIGHT)
                    for picture in (frame, background))
    return cv2.log(light / usual)


def _smooth_ratio(
    frame: np.ndarray, background: np.ndarray, bands: np.ndarray
) -> np.ndarray:
    ratio = _log_ratio(_shrunk(frame), _shrunk(background)) - bands
    steps = np.clip(np.rint(128 + _STEPS * ratio), 0, 255).astype(np.uint8)
    return (cv2.medianBlur(steps, _WINDOW).astype(np.float32) - 128) / _STEPS


def _shrunk(picture: np.ndarray) -> np.ndarray:
    # Halving twice is three times as fast as one step, where it gives the same.
    height, width = picture.shape[:2]
    sizes = [(max(width // _SHRINK, 1), max(height // _SHRINK, 1))]
    if not height % _SHRINK and not width % _SHRINK:
        sizes.insert(0, (width // 2, height // 2))
    for size in sizes:
        picture = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    return picture


def _reaches_border(changed: np.ndarray) -> np.ndarray:
    _, labels = cv2.connectedComponents(changed.astype(np.uint8))
    border = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    return np.isin(labels, np.unique(border[border > 0]))


def _factors(field: np.ndarray, size: tuple) -> np.ndarray:
    factors = np.clip(np.rint(128 * np.exp(_POWER * field)), 1, 255).astype(np.uint8)
    return cv2.merge([cv2.resize(factors, size, interpolation=cv2.INTER_LINEAR)] * 3)
