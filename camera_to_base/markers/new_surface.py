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
The calibration that a surface computed anew from markers has: its covariance and its parameters.

The markers' corners are as uncertain as the surface that they were learned with, and as the lens,
which both surfaces share. Both errors are those of one warp, `surface.covariance`, so what they do
in the new picture follows from it.
"""

from typing import Any, Dict, List

from camera_to_base.errors import CalibrationError
from camera_to_base.image_size import ImageSize
from camera_to_base.markers.camera_place import moved_place
from camera_to_base.markers.surface_fit import MarkerFit
from camera_to_base.parameters import Values
from camera_to_base.surface import (
    Hull, make_hull, make_surface, RadialDistortion, Surface, surface_values)
from camera_to_base.uncertainty import (
    HOMOGRAPHY_NUMBERS, scales_at, SURFACE_COVARIANCE, surface_covariance,
    triangle_of, warp_design, WARP_NUMBERS)
import numpy as np


def marker_surface(values: Values) -> Surface:
    """Make the surface that markers lie on: flat, whatever the height of the objects is."""
    return make_surface({**values, 'object_height_cm': 0.0})


def lens_of_values(values: Values) -> RadialDistortion:
    """Return the calibrated lens; one without distortion where the model has none."""
    size = tuple(values['surface.image_size'])
    if values['surface.model'] != 'homography':
        return RadialDistortion.of_picture(size)
    return RadialDistortion.of_picture(
        size, values['surface.homography.distortion_coefficient'],
        values['surface.homography.distortion_centre'])


def new_surface_values(values: Values, fit: MarkerFit) -> Dict[str, Any]:
    """
    Give the parameters of a surface computed anew.

    :param values: The calibration's parameters, by full name: those that the markers' corners
        were learned with.
    :param fit: The new surface.
    :returns: Those parameters of `surface.*` that differ.
    :raises CalibrationError: If objects have a height, and where the camera is now cannot be
        computed.
    """
    calibrated, size = marker_surface(values), tuple(values['surface.image_size'])
    covariance = new_covariance(
        fit, calibrated, surface_covariance(values[SURFACE_COVARIANCE]), size)
    found = {**surface_values(fit.surface, Hull(fit.pixels)), SURFACE_COVARIANCE: triangle_of(
        covariance), 'surface.hull': _moved_hull(values, calibrated, fit.surface)}
    if values['surface.camera_height_cm']:
        foot_cm, height_cm = moved_place(values, calibrated, fit.surface)
        if values['object_height_cm'] and not height_cm > values['object_height_cm']:
            raise CalibrationError(
                'where the camera stands now cannot be computed, which object_height_cm needs: '
                'calibrate again with calibrate board and --intrinsics')
        found.update({'surface.camera_height_cm': height_cm, 'surface.camera_foot_cm': foot_cm})
    return found


def deviation_cm(surface: Surface, covariance: np.ndarray, points: np.ndarray) -> float:
    """
    Return the standard deviation of positions by a surface, where it is the largest, in cm.

    :param covariance: Of the picture's warp, shape (14, 14).
    :param points: Where to look, shape (n, 2), in cm.
    """
    pixels = surface.pixels(points)
    moves = scales_at(surface, pixels) @ warp_design(
        pixels, surface.image_size, surface.distortion)
    squares = np.linalg.eigvalsh(moves @ covariance @ moves.transpose(0, 2, 1))
    return float(np.sqrt(squares.max()))


def _moved_hull(values: Values, calibrated: Surface, surface: Surface) -> List[float]:
    """Return the calibrated area in the new picture; [] for everywhere."""
    hull = make_hull(values)
    if hull is None:
        return []
    corners = surface.pixels(calibrated.locate(hull.corners))
    # Corners beyond the new horizon are not seen.
    corners = corners[np.isfinite(corners).all(axis=1)]
    return np.round(corners, 2).ravel().tolist() if len(corners) > 2 else []


def new_covariance(
    fit: MarkerFit, calibrated: Surface, calibrated_covariance: np.ndarray, image_size: ImageSize
) -> np.ndarray:
    """
    Return how uncertain the new surface is.

    :param fit: The new surface.
    :param calibrated: The flat surface that the markers' corners were learned with.
    :param calibrated_covariance: Of the calibrated picture's warp, shape (14, 14).
    :returns: Of the new picture's warp, shape (14, 14), see `uncertainty.picture_warp`.
    """
    there = calibrated.pixels(fit.points)
    old = warp_design(there, image_size, calibrated.distortion)
    new = warp_design(fit.pixels, image_size, fit.surface.distortion)
    # How the calibration's errors move the corners in the new picture.
    moves = np.linalg.solve(scales_at(fit.surface, fit.pixels), scales_at(calibrated, there) @ old)
    lens_columns = np.s_[HOMOGRAPHY_NUMBERS:]
    moves[:, :, lens_columns] -= new[:, :, lens_columns]
    change = np.zeros((WARP_NUMBERS, WARP_NUMBERS))
    change[:HOMOGRAPHY_NUMBERS] = fit.gain @ moves.reshape(-1, WARP_NUMBERS)
    change[lens_columns, lens_columns] = np.eye(WARP_NUMBERS - HOMOGRAPHY_NUMBERS)
    covariance = change @ calibrated_covariance @ change.T
    covariance[:HOMOGRAPHY_NUMBERS, :HOMOGRAPHY_NUMBERS] += fit.variance * fit.gain @ fit.gain.T
    return covariance
