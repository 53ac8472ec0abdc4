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

"""The homography on which corners of two pictures agree, and how uncertain it is."""

from typing import NamedTuple, Optional, Tuple

from camera_to_base.trust.correction.corners import Pairs
from camera_to_base.uncertainty import Lens, warp_design
import cv2
import numpy as np

# Of a homography close to the identity.
NUMBERS = 8
# How far corners that agree may be off the first homography, which has no weights yet.
_AGREE_PX = 2.5
# Of reweighting the corners.
_ROUNDS = 8
# Cauchy's weights; squared deviations, in variances, of corners that do not agree; and the least
# variance, as a factor of what the corners' information says.
_HALF_WEIGHT, _DISAGREES, _LEAST_VARIANCE = 2.4, 9.0, 0.05
# What the corners of a block of the picture have in common is no noise.
_BLOCKS, _LEAST_IN_BLOCK = (4, 3), 4


class WarpFit(NamedTuple):
    """
    A small warp of a picture.

    :param numbers: Shape (8,), see the room `uncertainty`, its `picture_warp`.
    :param covariance: Of the numbers, shape (8, 8).
    :param agrees: Shape (n,), which corners agree.
    """

    numbers: np.ndarray
    covariance: np.ndarray
    agrees: np.ndarray


def first_homography(here: np.ndarray, there: np.ndarray) -> Optional[np.ndarray]:
    """
    Find the homography on which most pairs of undistorted places agree, by RANSAC.

    :param here: Shape (n, 2), in px.
    :param there: Shape (n, 2), in px.
    :returns: Shape (3, 3); None where there is none.
    """
    if len(here) < NUMBERS:
        return None
    matrix, _ = cv2.findHomography(here, there, cv2.RANSAC, _AGREE_PX, maxIters=1000)
    return matrix


def fit_warp(
    pairs: Pairs, information: np.ndarray, size: Tuple[int, int], lens: Optional[Lens]
) -> WarpFit:
    """
    Fit the warp that takes places to those close by, by least squares with robust weights.

    :param pairs: At least 8, in px of pictures of a size.
    :param information: Shape (n, 2, 2), how well each pair tells its shift, up to a factor.
    """
    design = warp_design(pairs.here, size, lens)[:, :, :NUMBERS]
    weighted = design.transpose(0, 2, 1) @ information
    shares = weighted @ design
    missed = pairs.there - pairs.here
    sides = (weighted @ missed[:, :, None])[:, :, 0]
    weights = np.ones(len(missed))
    for _ in range(_ROUNDS):
        numbers = np.linalg.lstsq(
            np.tensordot(weights, shares, 1), weights @ sides, rcond=None)[0]
        residuals = missed - design @ numbers
        squares = np.einsum('ni,nij,nj->n', residuals, information, residuals)
        # The median of the squares of two normal numbers is 1.39 variances.
        variance = max(float(np.median(squares)) / 1.39, _LEAST_VARIANCE)
        weights = 1 / (1 + squares / variance / _HALF_WEIGHT ** 2)
    agrees = squares < _DISAGREES * variance
    covariance = variance * np.linalg.pinv(
        np.tensordot(weights * agrees, shares, 1), hermitian=True)
    shared = _shared_variance(pairs.here[agrees], residuals[agrees], size)
    radius = np.hypot(*size) / 2
    covariance[[2, 5], [2, 5]] += shared / radius ** 2
    return WarpFit(numbers, covariance, agrees)


def warp_matrix(numbers: np.ndarray, size: Tuple[int, int]) -> np.ndarray:
    """
    Give a warp as a homography of undistorted px, shape (3, 3).

    :param numbers: Shape (8,).
    """
    width, height = size
    radius = np.hypot(width, height) / 2
    to_places = np.array([[1 / radius, 0, -(width - 1) / 2 / radius],
                          [0, 1 / radius, -(height - 1) / 2 / radius], [0, 0, 1]])
    warp = np.eye(3) + np.append(numbers, 0.0).reshape(3, 3)
    return np.linalg.inv(to_places) @ warp @ to_places


def _shared_variance(
    places: np.ndarray, residuals: np.ndarray, size: Tuple[int, int]
) -> float:
    # In px²: of the residuals' means over blocks, beyond what noise leaves of them.
    columns, rows = (np.clip((along * count / length).astype(int), 0, count - 1)
                     for along, count, length in zip(places.T, _BLOCKS, size))
    blocks = rows * _BLOCKS[0] + columns
    beyond = []
    for block in range(_BLOCKS[0] * _BLOCKS[1]):
        inside = residuals[blocks == block]
        if len(inside) >= _LEAST_IN_BLOCK:
            beyond.append(inside.mean(axis=0) ** 2 - inside.var(axis=0) / (len(inside) - 1))
    return max(0.0, float(np.mean(beyond))) if beyond else 0.0
