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

"""Makes the uncertainty of positions of its parameters."""

from camera_to_base.parameters import Values
from camera_to_base.uncertainty.height import CameraPlace
from camera_to_base.uncertainty.position import PositionUncertainty, SurfaceModel
from camera_to_base.uncertainty.specs import (
    CENTRE_FLOOR, HEIGHT_TOLERANCE, SURFACE_COVARIANCE, surface_covariance)
import numpy as np


def position_uncertainty(values: Values, surface: SurfaceModel) -> PositionUncertainty:
    """
    Make the uncertainty of positions in the camera frame.

    :param values: The camera node's parameters, by full name.
    :param surface: Made of the same parameters.
    :raises InvalidValueError: If surface.covariance is no covariance.
    """
    camera = None
    height_cm, foot = values['surface.camera_height_cm'], values['surface.camera_foot_cm']
    if height_cm > values['object_height_cm']:
        if not foot and values['surface.model'] == 'parallel':
            foot = surface.locate([np.subtract(values['surface.image_size'], 1) / 2])[0].tolist()
        if foot:
            camera = CameraPlace(tuple(foot), height_cm - values['object_height_cm'])
    return PositionUncertainty(
        surface, surface_covariance(values[SURFACE_COVARIANCE]), camera,
        values[CENTRE_FLOOR], values[HEIGHT_TOLERANCE], values['detector.method'] == 'tutorial')
