# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Uncertainty: how far a position may be off, as a covariance.

In: shapes of detected objects in px, a calibration with its covariance, pairs of points.
Out: covariances of positions, in cm and rad, in the camera frame and in the base frame; ellipses.

The terms of the picture are in `terms`, those of the calibration in `calibration_error`;
`position` adds them up.

Callers: see the arrows in CONTRIBUTING. It imports numpy alone: the transform node starts without
OpenCV.
"""

from camera_to_base.uncertainty.calibration_error import (
    base_covariance, base_error, fit_error, FitError, pooled_variance)
from camera_to_base.uncertainty.covariance import (
    CAMERA_COVARIANCE, camera_covariance, CENTRE_FLOOR, checked_covariance, FrameState,
    HEIGHT_TOLERANCE, place_95, PositionCovariance, SURFACE_COVARIANCE, surface_covariance,
    symmetric, triangle_length, triangle_of, UNCERTAINTY_SPECS)
from camera_to_base.uncertainty.position import (
    position_uncertainty, PositionUncertainty, scales_at)
from camera_to_base.uncertainty.terms import (
    centre_covariance, height_slopes, HOMOGRAPHY_NUMBERS, Lens, likely_place, Shape,
    ShiftMean, Spread, UNKNOWN_ANGLE, warp_design, WARP_NUMBERS, yaw_variance)
from camera_to_base.uncertainty.transform import (
    Ellipse, ellipse_covariance, error_ellipse, radius_for, uncertain_transform,
    uncertain_transform_of, UncertainTransform)

__all__ = [
    'base_covariance', 'base_error', 'CAMERA_COVARIANCE', 'camera_covariance',
    'centre_covariance', 'CENTRE_FLOOR', 'checked_covariance', 'Ellipse', 'ellipse_covariance',
    'error_ellipse', 'fit_error', 'FitError', 'FrameState', 'height_slopes',
    'HEIGHT_TOLERANCE', 'HOMOGRAPHY_NUMBERS', 'Lens', 'likely_place', 'place_95',
    'pooled_variance', 'position_uncertainty', 'PositionCovariance', 'PositionUncertainty',
    'radius_for', 'scales_at', 'Shape', 'ShiftMean', 'Spread', 'SURFACE_COVARIANCE',
    'surface_covariance', 'symmetric', 'triangle_length', 'triangle_of', 'uncertain_transform',
    'uncertain_transform_of', 'UncertainTransform', 'UNCERTAINTY_SPECS', 'UNKNOWN_ANGLE',
    'warp_design', 'WARP_NUMBERS', 'yaw_variance',
]
