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

"""The service that bumps the simulated camera."""

from camera_to_base.simulation import move_parameters, SimulatedBoard
import numpy as np
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger


class BumpService:
    """
    Offers `~/bump_camera`: each call sets the parameters of the camera's move at random.

    :param node: The node that offers it, and whose parameters are set.
    :param board: The simulated board.
    :param seed: Makes the bumps.
    """

    def __init__(self, node: Node, board: SimulatedBoard, seed: int) -> None:
        self._node, self._board = node, board
        self._random = np.random.default_rng((seed, 0, 3))
        node.create_service(Trigger, '~/bump_camera', self._on_call)

    def _on_call(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        move = self._board.random_bump(self._random)
        result = self._node.set_parameters_atomically(
            [Parameter(name, value=value) for name, value in move_parameters(move).items()])
        response.success = result.successful
        response.message = result.reason or (
            f'the camera was bumped: its picture has moved by {self._board.shift_px:.1f} px, '
            f'{10 * self._board.shift_cm:.1f} mm on the table, at the corner that moved farthest '
            f'(shift {move.shift_px} px, turn {move.turn_deg} deg, tilt {move.tilt_deg} deg, '
            f'zoom {move.zoom})')
        return response
