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

"""Checks whether pairs of points are plausible for a camera, its table and a robot."""

from typing import Any, List, Mapping

from camera_to_base.calibration.fits.rigid_fit import PAIRS_TO_TELL_A_BAD_ONE, RigidFit, spread
from camera_to_base.errors import CalibrationError, HorizonError
from camera_to_base.surface import (
    Hull, make_hull, make_surface, PointPairs, Surface, SURFACE_DEFAULTS)
import numpy as np

# Nearer pairs do not determine the rotation. Farther ones do not fit on a table, unless a surface
# file shows a larger one.
SMALLEST_SPREAD_CM = 1.0
LARGEST_SPREAD_CM = 150.0
# The smallest error of a gripper tip and a ruler.
TOUCH_ERROR_CM = 0.1
# Expected errors at the far end of the table from which on the pairs are reported, and refused.
DOUBTFUL_ERROR_CM = 0.5
LARGEST_ERROR_CM = 2.0
DOUBTFUL_RMS_CM = 0.3
# Component of a table's normal along the base's z. If it is smaller, the surface is a wall, and z
# cannot show on which side of it the camera is.
_LEVEL = 0.1


def check_pairs(pairs: PointPairs, fit: RigidFit) -> List[str]:
    """
    Check the pairs by themselves, without a surface.

    :returns: Sentences about what is doubtful.
    :raises CalibrationError: If the pairs lie too near each other.
    """
    extent = spread(pairs.camera_points)
    if extent < SMALLEST_SPREAD_CM:
        raise CalibrationError(
            f'all pairs lie within {10 * extent:.1f} mm, too near each other to tell how the '
            'frames are turned: are the numbers in m instead of cm? Otherwise spread the points '
            'over the working area')
    doubts = []
    if len(pairs) < PAIRS_TO_TELL_A_BAD_ONE:
        doubts.append(f'with {len(pairs)} pairs a bad one cannot be told from the others: give '
                      f'{PAIRS_TO_TELL_A_BAD_ONE} or more')
    rms = np.sqrt(np.mean(np.sum(fit.residuals ** 2, axis=1)))
    if rms > DOUBTFUL_RMS_CM:
        doubts.append(f'the pairs are off by {10 * rms:.1f} mm rms, where a ruler and a gripper '
                      'tip are off by 1 to 2 mm: measure them again')
    return doubts


def check_without_surface(pairs: PointPairs) -> List[str]:
    """
    Check the pairs if the surface is not known.

    :returns: Sentences about what is doubtful.
    :raises CalibrationError: If the pairs lie too far apart for a table.
    """
    extent = spread(pairs.camera_points)
    if extent > LARGEST_SPREAD_CM:
        raise CalibrationError(
            f'the pairs lie up to {extent:.0f} cm apart, which is no table: are the numbers in mm '
            'instead of cm? For so large a table give --surface, which tells')
    return ['without --surface nothing shows whether the base frame is mirrored, or the columns '
            "of the two frames exchanged: give the surface's file"]


def check_with_surface(
    pairs: PointPairs, fit: RigidFit, values: Mapping[str, Any], base_z: str
) -> List[str]:
    """
    Check the pairs against the surface that the camera points were measured with.

    :param values: The surface's parameters by full name; missing ones have their defaults.
    :param base_z: 'up' if the base frame's z points away from the table, 'down' if into it.
    :returns: Sentences about what is doubtful.
    :raises CalibrationError: If a point cannot have been seen, the base frame is mirrored, columns
        are exchanged, or the pairs lie too near each other for the size of the surface.
    """
    # The pairs lie on the surface, whatever object height the parameters set.
    values = {**SURFACE_DEFAULTS, **values, 'object_height_cm': 0.0}
    surface = make_surface(values)
    width, height = values['surface.image_size']
    # With a pixel around it, so that an object at the edge may be rounded.
    picture = Hull([[-1, -1], [width + 1, -1], [width + 1, height + 1], [-1, height + 1]])
    hull = make_hull(values) or picture
    _refuse_exchanged(pairs, surface, hull)
    _refuse_unseen(pairs, surface, picture)
    _refuse_mirrored(fit, surface, hull, base_z)
    return [*_precision(pairs, fit, surface, hull), *_outside(pairs, surface, hull)]


