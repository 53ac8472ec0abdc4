# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Small pieces of the background, and how far each has shifted in a frame."""

import copy
from typing import NamedTuple, Optional

import cv2
import numpy as np

# Samples along a side, and px between two of them in a picture of 640 px.
SIDE, _STEP_PX, _USUAL_LENGTH = 16, 2, 640
# Places are chosen in cells of at least this many px, 8 x 8 of them at most.
_MOST_CELLS, _LEAST_CELL_PX = 8, 32
# Of a strong edge no more than this counts, in levels per px: a faint corner is told from it.
_STRONG_EDGE, _CORNER_SIGMA = 20.0, 1.5
# An edge is better than nothing: it tells a shift across.
_EDGE_SHARE = 0.02
# Room for the filters of the gradient.
_MARGIN_PX = 3
_MEAN = np.full(SIDE * SIDE, 1 / SIDE ** 2, np.float32)

# In a darker frame the same noise is more of a shift.
_DARKEST_GAIN = 0.1

# The smoothing that the background's gradient is taken with, in px: the better one for a patch.
_SIGMAS, _SMOOTHED_LENGTH = (0.7, 1.2, 2.5), 1280
# Shifts are told by differences over this much at least: noise covers those of less.
_LEAST_HALF_PX = 1.0
# A coarser gradient is taken where it tells this much more.
_CLEARLY_BETTER = 1.5
# The gradient is that of a smoothed picture, the smaller one: shifts come out too large by this.
_TOO_LARGE = 1.25
# What the linear model misses of a shift, in px: no patch tells one better.
_MODEL_PX = 0.2
# The variance of a shift that a patch does not tell.
_UNTOLD_PX2 = 1e6
# At least this share of a patch's energy is taken for structure.
_LEAST_TRUE = 0.2
# A patch is seen where the model explains this share of what is not noise, ...
_LEAST_EXPLAINED = 0.5
# ... under a gain like that of the others, and where that is more than chance, in levels².
_GAINS, _USUAL_GAINS, _LEAST_ENERGY, _LEAST_NOISE_SHARE = (0.1, 5.0), (0.35, 2.2), 0.05, 0.05
# Under such a gain a frame shows the patches well.
_EVEN_GAINS = 0.5, 1.6
# Noise leaves so many times its variance unexplained at most. What is more is alike in samples
# that lie side by side, and makes a shift as uncertain as this many times as much noise.
_MOST_SURPLUS, _STRUCTURED = 1.25, 8.0
# Where the camera stands still, no more is left than this share of what is explained.
_LEFT_AT_REST = 0.1


class Patches:
    """
    Reads square patches of pictures of one size: a sample is the mean of four pixels.

    :param centres: Shape (n, 2), columns u and v in px, n at least 1.
    :param step: Distance of two samples, in px.
    """

    def __init__(self, centres: np.ndarray, step: int) -> None:
        self._step, self.count, self._centres = step, len(centres), centres
        self._first = np.floor(centres - (SIDE - 1) / 2 * step).astype(int)

    def part(self, chosen: np.ndarray) -> 'Patches':
        """Give some of the patches, by their indices."""
        return Patches(self._centres[chosen], self._step)

    def read(self, picture: np.ndarray) -> np.ndarray:
        """
        Read the patches' grey levels, each patch without its mean.

        :param picture: Shape (h, w, 3), uint8, BGR.
        :returns: Shape (n, 256), float32.
        """
        u, v = self._first.T
        pairs = _pieces(picture, self._step)[v, u].view(np.uint8)
        grey = cv2.cvtColor(pairs.reshape(-1, 2 * SIDE, 3), cv2.COLOR_BGR2GRAY)
        means = cv2.resize(grey, (SIDE, SIDE * self.count), interpolation=cv2.INTER_AREA)
        return self._without_mean(means.astype(np.float32))

    def slopes(self, grey: np.ndarray, half_px: float) -> np.ndarray:
        """
        Read the patches' gradients, each patch without its mean, as differences over 2 half_px.

        :param grey: Shape (h, w), float32.
        :returns: Shape (n, 256, 2), along u and v, in levels per px.
        """
        u, v = self._centres_of_samples()
        ahead_u, back_u, ahead_v, back_v = (
            self._without_mean(cv2.remap(grey, u + du, v + dv, cv2.INTER_LINEAR,
                                         borderMode=cv2.BORDER_REPLICATE))
            for du, dv in ((half_px, 0), (-half_px, 0), (0, half_px), (0, -half_px)))
        return np.stack([ahead_u - back_u, ahead_v - back_v], axis=2) / (2 * half_px)

    def _centres_of_samples(self) -> tuple:
        offsets = np.arange(SIDE, dtype=np.float32) * self._step + np.float32(0.5)
        shape = self.count, SIDE, SIDE
        u, v = (first[:, None] + offsets for first in self._first.T)
        return (np.broadcast_to(u[:, None, :], shape).astype(np.float32).reshape(-1, SIDE),
                np.broadcast_to(v[:, :, None], shape).astype(np.float32).reshape(-1, SIDE))

    def _without_mean(self, pieces: np.ndarray) -> np.ndarray:
        samples = pieces.reshape(self.count, -1)
        return samples - (samples @ _MEAN)[:, None]


