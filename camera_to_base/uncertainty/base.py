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
The base transform's term: how far the pose of the camera frame in the base frame is off.

A pose has six numbers: three of the displacement and three of the rotation. Their covariance is
that of the camera frame's origin, in the base frame, in cm and rad. It follows from the pairs that
the transform was fitted to: from the places of the points, and from the error of a touch, which is
told by the residuals of each pair that was left out of the fit.
"""

from typing import Optional

from camera_to_base.uncertainty.scatter import pooled_variance
import numpy as np

POSE_NUMBERS = 6
# The usual error of a touch, of each coordinate; and how many residuals that is worth.
_TOUCH_CM, _TOUCH_WORTH = 0.1, 8.0
# Without a measured covariance: 1 cm, and 1 degree about each axis.
UNKNOWN_BASE = np.diag([1.0] * 3 + [np.radians(1.0) ** 2] * 3)


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
