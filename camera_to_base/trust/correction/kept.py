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

"""The parameters of the surface in force, so that a correction can be kept."""

from typing import Any, Dict, Optional

from camera_to_base.errors import InvalidValueError
from camera_to_base.image_size import ImageSize
from camera_to_base.surface import (
    as_homography, flat_surface, Hull, RaisedSurface, Surface, surface_values)
from camera_to_base.trust.surface_in_force import SurfaceInForce
from camera_to_base.uncertainty import PositionUncertainty, SURFACE_COVARIANCE, triangle_of
import numpy as np


def kept_values(
    in_force: SurfaceInForce, calibrated: Surface, uncertainty: PositionUncertainty,
    hull: Optional[Hull], size: ImageSize,
) -> Dict[str, Any]:
    """
    Give the parameters that make the surface in force the calibrated one.

    :param calibrated: The surface of the present parameters.
    :param uncertainty: That of the calibration.
    :param hull: The area of the calibration; None for not known.
    :param size: Width and height of the pictures, in px.
    :returns: By full name.
    :raises InvalidValueError: If there is no parameter for such a surface.
    """
    found = as_homography(flat_surface(in_force.surface), size)
    if found is None:
        raise InvalidValueError(
            "a correction of the tutorial's polynomial cannot be kept: calibrate anew, with the "
            'model homography')
    values = surface_values(found, _moved(hull, in_force))
    values[SURFACE_COVARIANCE] = triangle_of(in_force.uncertainty(uncertainty).warp_covariance)
    if isinstance(calibrated, RaisedSurface):
        # A parallel camera need not say it.
        values['surface.camera_foot_cm'] = calibrated.foot_cm.tolist()
    return values


def _moved(hull: Optional[Hull], in_force: SurfaceInForce) -> Optional[Hull]:
    if hull is None or in_force.frame_from_calibrated is None:
        return None
    moved = in_force.frame_from_calibrated.pixels(hull.corners)
    return Hull(moved) if np.isfinite(moved).all() else None