def _inside(points: np.ndarray, surface: Surface, hull: Hull) -> np.ndarray:
    """Return which points (n, 3) the surface shows within an area, shape (n,)."""
    pixels = surface.pixels(points[:, :2])
    return np.array([bool(np.isfinite(pixel).all()) and hull.contains(pixel) for pixel in pixels])


def _refuse_exchanged(pairs: PointPairs, surface: Surface, hull: Hull) -> None:
    if (_inside(pairs.base_points, surface, hull).all()
            and not _inside(pairs.camera_points, surface, hull).all()):
        raise CalibrationError(
            'the base points lie in the area that the camera was calibrated in, and the camera '
            'points do not: are the columns of the two frames exchanged?')


def _refuse_unseen(pairs: PointPairs, surface: Surface, picture: Hull) -> None:
    unseen = ~_inside(pairs.camera_points, surface, picture)
    if unseen.any():
        index = int(np.argmax(unseen))
        x, y, _ = pairs.camera_points[index]
        raise CalibrationError(
            f'row {pairs.rows[index]}: the camera point ({x:g}, {y:g}) cm lies outside of the '
            'picture: is it in mm instead of cm, are columns exchanged, or is the surface of '
            'another camera?')


def _refuse_mirrored(fit: RigidFit, surface: Surface, hull: Hull, base_z: str) -> None:
    # Up is the side of the table on which the camera is.
    up_in_camera_frame = -1.0 if _sees_y_clockwise(surface, hull) else 1.0
    up_in_base_frame = up_in_camera_frame * fit.rotation[2, 2]
    if (up_in_base_frame if base_z == 'up' else -up_in_base_frame) < -_LEVEL:
        away = 'into the table' if base_z == 'up' else 'away from the table'
        raise CalibrationError(
            f"the pairs put the base frame's z {away}, so it is mirrored: has one of the base "
            'axes the wrong sign, or are x_base_cm and y_base_cm exchanged? For a robot that '
            'hangs above the table and counts z downwards say --base-z down')


def _sees_y_clockwise(surface: Surface, hull: Hull) -> bool:
    """Return whether the camera sees y clockwise from x, in the middle of an area."""
    origin = surface.locate([hull.corners.mean(axis=0)])[0]
    start, along_x, along_y = surface.pixels(origin + [[0, 0], [1e-3, 0], [0, 1e-3]])
    (u_of_x, v_of_x), (u_of_y, v_of_y) = along_x - start, along_y - start
    return bool(u_of_x * v_of_y - v_of_x * u_of_y > 0)


def _precision(
    pairs: PointPairs, fit: RigidFit, surface: Surface, hull: Hull
) -> List[str]:
    """Warn of pairs too near each other for the area, and give the error that results."""
    freedom = max(2 * len(pairs) - 3, 1)
    deviation = max(TOUCH_ERROR_CM, np.sqrt(np.sum(fit.residuals ** 2) / freedom))
    centre = pairs.camera_points[:, :2].mean(axis=0)
    arms = np.sum((pairs.camera_points[:, :2] - centre) ** 2)
    try:
        farthest = np.linalg.norm(surface.locate(hull.corners) - centre, axis=1).max()
    except HorizonError:
        return []  # A surface without a hull, whose picture has no far end.
    error = float(deviation * np.sqrt(2 / len(pairs) + farthest ** 2 / arms))
    text = (f'the pairs lie within {spread(pairs.camera_points):.1f} cm: errors of '
            f'{10 * deviation:.1f} mm in them become {10 * error:.0f} mm at the far end of the '
            'table: spread them over the working area')
    if error > LARGEST_ERROR_CM:
        raise CalibrationError(text)
    return [text] if error > DOUBTFUL_ERROR_CM else []


def _outside(pairs: PointPairs, surface: Surface, hull: Hull) -> List[str]:
    outside = ~_inside(pairs.camera_points, surface, hull)
    rows = [str(row) for row, is_outside in zip(pairs.rows, outside) if is_outside]
    if not rows:
        return []
    return ['the camera points of these rows lie outside of the area that the surface was '
            'calibrated in, where its figures do not hold: ' + ', '.join(rows)]
