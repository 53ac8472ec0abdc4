# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Listens to a running camera node, and to a robot, for commands that need their answers."""

import json
import time
from typing import Any, Callable, List, Mapping, Optional, Tuple

from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.ros.messages import point_from_message, poses_from_message
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PointStamped, PoseArray, PoseStamped
from rcl_interfaces.srv import GetParameters, SetParametersAtomically
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.signals import SignalHandlerOptions
from std_srvs.srv import Trigger

# Who misses another's first announcements, as on a busy computer, finds it 3 s later.
_DISCOVERY_S = 5.0
_LONGEST_WAIT_S, _ANSWER_S = 10.0, 5.0
# Messages that waited in the queue are older than the question.
_DRAIN_S = 0.3
_NODE = 'camera_publisher'

# A node that says no because of the last frame is asked again after this time.
_PAUSE_S = 0.3

# A robot publishes its pose several times a second.
_LONGEST_TOOL_WAIT_S = 5.0
_MESSAGES = 5
# The robot stands still while it touches.
_LARGEST_SPREAD_CM = 0.05


class Listener:
    """
    A node in a context of its own, which spins only while somebody waits.

    :param name: The node's name.
    """

    def __init__(self, name: str) -> None:
        self._context = rclpy.Context()
        rclpy.init(context=self._context, args=[],
                   signal_handler_options=SignalHandlerOptions.NO)
        self.node = rclpy.create_node(name, context=self._context, enable_rosout=False)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)

    def spin_until(self, is_done: Callable[[], bool], seconds: float) -> bool:
        """Spin until a condition holds; return whether it does in time."""
        until = time.monotonic() + seconds
        while not is_done() and time.monotonic() < until:
            self._executor.spin_once(timeout_sec=0.05)
        return is_done()

    def receive_anew(self, messages: List[Any], count: int, seconds: float) -> bool:
        """
        Wait for new messages; those that waited in the queue are dropped.

        :param messages: The list that the subscription appends to.
        :returns: Whether as many came in time.
        """
        self.spin_until(lambda: False, _DRAIN_S)
        messages.clear()
        return self.spin_until(lambda: len(messages) >= count, seconds)

    def close(self) -> None:
        """End the node."""
        self._executor.shutdown()
        self.node.destroy_node()
        self._context.try_shutdown()


class ObjectListener(Listener):
    """
    Receives all objects of each frame from a camera node.

    :param namespace: The camera node's namespace; '' for none.
    :param topic: The topic's name there.
    """

    def __init__(self, namespace: str, topic: str = 'objects_in_cam_frame') -> None:
        super().__init__('calibrate')
        prefix = f'/{namespace.strip("/")}'.rstrip('/')
        self._camera = f'{prefix}/{_NODE}'
        self.topic = f'{prefix}/{topic}'
        self._frames: List[List[Tuple[float, float]]] = []
        self._told: Optional[str] = None
        self.node.create_subscription(PoseArray, self.topic, self._on_objects, 50)
        self.node.create_subscription(DiagnosticArray, '/diagnostics', self._on_diagnostics, 10)
        self._client = self.node.create_client(GetParameters, f'{self._camera}/get_parameters')

    def is_node_running(self) -> bool:
        """Return whether somebody publishes the objects, after waiting for the discovery."""
        return self.spin_until(lambda: self.node.count_publishers(self.topic) > 0, _DISCOVERY_S)

    def check_same_surface(
        self, values: Mapping[str, Any], path: str, may_move: bool = False
    ) -> None:
        """
        Check that the running node has the surface of a file.

        :param values: The file's parameters by full name.
        :param path: The file, for the message.
        :param may_move: Whether the node may show the simulated table.
        :raises CalibrationError: If it has another one, or does not answer.
        """
        wanted = {name: value for name, value in values.items() if name.startswith('surface.')}
        running = self._parameters([*wanted, 'source'])
        if any(running[name] != value for name, value in wanted.items()):
            raise CalibrationError(
                f"the running {_NODE} has another surface than '{path}', so its positions belong "
                f'to another camera frame: restart it with --params-file {path}, or stop it')
        if running['source'] == 'simulated' and not may_move:
            raise CalibrationError(
                f'the running {_NODE} shows the simulated table, whose objects move: stop it, and '
                'the simulated camera of this command lays one coin after the other')

    def frames(self, count: int) -> List[List[Tuple[float, float]]]:
        """
        Wait for the objects of the next frames.

        :returns: For each frame x and y of each object, in cm, the largest first.
        :raises CalibrationError: If they do not come; it tells what the node says about it.
        """
        if not self.receive_anew(self._frames, count, _LONGEST_WAIT_S):
            raise CalibrationError(
                f'{len(self._frames)} of {count} frames came within {_LONGEST_WAIT_S:g} s: '
                f'{self._told or "is the node still running?"}')
        return self._frames[:count]

    def _parameters(self, names: List[str]) -> Mapping[str, Any]:
        future = None
        if self._client.wait_for_service(timeout_sec=_DISCOVERY_S):
            future = self._client.call_async(GetParameters.Request(names=names))
            self.spin_until(future.done, _ANSWER_S)
        if future is None or not future.done():
            raise CalibrationError(
                f'{self._camera} does not say which surface it has: restart it, or stop it')
        values = map(parameter_value_to_python, future.result().values)
        return {name: list(value) if hasattr(value, 'tolist') else value
                for name, value in zip(names, values)}

    def _on_objects(self, message: PoseArray) -> None:
        try:
            self._frames.append([(pose.x, pose.y) for pose in poses_from_message(message)])
        except InvalidValueError as error:
            self._told = str(error)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == self._camera:
                self._told = status.message


