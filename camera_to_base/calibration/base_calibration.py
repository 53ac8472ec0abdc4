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

"""Computes the transform into the base frame from pairs of points, and reports the errors."""

from typing import Any, Mapping, Optional

from camera_to_base.calibration.checks.base_checks import (
    check_pairs, check_with_surface, check_without_surface)
from camera_to_base.calibration.covariances import transform_error
from camera_to_base.calibration.error_map import ErrorMap
from camera_to_base.calibration.figures import error_figures, warnings
from camera_to_base.calibration.fits.rigid_fit import fit_rigid
from camera_to_base.calibration.result import (
    Calibration, figure_fields, origin_fields, refuse_too_many)
from camera_to_base.surface import PointPairs
from camera_to_base.uncertainty import triangle_of
import numpy as np


def calibrate_base(
    pairs: PointPairs, *, source: str, surface_values: Optional[Mapping[str, Any]] = None,
    base_z: str = 'up', points_are: str = 'row',
) -> Calibration:
    """
    Fit the transform from the camera frame to the base frame.

    :param source: The pairs' origin, for the report.
    :param surface_values: The parameters of the surface that the camera points were measured
        with, by full name; None if they are not known.
    :param base_z: Direction of the base frame's z at the table: 'up', away from it, or 'down'.
    :param points_are: The report's word for a pair.
    :raises CameraToBaseError: If the pairs do not determine the transform, no transform fits them,
        or they do not fit the surface.
    """
    refuse_too_many(len(pairs))
    fit = fit_rigid(pairs)
    doubts = check_pairs(pairs, fit)
    if surface_values is None:
        doubts += check_without_surface(pairs)
    else:
        doubts += check_with_surface(pairs, fit, surface_values, base_z)
    left_out = fit.left_out_residuals
    figures = error_figures(
        np.linalg.norm(fit.residuals, axis=1), pairs.rows,
        None if left_out is None else np.linalg.norm(left_out, axis=1))
    found = {'rotation_deg': list(fit.rotation_deg),
             'displacement_cm': list(fit.displacement_cm)}
    values = {**found, 'base_covariance': triangle_of(transform_error(pairs, fit))}
    report = {**origin_fields('rigid', source), **found, **figure_fields(figures, points_are),
              'warnings': [*warnings(figures), *doubts]}
    if surface_values is not None:
        report.update(ErrorMap({**surface_values, **values}).fields)
    return Calibration(report, values)
