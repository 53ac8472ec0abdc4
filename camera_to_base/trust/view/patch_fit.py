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

"""How far each patch of the background has shifted in a frame: one linear regression a patch."""

import copy
from typing import Optional

from camera_to_base.trust.view.patch_shifts import PatchShifts
from camera_to_base.trust.view.patches import Patches
import cv2
import numpy as np

# The smoothing that the background's gradient is taken with, in px: the better one for a patch.
_SIGMAS, _USUAL_LENGTH = (0.7, 1.2, 2.5), 1280
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
        sigmas = np.array(_SIGMAS) * max(1.0, max(grey.shape) / _USUAL_LENGTH)
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