class CorrectionListener(Listener):
    """
    Talks to a camera node about the correction of a nudge.

    :param namespace: The camera node's namespace; '' for none.
    """

    def __init__(self, namespace: str) -> None:
        super().__init__('calibrate')
        self.camera = f'/{namespace.strip("/")}'.rstrip('/') + f'/{_NODE}'
        self._offers = self.node.create_client(Trigger, f'{self.camera}/corrected_surface')
        self._setter = self.node.create_client(
            SetParametersAtomically, f'{self.camera}/set_parameters_atomically')

    def offer(self, patience_s: float = 0.0) -> Mapping[str, Any]:
        """
        Ask for the correction.

        :param patience_s: For how long it is asked again where it offers none: a hand that
            crosses the view lasts for a moment.
        :returns: `sentence`, `values` and `before`, see the node's service `~/corrected_surface`.
        :raises CalibrationError: If no node runs, or it corrects nothing.
        """
        until = time.monotonic() + patience_s
        response = self._answer(self._offers, Trigger.Request())
        while not response.success and time.monotonic() < until:
            self.spin_until(lambda: False, _PAUSE_S)
            response = self._answer(self._offers, Trigger.Request())
        if not response.success:
            raise CalibrationError(f'{self.camera}: {response.message}')
        return json.loads(response.message)

    def use(self, values: Mapping[str, Any]) -> None:
        """
        Set parameters of the node.

        :raises CalibrationError: If it refuses them, or does not answer.
        """
        parameters = [_parameter(name, value).to_parameter_msg()
                      for name, value in values.items()]
        result = self._answer(
            self._setter, SetParametersAtomically.Request(parameters=parameters)).result
        if not result.successful:
            raise CalibrationError(f'{self.camera} refuses the corrected surface: {result.reason}')

    def _answer(self, client: Any, request: Any) -> Any:
        if not self.spin_until(client.service_is_ready, _DISCOVERY_S):
            raise CalibrationError(
                f'{self.camera} does not run, or it is an older one: start it, or name its '
                'namespace with --namespace')
        future = client.call_async(request)
        if not self.spin_until(future.done, _ANSWER_S):
            raise CalibrationError(f'{self.camera} does not answer within {_ANSWER_S:g} s')
        return future.result()


def _parameter(name: str, value: Any) -> Parameter:
    if value == []:
        return Parameter(name, Parameter.Type.DOUBLE_ARRAY, [])
    return Parameter(name, value=value)


class ToolListener(Listener):
    """
    Receives the tool's pose.

    :param topic: Its topic, geometry_msgs/PoseStamped, in m, in the base frame.
    """

    def __init__(self, topic: str) -> None:
        super().__init__('calibrate_robot')
        self._topic = topic
        self._poses: List[PoseStamped] = []
        self._frame_id: Optional[str] = None
        self.node.create_subscription(PoseStamped, topic, self._poses.append, 10)

    def position(self) -> Tuple[float, float]:
        """
        Wait for the next poses, and return where the tool is.

        :returns: x and y, in cm, in the frame of the messages.
        :raises CalibrationError: If no poses come, the tool moves, or their frame changes.
        """
        if not self.receive_anew(self._poses, _MESSAGES, _LONGEST_TOOL_WAIT_S):
            raise CalibrationError(
                f'{len(self._poses)} poses came on the topic {self._topic} within '
                f'{_LONGEST_TOOL_WAIT_S:g} s: does the robot publish geometry_msgs/PoseStamped '
                'there?')
        self._check_frame()
        points = [point_from_message(PointStamped(point=pose.pose.position))
                  for pose in self._poses[:_MESSAGES]]
        spread = max(max(axis) - min(axis) for axis in zip(*points))
        if spread > _LARGEST_SPREAD_CM:
            raise CalibrationError(
                f'the robot moves by {10 * spread:.1f} mm while its position is read: wait until '
                'it stands still')
        x, y, _ = points[-1]
        return x, y

    def _check_frame(self) -> None:
        named = {pose.header.frame_id for pose in self._poses}
        if self._frame_id is not None:
            named.add(self._frame_id)
        if len(named) > 1:
            raise CalibrationError(
                f'the poses on {self._topic} are in the frames {", ".join(sorted(named))}: all '
                "must be in the robot's base frame")
        self._frame_id = named.pop()
