# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Fits the transform from the camera frame to the base frame to pairs of points."""

from dataclasses import dataclass
from typing import NamedTuple, Optional, Tuple

from camera_to_base.calibration.figures import find_outlier, leave_one_out
from camera_to_base.errors import CalibrationError
from camera_to_base.surface import on_one_line, PointPairs
import numpy as np

# A ruler and a gripper tip are off by a few millimetres; more than this is a swapped row or sign.
LARGEST_RESIDUAL_CM = 2.0
# With fewer pairs, a bad pair cannot be identified.
PAIRS_TO_TELL_A_BAD_ONE = 5
# A deviation too small to measure with a ruler.
_FLOOR_CM = 0.03
# With a larger ratio of distances, the two frames do not have the same unit.
_LARGEST_RATIO = 1.25


def align(points: np.ndarray, targets: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """
    Find the proper rotation and the displacement that take points to targets.

    Both may lie in a plane: a plane seen from behind is a rotation by 180 degrees about an axis in
    the plane, not a reflection.

    :param points: Shape (n, 3), not on one line.
    :param targets: Shape (n, 3), in the same unit.
    :returns: Rotation, shape (3, 3), and displacement, shape (3,).
    """
    from scipy.spatial.transform import Rotation

    centre, target_centre = points.mean(axis=0), targets.mean(axis=0)
    rotation = Rotation.align_vectors(targets - target_centre, points - centre)[0].as_matrix()
    return rotation, target_centre - rotation @ centre


def rotation_deg(rotation: np.ndarray) -> Tuple[float, float, float]:
    """
    Write a rotation as Rz(yaw) Ry(pitch) Rx(roll).

    Not by scipy's `as_euler`: it prints a warning if pitch is a right angle, as with a camera
    frame on a wall.

    :param rotation: Shape (3, 3), proper.
    :returns: Roll, pitch and yaw in degrees, -180 < roll, yaw <= 180 and -90 <= pitch <= 90.
    """
    level = np.hypot(rotation[0, 0], rotation[1, 0])
    pitch = np.arctan2(-rotation[2, 0], level)
    if level > 1e-9:
        roll = np.arctan2(rotation[2, 1], rotation[2, 2])
        yaw = np.arctan2(rotation[1, 0], rotation[0, 0])
    else:  # Roll and yaw turn about the same axis: roll takes the whole angle.
        roll, yaw = np.arctan2(-rotation[1, 2], rotation[1, 1]), 0.0
    return tuple(_upper_half_open(np.degrees(angle)) for angle in (roll, pitch, yaw))


def _upper_half_open(degrees):
    """Round to 1e-9 degrees, so that -180 + 1e-14 becomes 180, and -0.0 becomes 0."""
    rounded = round(float(degrees), 9)
    return 180.0 if rounded == -180.0 else rounded + 0.0


@dataclass(frozen=True)
class RigidFit:
    """
    A rigid transform with its residuals.

    :param rotation: Shape (3, 3), from the camera frame to the base frame.
    :param displacement_cm: x, y and z.
    :param residuals: Shape (n, 3): transformed camera point minus base point, in cm.
    :param left_out_residuals: Shape (n, 3), each under the transform from all other pairs; None
        where the others do not suffice.
    """

    rotation: np.ndarray
    displacement_cm: Tuple[float, float, float]
    residuals: np.ndarray
    left_out_residuals: Optional[np.ndarray]

    @property
    def rotation_deg(self) -> Tuple[float, float, float]:
        """Roll, pitch and yaw about the fixed axes x, y and z."""
        return rotation_deg(self.rotation)


def fit_rigid(pairs: PointPairs) -> RigidFit:
    """
    Fit a rotation and a displacement by least squares; refuse pairs that no transform fits.

    :raises CalibrationError: If there are fewer than three pairs, all lie on one line, one is an
        outlier, or the largest residual is over 20 mm; the message names the row.
    """
    fit, folds = _fit_all(pairs)
    _refuse_other_unit(pairs)
    index = _outlier(pairs, fit, folds)
    if index is not None:
        raise CalibrationError(_outlier_text(pairs, fit, folds, index))
    _refuse_misfit(fit.residuals, pairs.rows)
    return fit


class PairFigures(NamedTuple):
    """
    How well each of n pairs fits.

    :param residuals_cm: Shape (n,), the distance of each from the fit to all.
    :param left_out_cm: Shape (n,), from the fit to the others; None where these do not suffice.
    :param unfit: Index of the pair that does not fit; None if there is none, or it is not known.
    """

    residuals_cm: np.ndarray
    left_out_cm: Optional[np.ndarray]
    unfit: Optional[int]


def pair_figures(pairs: PointPairs) -> PairFigures:
    """
    Compare each pair with the fit, and name the one that does not belong to the others.

    :raises CalibrationError: If there are fewer than three pairs, or all lie on one line.
    """
    fit, folds = _fit_all(pairs)
    residuals = np.linalg.norm(fit.residuals, axis=1)
    unfit = _outlier(pairs, fit, folds)
    if unfit is None and residuals.max() > LARGEST_RESIDUAL_CM:
        unfit = int(np.argmax(residuals))
    left_out = fit.left_out_residuals
    return PairFigures(
        residuals, None if left_out is None else np.linalg.norm(left_out, axis=1), unfit)


def _fit_all(pairs):
    """Fit to all pairs, and to all but each: the fit, and the n transforms or None."""
    everything = np.arange(len(pairs))
    transform = _fit(pairs, everything)
    folds = leave_one_out(lambda kept: _fit(pairs, kept), len(pairs))
    left_out = None if None in folds else np.stack(
        [_residuals(pairs, fold, index) for index, fold in enumerate(folds)])
    return RigidFit(transform[0], tuple(transform[1].tolist()),
                    _residuals(pairs, transform, everything), left_out), folds


def _fit(pairs, kept):
    points, targets = pairs.camera_points[kept], pairs.base_points[kept]
    if len(kept) < 3:
        raise CalibrationError(f'{len(kept)} pairs are too few: give at least 3, not on one line')
    if on_one_line(points) or on_one_line(targets):
        raise CalibrationError(f'all {len(kept)} pairs lie on one line, which leaves open to what '
                               'side of it the camera looks: add a pair off that line')
    return align(points, targets)


def _residuals(pairs, transform, indices):
    rotation, displacement = transform
    return pairs.camera_points[indices] @ rotation.T + displacement - pairs.base_points[indices]


def _refuse_other_unit(pairs):
    # The median, so that a single bad row does not change the ratio.
    with np.errstate(all='ignore'):  # points so near that their squares vanish have no ratio
        ratio = float(np.median(_distances(pairs.base_points) / _distances(pairs.camera_points)))
    if not 1 / _LARGEST_RATIO < ratio < _LARGEST_RATIO:
        raise CalibrationError(
            f'no rigid transform fits the pairs: the base points lie {ratio:.3g} times as far '
            'apart as the camera points: are all numbers in cm, and their columns the right ones?')


def _distances(points):
    """Return the distances between all points (n, d), shape (n (n - 1) / 2,)."""
    one, other = np.triu_indices(len(points), 1)
    return np.linalg.norm(points[one] - points[other], axis=1)


def spread(points: np.ndarray) -> float:
    """
    Return the distance between the two points that are farthest apart.

    :param points: Shape (n, d), n at least 2.
    :returns: In the points' unit.
    """
    return float(_distances(points).max())


def _outlier(pairs, fit, folds):
    if fit.left_out_residuals is None or len(pairs) < PAIRS_TO_TELL_A_BAD_ONE:
        return None
    flat = not (pairs.camera_points[:, 2].any() or pairs.base_points[:, 2].any())
    squares = [_squares_without(pairs, fold, index) for index, fold in enumerate(folds)]
    return find_outlier(np.sum(fit.residuals ** 2), np.array(squares), dimensions=2 if flat else 3,
                        parameters=3 if flat else 6, floor=_FLOOR_CM)


def _squares_without(pairs, fold, index):
    kept = np.delete(np.arange(len(pairs)), index)
    return np.sum(_residuals(pairs, fold, kept) ** 2)


def _outlier_text(pairs, fit, folds, index):
    rotation, displacement = folds[index]
    mean_square = _squares_without(pairs, folds[index], index) / (len(pairs) - 1)
    return (
        f'row {pairs.rows[index]} does not belong to the others: it is off by '
        f'{10 * np.linalg.norm(fit.left_out_residuals[index]):.1f} mm from the fit to them, which '
        f'they meet to {10 * np.sqrt(mean_square):.1f} mm rms: measure it again or delete it. '
        'Without it: rotation ({:.2f}, {:.2f}, {:.2f}) degrees, displacement '
        '({:.2f}, {:.2f}, {:.2f}) cm'.format(*rotation_deg(rotation), *displacement))


def _refuse_misfit(residuals, rows):
    errors = np.linalg.norm(residuals, axis=1)
    worst = int(np.argmax(errors))
    if errors[worst] > LARGEST_RESIDUAL_CM:
        raise CalibrationError(
            f'no rigid transform fits the pairs: row {rows[worst]} is off by '
            f'{10 * errors[worst]:.0f} mm, allowed are {10 * LARGEST_RESIDUAL_CM:.0f} mm: are its '
            'numbers swapped, of the wrong sign, or in another unit than cm?')
