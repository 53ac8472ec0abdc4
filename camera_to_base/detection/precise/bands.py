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
The bands of a lamp that flickers: each row is read at its own moment, and has its own light.

They are taken out of the frame, as exactly as a gain is: whatever follows sees one light.
"""

from typing import Optional

from camera_to_base.detection.precise.light import grey_factors, log_light
import cv2
import numpy as np

_STEP = 4
_ROWS = slice(_STEP // 2, None, _STEP)
# Rows: how far they are apart from one another at least, and from the picture's light at most,
# logarithms; the part of all rows that must tell their light; how much larger they are than what
# a smooth curve leaves of them.
_LEAST_BAND, _STRONGEST_BAND, _LEAST_ROWS = 0.03, 0.45, 0.6
_SMOOTH = 8
# Levels that the sensor has cut off tell no light.
_LIGHTEST, _UNKNOWN = 250, 99.0
# A parabola through seven rows (Savitzky and Golay): it keeps a wave's height.
_PARABOLA = np.float32([-2, 3, 6, 7, 6, 3, -2])[:, None] / 21


def find_bands(frame: np.ndarray, background: np.ndarray) -> Optional[np.ndarray]:
    """
    Find the bands of a lamp that flickers.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :returns: Logarithm of each row's light / the background's, shape (h,), float32; None without
        bands.
    """
    if min(frame.shape[:2]) < 3 * _STEP:
        return None
    thirds = _light_of_thirds(_on_grid(frame), _on_grid(background))
    bands = np.median(thirds, axis=1)
    # A band goes from side to side; an object or a shadow does not. There, the rows beside count.
    is_light = (np.abs(bands) < _STRONGEST_BAND) & (np.ptp(thirds, axis=1) < 2 * _LEAST_BAND)
    if is_light.mean() < _LEAST_ROWS:
        return None
    rows = np.arange(len(bands))
    bands = np.interp(rows, rows[is_light], bands[is_light]).astype(np.float32)
    smooth = cv2.filter2D(bands[:, None], -1, _PARABOLA, borderType=cv2.BORDER_REPLICATE)[:, 0]
    # A camera that trembles over a grain changes rows, too, but not smoothly.
    if np.ptp(smooth) <= max(_LEAST_BAND, _SMOOTH * np.abs(bands - smooth).mean()):
        return None
    return np.interp(np.arange(len(frame)), _STEP * rows + _ROWS.start, smooth).astype(np.float32)


def without_bands(frame: np.ndarray, background: np.ndarray, bands: np.ndarray) -> np.ndarray:
    """
    Give a frame as it looks at one light, see :func:`find_bands`.

    Levels that the sensor has cut off may stand for more light: they look like the background
    where that is possible.
    """
    rows, usual = (picture.reshape(len(frame), -1) for picture in (frame, background))
    factors = np.repeat(grey_factors(-bands)[:, None], rows.shape[1], axis=1)
    even = cv2.multiply(rows, factors, scale=1 / 128)
    cut_off = _above(rows, _LIGHTEST - 1)
    even = cv2.max(even, cv2.min(cut_off, usual))
    even = cv2.min(even, cv2.max(usual, cv2.bitwise_not(_above(usual, _LIGHTEST - 1))))
    return even.reshape(frame.shape)


def _above(levels: np.ndarray, limit: int) -> np.ndarray:
    return cv2.threshold(levels, limit, 255, cv2.THRESH_BINARY)[1]


def _on_grid(picture: np.ndarray) -> np.ndarray:
    # Pixels are copied much faster as one item each than as three bytes.
    return picture.view('V3')[_ROWS, ::_STEP].copy().view(np.uint8)


def _light_of_thirds(frame: np.ndarray, background: np.ndarray) -> np.ndarray:
    """Give the median ratio, logarithm, of each row's thirds: shape (rows, 3)."""
    ratio = log_light(frame) - log_light(background)
    tells_light = cv2.inRange(cv2.max(frame, background), 0, (_LIGHTEST - 1,) * 3)
    ratio[tells_light == 0] = _UNKNOWN
    return np.stack([_median(third) for third in np.array_split(ratio, 3, axis=1)], axis=1)


def _median(ratio: np.ndarray) -> np.ndarray:
    known = (ratio < _UNKNOWN).sum(axis=1, keepdims=True)
    middle = np.minimum(known // 2, ratio.shape[1] - 1)
    return np.take_along_axis(np.sort(ratio, axis=1), middle, axis=1)[:, 0]
