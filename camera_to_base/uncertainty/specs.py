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

"""The parameters of the uncertainty, and the matrices made of them."""

from typing import List, Sequence

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import ParameterSpec
from camera_to_base.uncertainty.picture_warp import HOMOGRAPHY_NUMBERS, WARP_NUMBERS
from camera_to_base.uncertainty.triangle import symmetric, triangle_length
import numpy as np

SURFACE_COVARIANCE = 'surface.covariance'
CENTRE_FLOOR = 'uncertainty.centre_floor_px'
HEIGHT_TOLERANCE = 'uncertainty.height_tolerance_cm'

UNCERTAINTY_SPECS: List[ParameterSpec] = [
    ParameterSpec(SURFACE_COVARIANCE, [],
                  'How uncertain the calibration is: the upper triangle of the covariance of the '
                  "picture's warp, 8 numbers of a homography and 6 of the lens, in halves of the "
                  "picture's diagonal; `calibrate` writes it. Empty for not known: about 5 mm in "
                  'the centre and 15 mm in the corners of a picture that is 36 cm wide.',
                  lengths=(0, triangle_length(WARP_NUMBERS))),
    ParameterSpec(CENTRE_FLOOR, 0.2,
                  "Standard deviation of u and v of an object's centre that light causes: shade, "
                  'highlights, shining edges.', (0, 1000), unit='px'),
    ParameterSpec(HEIGHT_TOLERANCE, 0.1,
                  'Standard deviation of object_height_cm: by how much the heights of your '
                  'objects differ from it.', (0, 1000), unit='cm'),
]
# Without a measured covariance.
_UNKNOWN_HOMOGRAPHY, _UNKNOWN_LENS = 0.02, (0.05, 0.0, 0.0, 0.0, 0.0, 0.0)
# Rounding may make an eigenvalue slightly negative.
_ROUNDING = 1e-6


def surface_covariance(numbers: Sequence[float]) -> np.ndarray:
    """
    Make the covariance of the picture's warp of its parameter.

    :param numbers: 'surface.covariance'; empty for a calibration that does not know it.
    :returns: Shape (14, 14).
    :raises InvalidValueError: If they are no covariance.
    """
    if not len(numbers):
        return np.diag(np.square([_UNKNOWN_HOMOGRAPHY] * HOMOGRAPHY_NUMBERS + [*_UNKNOWN_LENS]))
    return checked_covariance(SURFACE_COVARIANCE, numbers, WARP_NUMBERS)


def checked_covariance(name: str, numbers: Sequence[float], size: int) -> np.ndarray:
    """
    Make a covariance of its upper triangle.

    :param name: Its name in the error.
    :returns: Shape (size, size).
    :raises InvalidValueError: If a variance or an eigenvalue is negative.
    """
    matrix = symmetric(numbers, size)
    with np.errstate(all='ignore'):
        deviations = np.sqrt(np.diag(matrix))
        scale = np.where(deviations > 0, deviations, 1.0)
        relative = matrix / scale[:, None] / scale
    if not np.isfinite(relative).all() or np.linalg.eigvalsh(relative)[0] < -_ROUNDING * size:
        raise InvalidValueError(
            f'{name} must be the upper triangle of a covariance matrix, as `calibrate` writes it')
    return matrix
