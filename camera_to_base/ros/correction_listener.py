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

"""Asks a running camera node for the correction that it offers, and lets it use it."""

import json
import time
from typing import Any, Mapping

from camera_to_base.errors import CalibrationError
from camera_to_base.ros.object_listener import Listener
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

# Discovery of a running node takes up to a few seconds on a busy computer.
_DISCOVERY_S, _ANSWER_S = 5.0, 5.0
# A node that says no because of the last frame is asked again after this time.
_PAUSE_S = 0.3
_NODE = 'camera_publisher'


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
