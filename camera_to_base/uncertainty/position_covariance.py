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

"""What the uncertainty of a position is made of and given as."""

import math
from typing import NamedTuple

from camera_to_base.image_size import ImageSize
from camera_to_base.uncertainty.centre import UNKNOWN_ANGLE
import numpy as np

# How far a table is from flat is not measured.
LEAST_Z_CM = 0.1
# What cannot be computed is not known: 10 m.
_UNKNOWN_CM2 = 1e6


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
