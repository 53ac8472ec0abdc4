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

"""What the simulated camera sees: what lies on which table, and from where."""

from typing import NamedTuple

from camera_to_base.simulation.camera_move import CameraMove
from camera_to_base.simulation.specs import SIMULATION_DEFAULTS as _DEFAULTS


class SimulatedScene(NamedTuple):
    """
    What the simulated camera sees; it may change between two frames.

    :param shows: One of `specs.SHOWN`.
    :param placement: Where the chessboard lies, from 1, see `board_placement`.
    :param markers: Whether the markers lie on the table.
    :param table: One of `specs.TABLES`.
    :param move: How the camera was moved since the start.
    """

    shows: str = _DEFAULTS['shows']
    placement: int = _DEFAULTS['placement']
    markers: bool = _DEFAULTS['markers']
    table: str = _DEFAULTS['table']
    move: CameraMove = CameraMove()


class Touch(NamedTuple):
    """
    What the simulated robot touches.

    :param number: The object's, 1 for the largest in the picture; 0 for none.
    :param marker: The marker's, which comes first; -1 for none.
    """

    number: int = _DEFAULTS['touched']
    marker: int = _DEFAULTS['touched_marker']