def _pieces(picture: np.ndarray, step: int) -> np.ndarray:
    # A view of every patch that a picture can have: shape (v, u, 16, 2, 16), of pairs of pixels.
    picture, length = np.ascontiguousarray(picture), (SIDE - 1) * step + 2
    height, width = picture.shape[:2]
    row, pixel, _ = picture.strides
    return np.ndarray(
        (height - length + 1, width - length + 1, SIDE, 2, SIDE), np.dtype('V6'), picture,
        strides=(row, pixel, step * row, row, step * pixel))


def step_for(size: tuple) -> int:
    """Tell the distance of two samples for a picture of a size in px, in px."""
    return _STEP_PX * max(1, round(max(size) / _USUAL_LENGTH))


def find_places(grey: np.ndarray, step: int) -> np.ndarray:
    """
    Find in each cell of a picture the patch that is most like a corner.

    :param grey: Shape (h, w), float32.
    :returns: Shape (n, 2), the patches' centres, columns u and v in px; n is 0 where the picture
        is smaller than a patch.
    """
    reach = SIDE * step // 2
    score = _corner_score(grey, 2 * reach + 1)
    rows, columns = (_cells(length, reach + _MARGIN_PX) for length in grey.shape)
    places = [_best(score, row, column) for row in rows for column in columns]
    return np.array(places, np.float32).reshape(-1, 2)


