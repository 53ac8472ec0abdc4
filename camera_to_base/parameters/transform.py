# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The parameters of `robot_base_publisher`, and the conversion made from them."""

from dataclasses import dataclass
import math
from typing import Tuple

from camera_to_base.checks import frame_id
from camera_to_base.coordinate_transform import (
    CameraToRobotBaseConversion, Pose, TUTORIAL_DISPLACEMENT_CM, TUTORIAL_ROTATION_DEG)
from camera_to_base.errors import OtherFrameError, OutOfReachError
from camera_to_base.parameters.file import calibration_summary, RECORD_SPECS
from camera_to_base.parameters.spec import ParameterSpec, Values

PLACEMENT_SPECS = [
    ParameterSpec('rotation_deg', list(TUTORIAL_ROTATION_DEG),
                  'Rotation of the camera frame in the base frame: roll, pitch and yaw about the '
                  'fixed axes x, y and z.', unit='deg', lengths=(3,)),
    ParameterSpec('displacement_cm', list(TUTORIAL_DISPLACEMENT_CM),
                  "The camera frame's origin in the base frame: x, y and z.",
                  unit='cm', lengths=(3,)),
]
# In both nodes: one writes the frame into its messages, the other refuses other frames.
CAMERA_FRAME_SPEC = ParameterSpec(
    'camera_frame_id', 'camera_surface',
    "The stamped topics' name for the camera frame, which lies on the surface; "
    'robot_base_publisher drops what is stamped in another frame.',
    constraints='a frame name without a leading /')
# If one of these is set, a robot is set up.
TRANSFORM_SETUP_SPECS = [
    *PLACEMENT_SPECS,
    ParameterSpec('reach_cm', 1000.0,
                  "A position farther than this from the robot's base is dropped: set it to your "
                  "arm's reach.", (0.001, 1000000.0), unit='cm'),
]
TRANSFORM_SPECS = [
    *TRANSFORM_SETUP_SPECS,
    ParameterSpec('base_frame_id', 'base_link',
                  "The stamped topics' name for the robot's base frame.",
                  constraints='a frame name without a leading /'),
    CAMERA_FRAME_SPEC,
    ParameterSpec('base_covariance', [],
                  'How uncertain rotation_deg and displacement_cm are: the upper triangle of the '
                  "covariance of the camera frame's origin, in cm, and of the rotation, in rad, "
                  'in the base frame; `calibrate base` writes it. Empty for not known: 1 cm and '
                  '1 degree.', lengths=(0, 21)),
    *RECORD_SPECS,
]


@dataclass(frozen=True)
class TransformSettings:
    """
    The settings of `robot_base_publisher`.

    :param calibration: What the parameters hold of a calibration, in one line.
    """

    conversion: CameraToRobotBaseConversion
    reach_cm: float
    base_frame_id: str
    camera_frame_id: str
    calibration: str = ''
    base_covariance: Tuple[float, ...] = ()

    def check_frame(self, name: str) -> None:
        """
        Check the coordinate frame of a position.

        :param name: The message's frame_id; an empty one means the camera frame.
        :raises OtherFrameError: If it names another frame.
        """
        if name.lstrip('/') not in ('', self.camera_frame_id):
            raise OtherFrameError(
                f"its frame_id is '{name[:80]}', not '{self.camera_frame_id}': send positions in "
                'the camera frame, or give both nodes the same camera_frame_id')

    def base_point(self, x: float, y: float, z: float = 0.0) -> Tuple[float, float, float]:
        """
        Convert a point from the camera frame to the base frame.

        :param x: In cm; y and z, too.
        :returns: x, y and z, in cm.
        :raises InvalidValueError: If a number is not finite.
        :raises OutOfReachError: If it is farther from the base than the arm can reach.
        """
        base_point = self.conversion.convert_point(x, y, z)
        if math.hypot(*base_point[:2]) > self.reach_cm:
            raise OutOfReachError(
                f'({base_point[0]:g}, {base_point[1]:g}) cm in the base frame is beyond '
                f'reach_cm, {self.reach_cm:g} cm')
        return base_point

    def base_pose(self, pose: Pose) -> Pose:
        """
        Convert a pose from the camera frame to the base frame.

        :raises CameraToBaseError: As :meth:`base_point`.
        """
        return Pose(*self.base_point(*pose[:3]), self.conversion.convert_yaw(pose.yaw))


def transform_node_settings(values: Values) -> TransformSettings:
    """
    Make the transform node's settings from its parameters.

    :raises CameraToBaseError: If they cannot be used.
    """
    return TransformSettings(
        transform_settings(values), values['reach_cm'],
        frame_id('base_frame_id', values['base_frame_id']),
        frame_id('camera_frame_id', values['camera_frame_id']), calibration_summary(values),
        tuple(values['base_covariance']))


def transform_settings(values: Values) -> CameraToRobotBaseConversion:
    """
    Make the conversion from its parameters.

    :raises CameraToBaseError: If either is not three finite numbers.
    """
    return CameraToRobotBaseConversion.from_roll_pitch_yaw(
        values['rotation_deg'], values['displacement_cm'])
