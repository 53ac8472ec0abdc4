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

"""A camera's noise, measured by level: a threshold has to stay above it."""

import numpy as np

# Places that are compared, about, and how far apart the two of a pair are, in px.
_PLACES, _APART = 9000, 3
_BIN, _LEAST_IN_BIN = 16, 60
_BINS, _DIFFERENCES = 256 // _BIN, 2 * 255 + 1
# A difference of whole numbers has a median of 0 on a quiet picture.
_QUIETEST = 0.3
# The median of a normal distribution's absolute values is 0.6745 of its deviation.
_DEVIATION = 1 / 0.6745


def measure_noise(frame: np.ndarray, background: np.ndarray) -> np.ndarray:
    """
    Measure how much a frame differs from the background by noise alone.

    The differences at two places that are a few px apart are compared: light that has changed
    drops out, and so does what covers less than half of the places of a level.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :returns: Shape (256, 3): the deviation of one frame's grey levels, by level and channel.
    """
    step = max(int(np.sqrt(frame.shape[0] * frame.shape[1] / _PLACES)), 1)
    rows = slice(step // 2, None, step)
    change = frame[rows].astype(np.int16) - background[rows]
    if change.shape[1] <= 2 * _APART:
        return np.full((256, 3), _QUIETEST, np.float32)
    pairs = change[:, :-_APART:step] - change[:, _APART::step]
    levels = background[rows, :-_APART:step] // _BIN
    return np.stack([_by_level(np.abs(pairs[..., channel]).ravel(), levels[..., channel].ravel())
                     for channel in range(3)], axis=1)


def _by_level(differences: np.ndarray, bins: np.ndarray) -> np.ndarray:
    # How often each difference occurs at each level.
    counts = np.bincount(
        np.int16(bins) * _DIFFERENCES + differences, minlength=_BINS * _DIFFERENCES)
    counts = counts.reshape(_BINS, _DIFFERENCES)
    known = np.flatnonzero(counts.sum(axis=1) >= min(_LEAST_IN_BIN, len(differences)))
    medians = [_median(counts[number]) for number in known]
    if not medians:
        known, medians = np.array([0]), [_median(counts.sum(axis=0))]
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
