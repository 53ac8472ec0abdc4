# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The noise of a frame: how much it differs from the background where nothing has changed.

Compression makes neighbours alike: the mean of a window is known less well then than that of as
many pixels with a noise of their own, and a reduced frame has nearly the noise of a whole one. So
the noise is measured at each scale at which frames are looked at.
"""

from typing import Dict, NamedTuple

from camera_to_base.detection.precise.light import AXES, log_levels
import cv2
import numpy as np

# By how much a frame is reduced to be looked at, along each axis: each is twice the last one.
SCALES = 1, 2, 4
# Places that are compared, about, and how far apart the two of a pair are, in px.
_PLACES, _APART, _NEXT = 9000, 3, 1
# The same for what neighbours have in common, in px of the whole frame, how much larger its
# deviation is at least, and by less than how many levels the two places differ on the background.
_FAR_APART, _LEAST_DRIFT, _SAME_PRINT = 24, 1.3, 32
# The blocks whose chroma is compared: their edge, px, and about how many. The median of a squared
# normal value.
_BLOCK, _BLOCKS, _MEDIAN_SQUARE = 5, 2000, 0.455
_BIN, _LEAST_IN_BIN = 16, 60
_BINS, _DIFFERENCES = 256 // _BIN, 2 * 255 + 1
# A difference of whole numbers has a median of 0 on a quiet picture.
_QUIETEST = 0.3
# The median of a normal distribution's absolute values is 0.6745 of its deviation.
_DEVIATION = 1 / 0.6745
# The least that is measured, see `_by_level`, and a little more.
_NO_NOISE = 1.01 * _QUIETEST * _DEVIATION / 2
# A mean of levels is known no better, in grey levels²; the compression and the rounding.
_LEAST_VARIANCE = 0.3


class Noise(NamedTuple):
    """
    The noise of a frame at one scale.

    :param levels: The deviation of the grey levels, by level and channel, shape (256, 3).
    :param drift: The variance that all of a window has in common, by that of a pixel.
    :param compression: How much of a step is seen beside it: 0 in a raw picture, up to 1.
    """

    levels: np.ndarray
    drift: float = 0.0
    compression: float = 0.0

    def at(self, level: int) -> float:
        """Give the deviation of a grey level, the mean of all channels."""
        return float(self.levels[level].mean())

    def variances(self, curve: np.ndarray) -> np.ndarray:
        """
        Give the variance of each grey level on a curve.

        :param curve: Shape (256,).
        :returns: Shape (256, 1, 3), float32.
        """
        slopes = np.gradient(curve)[:, None]
        return np.float32((self.levels ** 2 + _LEAST_VARIANCE) * slopes ** 2)[:, None]


def measure_noise(frame: np.ndarray, background: np.ndarray, level: int) -> Dict[int, Noise]:
    """
    Measure how much a frame differs from the background by noise alone.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :param level: A usual grey level.
    :returns: The noise at each of :data:`SCALES`.
    """
    result, pictures = {}, (frame, background)
    for scale in SCALES:
        if result:
            height, width = (max(length // 2, 1) for length in pictures[0].shape[:2])
            pictures = tuple(cv2.resize(one, (width, height), interpolation=cv2.INTER_AREA)
                             for one in pictures)
        result[scale] = _measured(*pictures, level, _FAR_APART // scale)
    # Each camera has noise: where there is none, it was compressed away.
    own, near = (one.at(level) for one in (
        result[1], Noise(_of_pairs(frame, background, _NEXT))))
    compression = 1.0 if own < _NO_NOISE else 1 - min(near / own, 1.0) ** 2
    return {**result, 1: result[1]._replace(compression=compression)}


def _measured(frame: np.ndarray, background: np.ndarray, level: int, far: int) -> Noise:
    noise = Noise(_of_pairs(frame, background, _APART))
    # A tone curve that has changed shows where a print does, too: that is no drift.
    own, common = (Noise(_of_pairs(frame, background, apart, _SAME_PRINT)).at(level)
                   for apart in (_APART, far))
    drift = (common / own) ** 2 - 1 if common > _LEAST_DRIFT * own else 0.0
    return noise._replace(drift=max(drift, _drift_of_chroma(frame, background, noise, far)))


def _of_pairs(
    frame: np.ndarray, background: np.ndarray, apart: int, alike: int = 256
) -> np.ndarray:
    """
    Measure the deviation of the grey levels, see :class:`Noise`.

    The differences at two places that are a few px apart are compared: light that has changed
    drops out, and so does what covers less than half of the places of a level.

    :param apart: How far the two places of a pair are apart, in px.
    :param alike: By less than so many levels they differ on the background.
    """
    step = max(int(np.sqrt(frame.shape[0] * frame.shape[1] / _PLACES)), 1)
    rows = slice(step // 2, None, step)
    usual = background[rows].astype(np.int16)
    change = frame[rows] - usual
    if change.shape[1] <= 2 * apart:
        return np.full((256, 3), _QUIETEST, np.float32)
    pairs, contrast = (np.abs(one[:, :-apart:step] - one[:, apart::step])
                       for one in (change, usual))
    bins = usual[:, :-apart:step] // _BIN
    return np.stack([_by_level(*(one[..., channel][contrast[..., channel] < alike]
                                 for one in (pairs, bins))) for channel in range(3)], axis=1)


def _drift_of_chroma(
    frame: np.ndarray, background: np.ndarray, noise: Noise, apart: int
) -> float:
    """Measure the drift by how much more the chroma of blocks differs than single pixels tell."""
    height, width = (length // _BLOCK for length in frame.shape[:2])
    apart = -(-apart // _BLOCK)
    # Of so many rows of blocks, one.
    step = max(height * width // _BLOCKS, 1)
    if height <= step // 2 or width <= apart:
        return 0.0
    pictures = [np.ascontiguousarray(picture[:height * _BLOCK, :width * _BLOCK].reshape(
        height, _BLOCK, -1)[step // 2::step]).reshape(-1, width * _BLOCK, 3)
        for picture in (frame, background)]
    (seen, seen_variance), (usual, usual_variance) = (
        [cv2.transform(_blocks(cv2.LUT(picture, table)), axes)
         for table, axes in ((log_levels(), AXES[:2]),
                             (noise.variances(log_levels()), AXES[:2] ** 2))]
        for picture in pictures)
    change, variance = seen - usual, seen_variance + usual_variance
    squares = (change[:, apart:] - change[:, :-apart]) ** 2 / (
        variance[:, apart:] + variance[:, :-apart])
    levels = np.int16(_blocks(pictures[1]))
    squares = squares[np.abs(levels[:, apart:] - levels[:, :-apart]).max(axis=2) < _SAME_PRINT]
    if not squares.size:
        return 0.0
    return max(float(np.median(squares)) / _MEDIAN_SQUARE - 1 / _BLOCK ** 2, 0.0)


def _blocks(picture: np.ndarray) -> np.ndarray:
    """Give the mean of each block."""
    return cv2.resize(picture, None, fx=1 / _BLOCK, fy=1 / _BLOCK, interpolation=cv2.INTER_AREA)


def _by_level(differences: np.ndarray, bins: np.ndarray) -> np.ndarray:
    # How often each difference occurs at each level.
    counts = np.bincount(bins * _DIFFERENCES + differences, minlength=_BINS * _DIFFERENCES)
    counts = counts.reshape(_BINS, _DIFFERENCES)
    known = np.flatnonzero(counts.sum(axis=1) >= _LEAST_IN_BIN)
    medians = [_median(counts[number]) for number in known]
    if not medians:
        known = np.array([0])
        medians = [_median(counts.sum(axis=0)) if len(differences) else 0.0]
    deviations = np.interp(np.arange(256), known * _BIN + _BIN / 2, medians)
    # Two frames at two places each: four times one frame's variance.
    return (np.maximum(deviations, _QUIETEST) * _DEVIATION / 2).astype(np.float32)


def _median(counts: np.ndarray) -> float:
    # Between whole numbers: by how many values lie below, as in grouped data.
    upto = np.cumsum(counts)
    half = upto[-1] / 2
    whole = int(np.searchsorted(upto, int(half), side='right'))
    below = upto[whole] - counts[whole]
    low = max(whole - 0.5, 0.0)
    return float(low + (whole + 0.5 - low) * (half - below) / counts[whole])
