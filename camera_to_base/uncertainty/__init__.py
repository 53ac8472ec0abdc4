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
Uncertainty: how far a position may be off, as a covariance.

In: shapes of detected objects in px, a calibration with its covariance, pairs of points.
Out: covariances of positions, in cm and rad, in the camera frame and in the base frame; ellipses.

Each term has a module of its own: `centre` (detection), `surface_fit` with `picture_warp`, `base`,
`height`, `view`.

Callers: all rooms below. It imports numpy alone: the transform node starts without OpenCV.
"""

from camera_to_base.uncertainty.base import (
    base_covariance, base_error, pose_design, POSE_NUMBERS, UNKNOWN_BASE)
from camera_to_base.uncertainty.centre import (
    centre_covariance, Shape, Spread, UNKNOWN_ANGLE, yaw_variance)
from camera_to_base.uncertainty.ellipse import (
    Ellipse, ellipse_covariance, error_ellipse, radius_for)
from camera_to_base.uncertainty.from_parameters import position_uncertainty
from camera_to_base.uncertainty.height import CameraPlace, height_slopes, likely_place
from camera_to_base.uncertainty.picture_warp import (
    HOMOGRAPHY_NUMBERS, Lens, warp_design, WARP_NUMBERS)
from camera_to_base.uncertainty.position import PositionUncertainty, scales_at
from camera_to_base.uncertainty.position_covariance import FrameState, PositionCovariance
from camera_to_base.uncertainty.scatter import pooled_variance
from camera_to_base.uncertainty.specs import (
    CENTRE_FLOOR, checked_covariance, HEIGHT_TOLERANCE, SURFACE_COVARIANCE, surface_covariance,
    UNCERTAINTY_SPECS)
from camera_to_base.uncertainty.surface_fit import fit_error, FitError, LENS_DEVIATIONS
from camera_to_base.uncertainty.transform import (
    uncertain_transform, uncertain_transform_of, UncertainTransform)
from camera_to_base.uncertainty.triangle import symmetric, triangle_length, triangle_of
from camera_to_base.uncertainty.view import ShiftMean

__all__ = [
    'base_covariance', 'base_error', 'CameraPlace', 'centre_covariance',
    'CENTRE_FLOOR', 'checked_covariance', 'Ellipse', 'ellipse_covariance', 'error_ellipse',
    'fit_error', 'FitError', 'FrameState', 'height_slopes', 'HEIGHT_TOLERANCE',
    'HOMOGRAPHY_NUMBERS', 'Lens', 'LENS_DEVIATIONS', 'likely_place',
    'pooled_variance', 'pose_design', 'POSE_NUMBERS', 'position_uncertainty', 'PositionCovariance',
    'PositionUncertainty', 'radius_for', 'scales_at', 'Shape', 'ShiftMean', 'Spread',
    'surface_covariance', 'SURFACE_COVARIANCE', 'symmetric', 'triangle_length', 'triangle_of',
    'uncertain_transform', 'uncertain_transform_of', 'UncertainTransform', 'UNCERTAINTY_SPECS',
    'UNKNOWN_ANGLE', 'UNKNOWN_BASE', 'warp_design', 'WARP_NUMBERS', 'yaw_variance',
]
