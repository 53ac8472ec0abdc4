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

"""The simulated surface with one object at rest, and a robot that touches it."""

from typing import Optional, Tuple

from camera_to_base.coordinate_transform import (
    CameraToRobotBaseConversion, TUTORIAL_DISPLACEMENT_CM, TUTORIAL_ROTATION_DEG)
from camera_to_base.image_size import ImageSize
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.simulation.drawing import draw_oval
from camera_to_base.simulation.view import Oval
import numpy as np

_DIAMETER_CM = 2.4
# Of a gripper tip on the middle of a coin, in each direction.
_TOUCH_ERROR_CM = 0.03


class SimulatedTouchTable(SimulatedBoard):
    """
    The simulated board with one coin at rest, or none.

    :param image_size: Width and height, in px.
    :param others: See :class:`SimulatedBoard`.
    """

    def __init__(self, image_size: ImageSize, **others) -> None:
        super().__init__(image_size=image_size, **others)
        self._point: Optional[Tuple[float, float]] = None
        self._touch = np.random.default_rng(self._seed)

    def lay_coin(self, pixel: Tuple[float, float]) -> None:
        """Lay the coin on the surface where a pixel shows it."""
        u, v, w = self.surface_from_pixel @ [*pixel, 1.0]
        self._point = float(u / w), float(v / w)

    def read(self) -> np.ndarray:
        """Render the next frame: shape (h, w, 3), uint8, BGR."""
        number, self._frame_count = self._frame_count, self._frame_count + 1
        picture = self._table.copy()
        if self._point is not None:
            coin = Oval(self._point, _DIAMETER_CM / 2, _DIAMETER_CM / 2, 0.0)
            draw_oval(picture, coin, self._view, self._conditions)
        self._disturbances.disturb(picture, number, self._rounds(number))
        return np.clip(np.rint(picture), 0, 255).astype(np.uint8)

    def robot_position(self) -> Tuple[float, float]:
        """
        Return what the display of the tutorial's robot shows when it touches the coin.

        :returns: x and y, in cm, in the base frame, with an error of a few tenths of a mm.
        """
        conversion = CameraToRobotBaseConversion.from_roll_pitch_yaw(
            TUTORIAL_ROTATION_DEG, TUTORIAL_DISPLACEMENT_CM)
        error = self._touch.normal(0.0, _TOUCH_ERROR_CM, 2)
        x, y, _ = conversion.convert_point(*self._point)
        return round(x + error[0], 2), round(y + error[1], 2)
