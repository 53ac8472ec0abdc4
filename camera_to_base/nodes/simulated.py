# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What only a simulated cell offers: a service that bumps it, its tool, and the true positions."""

from camera_to_base.coordinate_transform import Pose
from camera_to_base.ros import (
    box_markers, poses_message, position_message, SolidBox, tool_message)
from camera_to_base.simulation import (
    move_parameters, SimulatedBoard, SimulatedRobot, SimulationSettings, Touch)
from geometry_msgs.msg import PoseArray, PoseStamped
import numpy as np
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64MultiArray, Header
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

TOOL = 'simulated_tool'
_BASE_FRAME_ID = 'base_link'


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
        self._boxes = node.create_publisher(MarkerArray, 'true_objects_in_cam_frame/boxes', 10)

    def publish(self, header: Header) -> None:
        """Publish the true positions on the last frame."""
        if self._board.true_point is not None:
            self._position.publish(position_message(*self._board.true_point))
        self._objects.publish(poses_message(header, [
            Pose(*true.point, 0.0, true.yaw or 0.0) for true in self._board.true_objects]))
        if self._boxes.get_subscription_count():
            # The camera frame's z points away from the camera.
            self._boxes.publish(box_markers(header, [
                SolidBox(Pose(*true.point, -true.size_cm[2] / 2, true.angle), *true.size_cm)
                for true in self._board.true_objects]))
