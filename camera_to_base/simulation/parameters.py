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

from dataclasses import asdict, dataclass

from camera_to_base.image_size import ImageSize
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.simulation.conditions import BoardConditions
from camera_to_base.simulation.touch_table import SimulatedTouchTable


@dataclass(frozen=True)
class SimulationSettings:
    """How the simulated board is seen, and what kind of day it has."""

    tilt_deg: float
    seed: int
    frame_rate: float
    conditions: BoardConditions

    def board(self, image_size: ImageSize) -> SimulatedBoard:
        """Make the board, for pictures of a size."""
        return SimulatedBoard(
            image_size=image_size, tilt_deg=self.tilt_deg, seed=self.seed,
            frame_rate=self.frame_rate, **asdict(self.conditions))

    def touch_table(self, image_size: ImageSize) -> SimulatedTouchTable:
        """Make the same table with one object at rest."""
        return SimulatedTouchTable(
            image_size, tilt_deg=self.tilt_deg, seed=self.seed, frame_rate=self.frame_rate,
            **asdict(self.conditions))


def simulation_settings(
    tilt_deg: float, seed: int, frame_rate: float, **conditions
) -> SimulationSettings:
    """Make the simulation's settings of its parameters, named without 'simulated.'."""
    return SimulationSettings(tilt_deg, seed, frame_rate, BoardConditions(**conditions))
