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

"""From the parameters of the simulated board to its settings."""

from dataclasses import asdict, dataclass, fields
from typing import Any, Dict

from camera_to_base.coordinate_transform import TUTORIAL_WIDTH_CM
from camera_to_base.errors import HorizonError, InvalidValueError
from camera_to_base.image_size import ImageSize
from camera_to_base.markers import marker_cells
from camera_to_base.parameters import Values
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.simulation.camera_move import camera_move
from camera_to_base.simulation.conditions import BoardConditions
from camera_to_base.simulation.scene import SimulatedScene, Touch
from camera_to_base.simulation.touch_table import SimulatedTouchTable
from camera_to_base.simulation.view import BoardView


@dataclass(frozen=True)
class SimulationSettings:
    """
    How the simulated board is seen, and what kind of day it has.

    :param scene: What the camera sees; may change while the node runs.
    :param touch: What the robot touches; may change, too.
    """

    tilt_deg: float
    seed: int
    frame_rate: float
    scene: SimulatedScene
    touch: Touch
    conditions: BoardConditions

    def check_scene(self, image_size: ImageSize) -> None:
        """
        Check that the camera sees the table in all of its picture, and that markers can be drawn.

        :raises InvalidValueError: If the picture would reach the horizon.
        :raises CalibrationError: If OpenCV has no module aruco, and there are to be markers.
        """
        if self.scene.markers:
            marker_cells(0)
        try:
            BoardView(image_size, TUTORIAL_WIDTH_CM, self.tilt_deg, self.scene.move)
        except HorizonError as error:
            raise InvalidValueError(
                'simulated.tilt_deg and simulated.camera_tilt_deg tilt the camera so far that its '
                'picture reaches the horizon: tilt it less') from error

    def board(self, image_size: ImageSize) -> SimulatedBoard:
        """Make the board, for pictures of a size."""
        return SimulatedBoard(image_size=image_size, **self._everything)

    def touch_table(self, image_size: ImageSize) -> SimulatedTouchTable:
        """Make the same table with one object at rest."""
        return SimulatedTouchTable(image_size, **self._everything)

    @property
    def _everything(self) -> Dict[str, Any]:
        return {'tilt_deg': self.tilt_deg, 'seed': self.seed, 'frame_rate': self.frame_rate,
                'scene': self.scene, **asdict(self.conditions)}


def simulation_settings(values: Values) -> SimulationSettings:
    """Make the simulation's settings of its parameters, named without 'simulated.'."""
    return SimulationSettings(
        values['tilt_deg'], values['seed'], values['frame_rate'],
        SimulatedScene(values['shows'], values['placement'], values['markers'], values['table'],
                       camera_move(values)),
        Touch(values['touched'], values['touched_marker']),
        BoardConditions(**{field.name: values[field.name] for field in fields(BoardConditions)}))
