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

"""Publishes the tool's pose of the simulated robot, as the driver of a real one would."""

from camera_to_base.ros import tool_message
from camera_to_base.simulation import (
    SimulatedBoard, SimulatedRobot, SimulationSettings, Touch)
from geometry_msgs.msg import PoseStamped
import numpy as np
from rclpy.node import Node
from std_msgs.msg import Header

TOOL = 'simulated_tool'
_BASE_FRAME_ID = 'base_link'


class SimulatedTool:
    """
    The topic with the tool's pose while it touches something.

    :param node: The node that publishes.
    :param board: The simulated board.
    :param settings: The simulation's.
    """

    def __init__(self, node: Node, board: SimulatedBoard, settings: SimulationSettings) -> None:
        self._node, self._board, self._touch = node, board, settings.touch
        self._robot = SimulatedRobot(np.random.default_rng((settings.seed, 0, 2)))
        self._publisher = node.create_publisher(PoseStamped, TOOL, 10)

    def touch(self, touch: Touch) -> None:
        """Touch something else, or the same as before."""
        if touch != self._touch:
            self._touch = touch
            self._robot.renew_error()

    def publish(self) -> None:
        """Publish where the tool is, if it touches anything on the last frame."""
        point = self._board.point_of(self._touch)
        if point is not None:
            header = Header(stamp=self._node.get_clock().now().to_msg(), frame_id=_BASE_FRAME_ID)
            self._publisher.publish(tool_message(header, *self._robot.touch(point)))
