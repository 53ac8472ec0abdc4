# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The covariance of a position: what it is made of, its parameters, and matrices as parameters."""

import math
from typing import Dict, List, NamedTuple, Sequence

from camera_to_base.checks import ImageSize
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import ParameterSpec
from camera_to_base.uncertainty.terms import HOMOGRAPHY_NUMBERS, UNKNOWN_ANGLE, WARP_NUMBERS
import numpy as np

SURFACE_COVARIANCE = 'surface.covariance'
CAMERA_COVARIANCE = 'surface.camera_covariance'
# Foot point, x and y, height, and focal length.
PLACE_NUMBERS = 4
CENTRE_FLOOR = 'uncertainty.centre_floor_px'
HEIGHT_TOLERANCE = 'uncertainty.height_tolerance_cm'

# How far a table is from flat is not measured.
LEAST_Z_CM = 0.1
# What cannot be computed is not known: 10 m.
_UNKNOWN_CM2 = 1e6


def triangle_length(size: int) -> int:
    """Return how many numbers the upper triangle of a matrix of shape (size, size) has."""
    return size * (size + 1) // 2


def triangle_of(matrix: np.ndarray) -> List[float]:
    """
    Return the upper triangle of a symmetric matrix, row by row.

    :param matrix: Shape (n, n).
    """
    return matrix[np.triu_indices(len(matrix))].tolist()


def symmetric(numbers: Sequence[float], size: int) -> np.ndarray:
    """
    Return the symmetric matrix of an upper triangle, of shape (size, size).

    :param numbers: As many as :func:`triangle_length` says, row by row.
    """
    matrix = np.zeros((size, size))
    matrix[np.triu_indices(size)] = numbers
    return matrix + np.triu(matrix, 1).T


UNCERTAINTY_SPECS: List[ParameterSpec] = [
    ParameterSpec(SURFACE_COVARIANCE, [],
                  'How uncertain the calibration is: the upper triangle of the covariance of the '
                  "picture's warp, 8 numbers of a homography and 6 of the lens, in halves of the "
                  "picture's diagonal; `calibrate` writes it. Empty for not known: about 5 mm in "
                  'the centre and 15 mm in the corners of a picture that is 36 cm wide.',
                  lengths=(0, triangle_length(WARP_NUMBERS))),
    ParameterSpec(CAMERA_COVARIANCE, [],
                  "How uncertain the camera's place and lens are: the upper triangle of the "
                  "covariance of the foot point's x and y (cm), the height (cm) and the focal "
                  'length (px); `calibrate board` writes it. Empty for not known.',
                  lengths=(0, triangle_length(PLACE_NUMBERS))),
    ParameterSpec(CENTRE_FLOOR, 0.2,
                  "Standard deviation of u and v of an object's centre that light causes: shade, "
                  'highlights, shining edges.', (0, 1000), unit='px'),
    ParameterSpec(HEIGHT_TOLERANCE, 0.1,
                  'Standard deviation of object_height_cm: by how much the heights of your '
                  'objects differ from it.', (0, 1000), unit='cm'),
]
# Standard deviations that hold 95 % along a line, and in a plane.
_ALONG_A_LINE, _IN_A_PLANE = 1.96, 2.4477
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


def camera_covariance(numbers: Sequence[float]) -> np.ndarray:
    """
    Make the covariance of the camera's place of its parameter.

    :param numbers: 'surface.camera_covariance'; empty where it is not known, which gives zeros.
    :returns: Shape (4, 4), of the foot point's x and y and of the height, in cm, and of the focal
        length, in px.
    :raises InvalidValueError: If they are no covariance.
    """
    if not len(numbers):
        return np.zeros((PLACE_NUMBERS, PLACE_NUMBERS))
    return checked_covariance(CAMERA_COVARIANCE, numbers, PLACE_NUMBERS)


def place_95(covariance: np.ndarray) -> Dict[str, float]:
    """
    Tell within how much the camera's true place and lens lie with a chance of 95 %.

    :param covariance: Shape (4, 4), see :func:`camera_covariance`.
    """
    along = np.linalg.eigvalsh(covariance[:2, :2])[-1]
    return {'height_cm_95': round(_ALONG_A_LINE * float(np.sqrt(covariance[2, 2])), 4),
            'foot_cm_95': round(_IN_A_PLANE * float(np.sqrt(max(along, 0.0))), 4),
            'focal_px_95': round(_ALONG_A_LINE * float(np.sqrt(covariance[3, 3])), 3)}


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


class FrameState(NamedTuple):
    """
    What a frame tells beside its objects.

    :param image_size: Width and height, in px.
    :param noise: Deviation of the sensor's noise, grey levels; NaN for not known.
    :param shift_px: Deviation of the view's shift that was not corrected, of u and v, in px.
    """

    image_size: ImageSize
    noise: float = math.nan
    shift_px: float = 0.0


class PositionCovariance(NamedTuple):
    """
    The covariance of a position on the surface.

    :param xx: Variance of x, in cm²; xy and yy, too.
    :param zz: Variance of z, in cm².
    :param yaw: Variance of the direction about z, in rad², independent of the position.
    """

    xx: float
    xy: float
    yy: float
    zz: float
    yaw: float

    @property
    def matrix(self) -> np.ndarray:
        """
        The covariance of a pose in the camera frame.

        :returns: Shape (6, 6), of x, y, z in cm and the rotations about them in rad. How an object
            is tilted is not known.
        """
        matrix = np.diag([self.xx, self.yy, self.zz, UNKNOWN_ANGLE, UNKNOWN_ANGLE, self.yaw])
        matrix[0, 1] = matrix[1, 0] = self.xy
        return matrix


UNKNOWN_POSITION = PositionCovariance(
    _UNKNOWN_CM2, 0.0, _UNKNOWN_CM2, _UNKNOWN_CM2, UNKNOWN_ANGLE)
