# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The simulated surface: frames of a rendered table whose objects' positions are known.

In: a surface, a picture size, a seed and the parameters `simulated.*`. Out: frames, as every other
source gives them, the true positions, where the simulated robot touches, and a chessboard to
calibrate the simulated camera with.

Callers: `settings`, `nodes`, `commands` and benchmarks. No detector imports it.
"""

from camera_to_base.simulation.board import (
    SimulatedBoard, SimulatedRobot, SimulatedScene, SimulatedTouchTable, simulation_settings,
    SimulationSettings, Touch)
from camera_to_base.simulation.disturbances import BoardConditions
from camera_to_base.simulation.printed import SimulatedChessboard
from camera_to_base.simulation.specs import SIMULATION_SPECS
from camera_to_base.simulation.table import TrueObject
from camera_to_base.simulation.view import CameraMove, move_parameters

__all__ = [
    'BoardConditions', 'CameraMove', 'move_parameters', 'SimulatedBoard', 'SimulatedChessboard',
    'SimulatedRobot', 'SimulatedScene', 'SimulatedTouchTable', 'simulation_settings',
    'SIMULATION_SPECS', 'SimulationSettings', 'Touch', 'TrueObject',
]
