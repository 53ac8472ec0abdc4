# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Other light than the background's: lobes of a lamp, bands of one that flickers, foreign shade.

All of these change the picture by about one factor for all colours. A lobe, a cloud or a soft
shadow does so smoothly, wherever it comes from; a foreign shade has an edge and reaches the
picture's border. What is small beside a median filter's window is no such light.

They are taken out of the frame, as exactly as a gain is: whatever follows sees one light.
"""

from typing import NamedTuple, Optional, Sequence

from camera_to_base.detection.detection import Box, NoObject, Pixel
from camera_to_base.detection.precise.light import (
    grey_factors, LEAST_LIGHT, LINEAR, log_light, POWER)
from camera_to_base.detection.precise.piece import (
    channel_extremes, padded, ratio_of, shrunk, slices, square)
from camera_to_base.detection.precise.reference import Range
from camera_to_base.detection.precise.shade import like_light
import cv2
import numpy as np

_SHRINK, _WINDOW = 4, 25
# Light that differs by less is no reason for a second look; logarithm of the ratio.
_LEAST_CHANGE = 0.03
# Steps per factor e while the ratio is filtered as bytes.
_STEPS = 64
# The median rounds the corners of an edge: beside one, either light counts, in shrunk px.
_EDGE = np.ones((9, 9), np.uint8)
# The brightest sun, by the table's light; which part of what differs must be like light.
_BRIGHTEST, _LEAST_SHARE = 2.0, 0.6
_LEAST_MARKED = 0.1
# Smooth light changes by less per shrunk px; logarithm: the edge of the faintest thing is steeper.
_STEEPEST = 0.05
# The mean that tells it exactly, in shrunk px: of what is off the median by less than a thing is,
# where this part of the window is such.
_MEAN, _NO_THING, _LEAST_KNOWN = (9, 9), 0.15, 0.2
# Light of a field that changes an object's place, in steps of a factor.
_LEAST_STEPS = 4

_STEP = 4
_ROWS = slice(_STEP // 2, None, _STEP)
# Rows: how far they are apart from one another at least (to both sides, less is below the weak
# limit on a grey of 120 levels), from the picture's light at most, and from side to side, all
# logarithms; the part of all rows that must tell their light.
_LEAST_BAND, _STRONGEST_BAND, _LEVEL, _LEAST_ROWS = 0.1, 0.45, 0.06, 0.6
# Levels that the sensor has cut off tell no light.
_LIGHTEST, _UNKNOWN = 250, 99.0
# A parabola through seven rows (Savitzky and Golay): it keeps a wave's height.
_PARABOLA = np.float32([-2, 3, 6, 7, 6, 3, -2])[:, None] / 21


def thinned(box: Box) -> tuple:
    """Give every fourth row and column of a box: light is seen there as well."""
    return tuple(slice(one.start, one.stop, _SHRINK) for one in slices(box))


def looks_like_light(frame: np.ndarray, background: np.ndarray, mask: np.ndarray) -> bool:
    """
    Tell whether what differs in a part of a frame may be light: of the table's own colours.

    :param frame: Shape (h, w, 3), uint8, BGR, see :func:`thinned`.
    :param background: Of the same shape, at the frame's light.
    :param mask: Shape (h, w), not 0 where they differ.
    """
    light, usual = (cv2.LUT(picture, LINEAR) for picture in (frame, background))
    ratio = ratio_of(light, usual)
    largest = channel_extremes(ratio)[1]
    marked = (mask > 0) & (np.abs(cv2.log(np.maximum(largest, LEAST_LIGHT))) > _LEAST_MARKED)
    is_light = like_light(ratio, _BRIGHTEST) & marked
    return np.count_nonzero(is_light) > _LEAST_SHARE * np.count_nonzero(marked)


def in_usual_light(
    frame: np.ndarray, background: np.ndarray, field: Range
) -> np.ndarray:
    """
    Give a frame as it looks without light that comes from outside of the picture.

    :param field: See :func:`find_field`. Where either of two lights may count, a pixel that looks
        like the background in one between these does so in the result.
    """
    height, width = field.darkest.shape
    factors = [cv2.resize(one, (_SHRINK * width, _SHRINK * height))[
        :frame.shape[0], :frame.shape[1]] for one in field]
    x, y, width, height = cv2.boundingRect(
        ((factors[0] != 128) | (factors[1] != 128)).view(np.uint8))
    near = np.s_[y:y + height, x:x + width]
    darkest, lightest = (cv2.cvtColor(one[near], cv2.COLOR_GRAY2BGR) for one in factors)
    usual = frame.copy()
    usual[near] = cv2.max(cv2.divide(frame[near], lightest, scale=128),
                          cv2.min(cv2.divide(frame[near], darkest, scale=128), background[near]))
    return usual


class Even(NamedTuple):
    """
    A frame as it looks at one light.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param light: What was taken out and could be taken for an object.
    """

    frame: np.ndarray
    light: Sequence[NoObject]


def without_smooth_light(frame: np.ndarray, background: np.ndarray) -> Optional[Even]:
    """
    Give a frame as it looks without light that changes smoothly, wherever that comes from.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :returns: None where there is no such light.
    """
    ratio = log_light(_shrunk(frame)) - log_light(_shrunk(background))
    rough = _median_around(ratio)
    labels = cv2.connectedComponents((np.abs(rough) > _LEAST_CHANGE).view(np.uint8))[1]
    # A thing that is larger than the median's window has edges.
    steep = cv2.morphologyEx(rough, cv2.MORPH_GRADIENT, square(3)) > 2 * _STEEPEST
    is_smooth = (labels > 0) & ~np.isin(labels, labels[steep])
    if not is_smooth.any():
        return None
    # The median is too flat where light is the strongest.
    known = cv2.erode((np.abs(ratio - rough) < _NO_THING).astype(np.float32), square(3))
    share = cv2.blur(known, _MEAN)
    mean = cv2.blur(ratio * known, _MEAN) / np.maximum(share, _LEAST_KNOWN)
    level = np.where(share > _LEAST_KNOWN, mean, rough)
    light = [_as_no_object(labels == label, level)
             for label in np.unique(labels[is_smooth & (np.abs(level) > _LEAST_MARKED)])]
    level[cv2.dilate(is_smooth.view(np.uint8), square(3)) == 0] = 0
    x, y, width, height = (_SHRINK * one for one in cv2.boundingRect((level != 0).view(np.uint8)))
    near = np.s_[y:y + height, x:x + width]
    factors = cv2.resize(cv2.exp(-POWER * level), None, fx=_SHRINK, fy=_SHRINK)
    factors = factors[:frame.shape[0], :frame.shape[1]][near]
    even = frame.copy()
    even[near] = _scaled(
        frame[near], background[near], cv2.cvtColor(factors, cv2.COLOR_GRAY2BGR))
    return Even(even, light)


def _as_no_object(inside: np.ndarray, level: np.ndarray) -> NoObject:
    kind = 'light' if level[inside].mean() > 0 else 'shade'
    v, u = (_SHRINK * float(axis.mean()) for axis in np.nonzero(inside))
    return NoObject(kind, Pixel(u, v), float(_SHRINK ** 2 * np.count_nonzero(inside)))


def find_field(frame: np.ndarray, background: np.ndarray) -> Optional[Range]:
    """
    Find light that comes from outside of the picture.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :returns: Factors on the background's grey levels, times 128, each of shape (h / 4, w / 4),
        rounded up; None where there is none.
    """
    field = _median_around(log_light(_shrunk(frame)) - log_light(_shrunk(background)))
    field[~_reaches_border(np.abs(field) > _LEAST_CHANGE)] = 0
    if not field.any():
        return None
    return Range(grey_factors(cv2.erode(field, _EDGE)), grey_factors(cv2.dilate(field, _EDGE)))


def has_light(field: Range, box: Box) -> bool:
    """Tell whether a field changes what is seen in a part of the picture."""
    left, top = box.x // _SHRINK, box.y // _SHRINK
    right, bottom = -(-(box.x + box.width) // _SHRINK), -(-(box.y + box.height) // _SHRINK)
    part = np.s_[top:bottom, left:right]
    return (field.darkest[part].min() < 128 - _LEAST_STEPS
            or field.lightest[part].max() > 128 + _LEAST_STEPS)


def _median_around(ratio: np.ndarray) -> np.ndarray:
    steps = np.clip(np.rint(128 + _STEPS * ratio), 0, 255).astype(np.uint8)
    return (cv2.medianBlur(steps, _WINDOW).astype(np.float32) - 128) / _STEPS


def _shrunk(picture: np.ndarray) -> np.ndarray:
    # Halving twice is faster than one step.
    return shrunk(shrunk(padded(picture, _SHRINK), 2), 2)


def _reaches_border(changed: np.ndarray) -> np.ndarray:
    _, labels = cv2.connectedComponents(changed.astype(np.uint8))
    border = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    return np.isin(labels, np.unique(border[border > 0]))


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
    is_light = (np.abs(bands) < _STRONGEST_BAND) & (np.ptp(thirds, axis=1) < _LEVEL)
    if is_light.mean() < _LEAST_ROWS:
        return None
    rows = np.arange(len(bands))
    bands = np.interp(rows, rows[is_light], bands[is_light]).astype(np.float32)
    smooth = cv2.filter2D(bands[:, None], -1, _PARABOLA, borderType=cv2.BORDER_REPLICATE)[:, 0]
    if np.ptp(smooth) <= _LEAST_BAND:
        return None
    return np.interp(np.arange(len(frame)), _STEP * rows + _ROWS.start, smooth).astype(np.float32)


def without_bands(frame: np.ndarray, background: np.ndarray, bands: np.ndarray) -> np.ndarray:
    """Give a frame as it looks without its bands, see :func:`find_bands`."""
    rows, usual = (picture.reshape(len(frame), -1) for picture in (frame, background))
    factors = np.repeat(grey_factors(-bands)[:, None], rows.shape[1], axis=1)
    return _scaled(rows, usual, factors, 1 / 128).reshape(frame.shape)


def _scaled(
    frame: np.ndarray, background: np.ndarray, factors: np.ndarray, scale: float = 1
) -> np.ndarray:
    # Levels that the sensor has cut off may stand for more light: they look like the background
    # where that is possible.
    even = cv2.multiply(frame, factors, scale=scale, dtype=cv2.CV_8U)
    even = cv2.max(even, cv2.min(_above(frame, _LIGHTEST - 1), background))
    return cv2.min(even, cv2.max(
        background, cv2.bitwise_not(_above(background, _LIGHTEST - 1))))


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
