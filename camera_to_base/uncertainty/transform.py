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

"""The transform into the base frame, with its uncertainty."""

from dataclasses import dataclass
from typing import Sequence

from camera_to_base.parameters import transform_node_settings, TransformSettings, Values
from camera_to_base.uncertainty.base import base_covariance, POSE_NUMBERS, UNKNOWN_BASE
from camera_to_base.uncertainty.specs import checked_covariance
import numpy as np


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
