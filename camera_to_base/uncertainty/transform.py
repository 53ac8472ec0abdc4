# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The transform into the base frame with its uncertainty, and ellipses that contain the errors."""

from dataclasses import dataclass
import math
from typing import NamedTuple, Sequence

from camera_to_base.parameters import transform_node_settings, TransformSettings, Values
from camera_to_base.uncertainty.calibration_error import (
    base_covariance, POSE_NUMBERS, UNKNOWN_BASE)
from camera_to_base.uncertainty.covariance import checked_covariance
import numpy as np


class Ellipse(NamedTuple):
    """
    An ellipse about a position.

    :param long: Its long half axis, in the unit of the covariance's root.
    :param short: Its short half axis.
    :param angle: Direction of the long axis, from x towards y, in rad, in (-pi/2, pi/2].
    """

    long: float
    short: float
    angle: float


def radius_for(share: float) -> float:
    """
    Return how many standard deviations an ellipse needs to contain a share of all errors.

    In two dimensions a squared normal error is exponentially distributed.

    :param share: At least 0, below 1.
    """
    return math.sqrt(-2 * math.log(1 - share))


def error_ellipse(covariance: np.ndarray, share: float) -> Ellipse:
    """
    Return the ellipse that contains a share of all normal errors.

    :param covariance: Shape (2, 2), or larger: its first two rows and columns are used.
    """
    xx, xy, yy = float(covariance[0, 0]), float(covariance[0, 1]), float(covariance[1, 1])
    both, difference = (xx + yy) / 2, math.hypot(xy, (xx - yy) / 2)
    radius = radius_for(share)
    return Ellipse(radius * math.sqrt(max(both + difference, 0.0)),
                   radius * math.sqrt(max(both - difference, 0.0)),
                   math.atan2(2 * xy + 0.0, xx - yy) / 2)


def ellipse_covariance(ellipse: Ellipse, share: float) -> np.ndarray:
    """
    Return the covariance whose ellipse for a share this is.

    :returns: Shape (2, 2).
    """
    radius = radius_for(share)
    long, short = (ellipse.long / radius) ** 2, (ellipse.short / radius) ** 2
    cosine, sine = math.cos(ellipse.angle), math.sin(ellipse.angle)
    both = (long - short) * cosine * sine
    return np.array([[long * cosine ** 2 + short * sine ** 2, both],
                     [both, long * sine ** 2 + short * cosine ** 2]])


@dataclass(frozen=True)
class UncertainTransform:
    """
    The transform into the base frame, with its uncertainty.

    :param settings: The transform.
    :param covariance: Of the camera frame's pose in the base frame, shape (6, 6), in cm and rad.
    """

    settings: TransformSettings
    covariance: np.ndarray

    @property
    def rotation(self) -> np.ndarray:
        """From the camera frame to the base frame, shape (3, 3)."""
        return self.settings.conversion.base_from_camera[:3, :3]

    def base_covariance(self, point: Sequence[float], covariance: np.ndarray) -> np.ndarray:
        """
        Convert the covariance of a pose from the camera frame to the base frame.

        :param point: x, y and z of the pose, in cm, in the camera frame.
        :param covariance: Of x, y, z (cm) and the rotations about them (rad), shape (6, 6).
        :returns: Shape (6, 6), in the base frame, with what the transform makes uncertain.
        """
        return base_covariance(covariance, np.asarray(point, float), self.rotation,
                               self.covariance)


def uncertain_transform(settings: TransformSettings) -> UncertainTransform:
    """
    Make the transform with its uncertainty of its settings.

    :raises InvalidValueError: If base_covariance is no covariance.
    """
    numbers = settings.base_covariance
    return UncertainTransform(settings, UNKNOWN_BASE if not numbers else checked_covariance(
        'base_covariance', numbers, POSE_NUMBERS))


def uncertain_transform_of(values: Values) -> UncertainTransform:
    """
    Make the transform with its uncertainty of the transform node's parameters.

    :raises CameraToBaseError: If they cannot be used.
    """
    return uncertain_transform(transform_node_settings(values))
