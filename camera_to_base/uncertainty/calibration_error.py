# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
How far a calibration is off: the terms of the fitted surface and of the base transform.

A fit to measured points leaves the warp of the picture uncertain; by how much follows from the
fit's own equations (J^T J) and from the error of a point. That error is not taken from the
residuals of the fit: these are small even if the model cannot describe the lens. Instead, the
outer rows and columns of points are left out in turn and predicted from the others. The prediction
errors, each divided by the one that points with an error of 1 px would have, give the variance.

A pose has six numbers: three of the displacement and three of the rotation. Their covariance is
that of the camera frame's origin, in the base frame, in cm and rad. It follows from the pairs that
the transform was fitted to: from the places of the points, and from the error of a touch, which is
told by the residuals of each pair that was left out of the fit.
"""

from typing import List, NamedTuple, Optional

from camera_to_base.uncertainty.terms import HOMOGRAPHY_NUMBERS, WARP_NUMBERS
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

POSE_NUMBERS = 6
# The usual error of a touch, of each coordinate; and how many residuals that is worth.
_TOUCH_CM, _TOUCH_WORTH = 0.1, 8.0
# Without a measured covariance: 1 cm, and 1 degree about each axis.
UNKNOWN_BASE = np.diag([1.0] * 3 + [np.radians(1.0) ** 2] * 3)


def pooled_variance(
    squares: float, freedom: float, expected: float, expected_freedom: float
) -> float:
    """
    Return the variance of measurements, of which few residuals are known.

    It is pooled with the variance that such measurements usually have: a handful of residuals may
    happen to be small.

    :param squares: The sum of squared residuals, each divided by its own expected square.
    :param freedom: Degrees of freedom of the sum; 0 or less leaves the usual value only.
    :param expected: The usual standard deviation, in the unit of the residuals.
    :param expected_freedom: How many residuals it is worth.
    """
    if freedom <= 0:
        return expected ** 2
    return (squares + expected_freedom * expected ** 2) / (freedom + expected_freedom)


class FitError(NamedTuple):
    """
    How uncertain a fitted surface is.

    :param covariance: Of the picture's warp, shape (14, 14), see `terms`.
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


def base_error(arms: np.ndarray, left_out: Optional[np.ndarray], flat: bool) -> np.ndarray:
    """
    Estimate how uncertain a fitted base transform is.

    :param arms: Shape (n, 3): the pairs' points from the camera frame's origin, in the directions
        of the base frame, in cm.
    :param left_out: Shape (n, 3): residual of each pair under the fit to the others, in cm; None
        where that is not known.
    :param flat: Whether z was not measured, but is the same for all.
    :returns: Covariance of displacement (cm) and rotation (rad), shape (6, 6), in the base frame.
    """
    design = pose_design(arms)
    inverse = np.linalg.pinv(np.einsum('nij,nik->jk', design, design), hermitian=True)
    squares, freedom = 0.0, 0.0
    if left_out is not None:
        axes = 2 if flat else 3
        freedom = float(axes * len(arms) - (3 if flat else 6))
        squares = freedom * float(np.mean(_relative_squares(design, left_out, axes)))
    variance = pooled_variance(squares, freedom, _TOUCH_CM, _TOUCH_WORTH)
    return variance * inverse


def _relative_squares(design: np.ndarray, left_out: np.ndarray, axes: int) -> np.ndarray:
    """
    Return the squares of left-out residuals relative to the touch's variance, shape (n, axes).

    A left-out residual has the errors of the pair and of the transform that the others give.
    """
    whole = np.einsum('nij,nik->jk', design, design)
    squares = []
    for own, residual in zip(design, left_out):
        others = np.linalg.pinv(whole - own.T @ own, hermitian=True)
        spread = (np.eye(3) + own @ others @ own.T)[:axes, :axes]
        squares.append(residual[:axes] @ np.linalg.solve(spread, residual[:axes]) / axes)
    return np.array(squares)


def pose_design(arms: np.ndarray) -> np.ndarray:
    """
    Return how the six numbers of a pose's error move points.

    :param arms: Shape (n, 3): from the camera frame's origin to the points, in the directions of
        the base frame.
    :returns: Shape (n, 3, 6): a displacement moves all alike, a rotation r by r x arm.
    """
    design = np.zeros((len(arms), 3, POSE_NUMBERS))
    design[:, 0, 0] = design[:, 1, 1] = design[:, 2, 2] = 1.0
    x, y, z = arms.T
    design[:, 0, 4], design[:, 0, 5] = z, -y
    design[:, 1, 3], design[:, 1, 5] = -z, x
    design[:, 2, 3], design[:, 2, 4] = y, -x
    return design


def base_covariance(
    camera_covariance: np.ndarray, point: np.ndarray, rotation: np.ndarray,
    transform_covariance: np.ndarray,
) -> np.ndarray:
    """
    Return the covariance of a pose in the base frame.

    :param camera_covariance: Of x, y, z (cm) and the rotations about them (rad), shape (6, 6), in
        the camera frame.
    :param point: x, y and z, in cm, in the camera frame.
    :param rotation: From the camera frame to the base frame, shape (3, 3).
    :param transform_covariance: Of the transform, shape (6, 6), see :func:`base_error`.
    :returns: Shape (6, 6), in the base frame.
    """
    both = np.zeros((6, 6))
    both[:3, :3] = both[3:, 3:] = rotation
    moves = np.eye(6)
    moves[:3] = pose_design((rotation @ point)[None])[0]
    return both @ camera_covariance @ both.T + moves @ transform_covariance @ moves.T
