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

"""The parameters of `robot_base_publisher`, and the conversion that they make."""

from dataclasses import dataclass

from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.parameter_spec import ParameterSpec, Values

TRANSFORM_SPECS = [
    ParameterSpec('rotation_deg', [180.0, 0.0, 0.0],
                  'Rotation of the camera frame in the base frame: roll, pitch and yaw about the '
                  'fixed axes x, y and z, in degrees.'),
    ParameterSpec('displacement_cm', [-17.8, 24.4, 0.0],
                  "The camera frame's origin in the base frame: x, y and z, in cm."),
    ParameterSpec('reach_cm', 1000.0,
                  "A position farther than this from the robot's base, in cm, is dropped: set it "
                  "to your arm's reach.", (0.001, 1000000.0)),
]


@dataclass(frozen=True)
class TransformSettings:
    """All that `robot_base_publisher` takes from its parameters."""

    conversion: CameraToRobotBaseConversion
    reach_cm: float


def transform_node_settings(values: Values) -> TransformSettings:
    """
    Make the transform node's settings of its parameters.

    :raises CameraToBaseError: If they cannot be used.
    """
    return TransformSettings(transform_settings(values), values['reach_cm'])


def transform_settings(values: Values) -> CameraToRobotBaseConversion:
    """
    Make the transform node's conversion of its parameters.

    :raises CameraToBaseError: If either is not three finite numbers.
    """
    return CameraToRobotBaseConversion.from_roll_pitch_yaw(
        values['rotation_deg'], values['displacement_cm'])
