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

from typing import List, Optional, Tuple

from camera_to_base.image_size import ImageSize
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.simulation.robot import SimulatedRobot
from camera_to_base.simulation.view import Oval
import numpy as np

_DIAMETER_CM = 2.4


class SimulatedTouchTable(SimulatedBoard):
    """
    The simulated board with one coin at rest, or none.

    :param image_size: Width and height, in px.
    :param others: See :class:`SimulatedBoard`.
    """

    def __init__(self, image_size: ImageSize, **others) -> None:
        super().__init__(image_size=image_size, **others)
        self._point: Optional[Tuple[float, float]] = None
        self._robot = SimulatedRobot(np.random.default_rng(self._seed))

    def lay_coin(self, pixel: Tuple[float, float]) -> None:
        """Lay the coin on the surface where a pixel shows it."""
        self._point = self._view.point(pixel)

    def robot_position(self) -> Tuple[float, float]:
        """
        Return what the display of the tutorial's robot shows when it touches the coin.

        :returns: x and y, in cm, in the base frame, with an error of a few tenths of a mm.
        """
        return self._shown(self._point)

    def robot_position_at(self, marker: int) -> Optional[Tuple[float, float]]:
        """Return what the display shows when it touches a marker's middle; None without it."""
        corners = self.true_markers.get(marker)
        return None if corners is None else self._shown(tuple(corners.mean(axis=0)))

    def _shown(self, point: Tuple[float, float]) -> Tuple[float, float]:
        x, y = self._robot.touch(point)
        self._robot.renew_error()
        return round(x, 2), round(y, 2)

    def _ovals(self, number: int) -> List[Oval]:
        if self._point is None:
            return []
        return [Oval(self._point, _DIAMETER_CM / 2, _DIAMETER_CM / 2, 0.0)]
