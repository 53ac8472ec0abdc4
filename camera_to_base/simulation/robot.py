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

"""The simulated robot, which touches what lies on the simulated table."""

from typing import Tuple

from camera_to_base.coordinate_transform import (
    CameraToRobotBaseConversion, TUTORIAL_DISPLACEMENT_CM, TUTORIAL_ROTATION_DEG)
import numpy as np

# Of a gripper tip on the middle of a coin, in each direction.
_TOUCH_ERROR_CM = 0.03


class SimulatedRobot:
    """
    A robot that stands beside the table as the tutorial's does.

    :param random: Makes the errors of its touches.
    """

    def __init__(self, random: np.random.Generator) -> None:
        self._random = random
        self._base_from_camera = CameraToRobotBaseConversion.from_roll_pitch_yaw(
            TUTORIAL_ROTATION_DEG, TUTORIAL_DISPLACEMENT_CM)
        self.renew_error()

    def renew_error(self) -> None:
        """Touch anew: with another error, which stays the same while the tool touches."""
        self._error = self._random.normal(0.0, _TOUCH_ERROR_CM, 2)

    def touch(self, point: Tuple[float, float]) -> Tuple[float, float]:
        """
        Return where the tool is.

        :param point: What it touches, x and y, in cm, in the camera frame of the uncalibrated
            simulated camera.
        :returns: x and y, in cm, in the base frame, with an error of a few tenths of a mm.
        """
        x, y, _ = self._base_from_camera.convert_point(*point)
        return float(x + self._error[0]), float(y + self._error[1])