def _cells(length: int, margin: int) -> list:
    count = min(_MOST_CELLS, (length - 2 * margin) // _LEAST_CELL_PX + 1)
    bounds = np.linspace(margin, length - margin, max(count, 0) + 1).astype(int)
    return [slice(*pair) for pair in zip(bounds, bounds[1:]) if pair[0] < pair[1]]


def _best(score: np.ndarray, rows: slice, columns: slice) -> tuple:
    piece = score[rows, columns]
    v, u = np.unravel_index(piece.argmax(), piece.shape)
    return columns.start + u, rows.start + v


def _corner_score(grey: np.ndarray, width: int) -> np.ndarray:
    # The smaller eigenvalue of the structure tensor: J. Shi, C. Tomasi, Good features to track,
    # 1994.
    smooth = cv2.GaussianBlur(grey, (0, 0), _CORNER_SIGMA)
    du, dv = (np.clip(cv2.Sobel(smooth, cv2.CV_32F, *order, scale=1 / 8),
                      -_STRONG_EDGE, _STRONG_EDGE) for order in ((1, 0), (0, 1)))
    uu, vv, uv = (cv2.boxFilter(product, -1, (width, width))
                  for product in (du * du, dv * dv, du * dv))
    return (uu + vv) / 2 - (1 - _EDGE_SHARE) * np.sqrt(((uu - vv) / 2) ** 2 + uv ** 2)


class PatchShifts(NamedTuple):
    """
    How the patches look in a frame.

    :param shifts: Shape (n, 2), along u and v in px.
    :param is_seen: Shape (n,), whether a patch looks like the background's at all.
    :param residuals: Shape (n,), mean square of what the model does not explain, in levels²; None
        where it was not asked.
    :param gain: How much brighter the frame is, by the median of the patches that are seen.
    :param surplus: How many times the noise that is known the model leaves unexplained, by the
        median of the patches.
    :param worth: Shape (2, n), how much of a patch's information along each of its axes counts,
        0..1; None for all of it.
    """

    shifts: np.ndarray
    is_seen: np.ndarray
    residuals: Optional[np.ndarray]
    gain: float
    surplus: float
    worth: Optional[np.ndarray] = None

    @property
    def precision(self) -> float:
        """Factor for the information of the shifts, below 1 in a dark frame."""
        return min(max(self.gain, _DARKEST_GAIN), 1.0) ** 2


class PatchFit:
    """
    Fits the background's patches to frames.

    frame = gain * patch + offset - shift * gradient. All that the background decides is computed
    once, and each patch and its gradient are made orthogonal and of length 1, so that a frame
    costs one product of matrices. The background's own noise makes its gradient larger than the
    surface's: what that adds is taken out of the estimate.

    :param patches: Which ones.
    :param background: Shape (h, w, 3), uint8, BGR.
    :param grey: The same in grey, float32.
    :param noise: Standard deviation of a pixel of `grey`, in levels.
    :param variance: That of a sample of a frame minus the background's, in levels².

    `shift_axes`, shape (n, 2, 2): along each of these rows a patch tells its shift with the
    variance 1, in 1/px. Of that variance `_noise_shares`, shape (n, 2), is due to noise.
    """

    def __init__(self, patches: Patches, background: np.ndarray, grey: np.ndarray,
                 noise: float, variance: float) -> None:
        self._patches, self._variance = patches, variance
        levels = patches.read(background).astype(float)
        energy = np.maximum(_energies(levels), 1e-6)
        self.energy = energy / levels.shape[1]
        sigmas = np.array(_SIGMAS) * max(1.0, max(grey.shape) / _SMOOTHED_LENGTH)
        best, *coarser = (self._fit(levels, energy, grey, sigma, noise) for sigma in sigmas)
        for other in coarser:
            is_better = _worst(other[-1]) > _CLEARLY_BETTER * _worst(best[-1])
            for ours, theirs in zip(best, other):
                ours[is_better] = theirs[is_better]
        axes, estimates, self._noise_shares, self.shift_axes = best
        # Noise in the patch makes its gain too small, and a shift by it too large.
        true_energy = np.maximum(self.energy - variance / 2, self.energy * _LEAST_TRUE)
        self._estimates = -estimates / _TOO_LARGE * (true_energy / self.energy)[:, None, None]
        self._lengths = np.sqrt(energy)
        self._axes = np.concatenate(
            [(levels / self._lengths[:, None])[:, None], axes], axis=1).astype(np.float32)

    def _fit(self, levels: np.ndarray, energy: np.ndarray, grey: np.ndarray,
             sigma: float, noise: float) -> list:
        half_px = float(max(_LEAST_HALF_PX, sigma))
        slopes = self._patches.slopes(
            cv2.GaussianBlur(grey, (0, 0), sigma), half_px).astype(float)
        along = np.einsum('ij,ijk->ik', levels, slopes) / energy[:, None]
        slopes -= levels[:, :, None] * along[:, None]
        values, vectors = np.linalg.eigh(slopes.transpose(0, 2, 1) @ slopes)
        false_energy = levels.shape[1] * _slope_noise(noise, sigma, half_px)
        true_values = values - false_energy
        # Where noise is half of it, the estimate would be as uncertain as its correction.
        is_told = true_values > false_energy + 1e-3
        inverse = np.where(is_told, 1 / np.maximum(true_values, 1e-6), 0.0)
        variance = np.where(
            is_told, self._variance * values * inverse ** 2 + _MODEL_PX ** 2, _UNTOLD_PX2)
        noise_shares = np.where(is_told, 1 - _MODEL_PX ** 2 / variance, 0.0)
        shift_axes = vectors.transpose(0, 2, 1) / np.sqrt(variance)[:, :, None]
        lengths = np.sqrt(np.maximum(values, 1e-6))
        axes = (slopes @ vectors / lengths[:, None]).transpose(0, 2, 1)
        return [axes, vectors * (inverse * lengths)[:, None], noise_shares, shift_axes]

    def part(self, chosen: np.ndarray) -> 'PatchFit':
        """
        Give the fit of some of the patches.

        :param chosen: Shape (n,), their indices.
        """
        part = copy.copy(self)
        part._patches = self._patches.part(chosen)
        part.energy, part.shift_axes = self.energy[chosen], self.shift_axes[chosen]
        part._noise_shares = self._noise_shares[chosen]
        part._estimates, part._axes = self._estimates[chosen], self._axes[chosen]
        part._lengths = self._lengths[chosen]
        return part

    def near_rest(self, frame: np.ndarray, usual: float) -> Optional[PatchShifts]:
        """
        Measure the shifts in a frame of a camera that stands still, in half of the time.

        A patch is seen where the model explains nearly all of it.

        :param usual: How many times the known noise is usual.
        :returns: None in a frame that is much darker or lighter than the background.
        """
        levels = self._patches.read(frame)
        parts = self._parts(levels)
        gains = parts[:, 0] / self._lengths
        gain = _median(gains)
        if not _EVEN_GAINS[0] < gain < _EVEN_GAINS[1]:
            return None
        explained = _energies(parts)
        left = _energies(levels) - explained
        is_seen = _are_usual(gains, gain)
        surplus = left / (self._variance * levels.shape[1] * (1 + gain ** 2) / 2)
        worth = None
        if surplus.max() > _MOST_SURPLUS * usual:
            worth = self._worth(surplus / usual)
            is_seen &= (surplus < _MOST_SURPLUS * usual) | (left < _LEFT_AT_REST * explained)
        return PatchShifts(
            self._shifts(parts) / gain, is_seen, None, gain, _median(surplus), worth)

    def measure(self, frame: np.ndarray, usual: float = 1.0) -> PatchShifts:
        """
        Measure the shifts of the patches in a frame.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :param usual: How many times the known noise is usual.
        """
        levels = self._patches.read(frame)
        parts = self._parts(levels)
        explained, whole = (_energies(samples) / levels.shape[1] for samples in (parts, levels))
        residuals, gains = whole - explained, parts[:, 0] / self._lengths
        # Half of the noise is the background's, which the gain scales.
        noise = self._variance * (1 + gains ** 2) / 2
        unexplained = np.maximum(residuals - noise, 0)
        is_seen = ((gains > _GAINS[0]) & (gains < _GAINS[1])
                   & (explained * (1 - _LEAST_EXPLAINED) > _LEAST_EXPLAINED * unexplained)
                   & (explained > _LEAST_ENERGY + _LEAST_NOISE_SHARE * noise))
        surplus = residuals / noise
        gain, usual_left = (_median(values[is_seen]) if is_seen.any() else 1.0
                            for values in (gains, surplus))
        shifts = self._shifts(parts) / np.maximum(gains, _GAINS[0])[:, None]
        return PatchShifts(shifts, is_seen & _are_usual(gains, gain), residuals, gain,
                           usual_left, self._worth(surplus / usual))

    def _worth(self, surplus: np.ndarray) -> np.ndarray:
        # What is left beyond the noise is no noise: along an edge it is taken for a shift.
        more = _STRUCTURED * np.maximum(surplus - _MOST_SURPLUS, 0)
        return 1 / (1 + self._noise_shares.T * more)

    def _parts(self, levels: np.ndarray) -> np.ndarray:
        # Shape (n, 3): how much of the patch and of its gradient along two directions there is.
        return (self._axes @ levels[:, :, None])[:, :, 0].astype(float)

    def _shifts(self, parts: np.ndarray) -> np.ndarray:
        # Shape (n, 2), in px, under a gain of 1.
        return (self._estimates @ parts[:, 1:, None])[:, :, 0]


def _energies(samples: np.ndarray) -> np.ndarray:
    return np.einsum('ij,ij->i', samples, samples)


def _are_usual(gains: np.ndarray, gain: float) -> np.ndarray:
    return (gains > _USUAL_GAINS[0] * gain) & (gains < _USUAL_GAINS[1] * gain)


def _median(values: np.ndarray) -> float:
    # np.median takes ten times as long for so few.
    values, half = np.sort(values), len(values) // 2
    return float(values[half] + values[-1 - half]) / 2


def _worst(axes: np.ndarray) -> np.ndarray:
    # Of the information along the axes, the lesser.
    return np.square(axes).sum(axis=2).min(axis=1)


def _slope_noise(noise: float, sigma: float, half_px: float) -> float:
    # White noise after a Gaussian filter, its difference at a distance.
    variance = noise ** 2 / (4 * np.pi * sigma ** 2)
    return 2 * variance * (1 - np.exp(-(half_px / sigma) ** 2)) / (2 * half_px) ** 2
