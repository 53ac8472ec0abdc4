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
The surface's term: how far the calibrated surface is off, anywhere in the picture.

A fit to measured points leaves the warp of the picture uncertain; by how much follows from the
fit's own equations (J^T J) and from the error of a point. That error is not taken from the
residuals of the fit: these are small even if the model cannot describe the lens. Instead, the
outer rows and columns of points are left out in turn and predicted from the others. The prediction
errors, each divided by the one that points with an error of 1 px would have, give the variance.
"""

from typing import List, NamedTuple

from camera_to_base.uncertainty.picture_warp import HOMOGRAPHY_NUMBERS, WARP_NUMBERS
from camera_to_base.uncertainty.scatter import pooled_variance
import numpy as np

# Standard deviations of the lens's numbers before anything is measured: of the first three as in
# the fit; of the others so that the ellipses hold on pictures of real boards, see the benchmark.
LENS_DEVIATIONS = np.array([0.3, 0.03, 0.03, 0.1, 0.01, 0.01])
# Of so many points, one row of one side is left out.
_SHARE_OF_A_SIDE = 9
# Projections that differ by less than this share of the extent are one row.
_SAME_ROW = 0.03
# How many residuals the expected error of a point is worth. The errors of neighbouring corners are
# alike on real pictures, so those of few corners look smaller than they are.
_EXPECTED_WORTH = 10.0
_DIRECTIONS = np.array([(1, 0), (-1, 0), (0, 1), (0, -1)], float)


class FitError(NamedTuple):
    """
    How uncertain a fitted surface is.

    :param covariance: Of the picture's warp, shape (14, 14), see `picture_warp`.
    :param point_px: Standard deviation of a point's coordinate, in px.
    """

    covariance: np.ndarray
    point_px: float


def fit_error(
    design: np.ndarray, residuals: np.ndarray, points: np.ndarray, *, expected_px: float,
) -> FitError:
    """
    Estimate how uncertain a fitted surface is.

    :param design: Shape (n, 2, 14 + m), see `warp_design`; m further columns are numbers that
        were fitted, too, such as the places of further boards, in any unit.
    :param residuals: Shape (n, 2), of the fit to all points, in px.
    :param points: Shape (n, 2), where the points lie on the surface.
    :param expected_px: Usual standard deviation of a point's coordinate, in px.
    """
    variance = expected_px ** 2
    # The lens's expected numbers count for more the larger the points' error is.
    for _ in range(3):
        precision = _precision(design.shape[2], variance)
        variance = _left_out_variance(design, residuals, points, precision, expected_px)
    columns = design.reshape(-1, design.shape[2])
    inverse = np.linalg.pinv(columns.T @ columns + precision, hermitian=True)
    # What the residuals tell of the lens beyond the fitted model: the fit is off by as much.
    missed = (inverse @ (columns.T @ residuals.ravel()))[:WARP_NUMBERS]
    covariance = variance * inverse[:WARP_NUMBERS, :WARP_NUMBERS] + np.outer(missed, missed)
    return FitError(covariance, float(np.sqrt(variance)))


def _precision(size: int, variance: float) -> np.ndarray:
    precision = np.zeros((size, size))
    lens = slice(HOMOGRAPHY_NUMBERS, WARP_NUMBERS)
    precision[lens, lens] = np.diag(variance / LENS_DEVIATIONS ** 2)
    return precision


def _left_out_variance(
    design: np.ndarray, residuals: np.ndarray, points: np.ndarray, precision: np.ndarray,
    expected_px: float,
) -> float:
    """Return the variance of a point's coordinate by left-out sides, in px²."""
    count = len(points)
    squares, left_out = [], np.zeros(count, bool)
    for side in sides(points):
        kept = ~side
        if 2 * kept.sum() <= HOMOGRAPHY_NUMBERS + design.shape[2] - WARP_NUMBERS:
            continue
        squares.append(_relative_square(design, residuals, kept, precision))
        left_out |= side
    columns = design.reshape(-1, design.shape[2])
    normal = columns.T @ columns
    used = np.trace(np.linalg.pinv(normal + precision, hermitian=True) @ normal)
    freedom = (2 * count - used) * left_out.mean()
    mean_square = float(np.mean(squares)) if squares else 0.0
    return pooled_variance(
        mean_square * max(freedom, 0.0), freedom if squares else 0.0, expected_px,
        _EXPECTED_WORTH)


def sides(points: np.ndarray) -> List[np.ndarray]:
    """
    Return which points are the outer row of each side, four masks of shape (n,).

    :param points: Shape (n, 2).
    """
    found = []
    for along in (points @ direction for direction in _DIRECTIONS):
        outermost = np.sort(along)[::-1][max(1, len(points) // _SHARE_OF_A_SIDE) - 1]
        found.append(along >= outermost - _SAME_ROW * np.ptp(along))
    return found


def _relative_square(
    design: np.ndarray, residuals: np.ndarray, kept: np.ndarray, precision: np.ndarray
) -> float:
    """Return the mean squared error of left-out coordinates, relative to points of 1 px error."""
    size = design.shape[2]
    known, left_out = design[kept].reshape(-1, size), design[~kept].reshape(-1, size)
    inverse = np.linalg.pinv(known.T @ known + precision, hermitian=True)
    errors = residuals[~kept].ravel() - left_out @ (inverse @ (known.T @ residuals[kept].ravel()))
    spread = np.eye(len(left_out)) + left_out @ inverse @ left_out.T
    return float(errors @ np.linalg.solve(spread, errors)) / len(errors)
