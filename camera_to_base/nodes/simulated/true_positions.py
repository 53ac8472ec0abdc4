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

"""Publishes the true positions of the simulated board's objects."""

from camera_to_base.coordinate_transform import Pose
from camera_to_base.ros import poses_message, position_message
from camera_to_base.simulation import SimulatedBoard
from geometry_msgs.msg import PoseArray
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray, Header


class TruePositions:
    """
    Topics with true positions, which show how accurate the published positions are.

    :param node: The node that publishes.
    :param board: The simulated board.
    """

    def __init__(self, node: Node, board: SimulatedBoard) -> None:
        self._board = board
        self._position = node.create_publisher(Float64MultiArray, 'true_pos_in_cam_frame', 10)
        self._objects = node.create_publisher(PoseArray, 'true_objects_in_cam_frame', 10)

    def publish(self, header: Header) -> None:
        """Publish the true positions on the last frame."""
        if self._board.true_point is not None:
            self._position.publish(position_message(*self._board.true_point))
        self._objects.publish(poses_message(header, [
            Pose(*true.point, 0.0, true.yaw or 0.0) for true in self._board.true_objects]))
