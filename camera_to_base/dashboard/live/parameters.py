# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The parameters of a running node: read, watched and set from outside, as JSON."""

import math
import time
from typing import Any, Callable, Dict, List, Mapping, Optional, Set, Tuple

from camera_to_base.dashboard.live.cells import full_name
from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import ParameterSpec
from rcl_interfaces.msg import Parameter as ParameterMessage, ParameterDescriptor, ParameterEvent
from rcl_interfaces.srv import (
    DescribeParameters, GetParameters, ListParameters, SetParametersAtomically)
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.serialization import serialize_message
from rclpy.task import Future

# A node that does not answer for so long is asked again.
_LONGEST_ANSWER_S = 3.0
# A node may lose its answer where discovery or the network is slow: then it is asked once more.
_LATE_S = 1.5


def parameter_data(
    descriptor: ParameterDescriptor, value: Any, spec: Optional[ParameterSpec]
) -> Dict[str, Any]:
    """
    Describe a parameter as JSON.

    :param descriptor: What its node says about it.
    :param value: Its value.
    :param spec: What this package knows about it; None for a parameter of another package.
    """
    name = descriptor.name
    return {
        'name': name, 'value': value, 'type': kind_of(descriptor, spec).name.lower(),
        'default': spec.default if spec else None,
        'description': descriptor.description,
        'constraints': descriptor.additional_constraints,
        'range': _range(descriptor), 'read_only': descriptor.read_only,
        'choices': [] if spec is None or isinstance(spec.default, list) else list(spec.choices),
        'unit': spec.unit if spec else '',
        'group': name.rpartition('.')[0]}


def kind_of(descriptor: ParameterDescriptor, spec: Optional[ParameterSpec]) -> Parameter.Type:
    """Return a parameter's type; of an empty list, ROS cannot tell it."""
    if spec is not None and spec.takes_any_list:
        return Parameter.Type.DOUBLE_ARRAY
    return Parameter.Type(descriptor.type)


def typed(kind: Parameter.Type, value: Any) -> Any:
    """
    Convert a JSON value to a parameter's type, where that loses nothing.

    :raises TypeError: If it is no number where numbers are expected.
    """
    if kind is Parameter.Type.DOUBLE and type(value) is int:
        return float(value)
    if kind is Parameter.Type.DOUBLE_ARRAY and isinstance(value, list):
        return [float(number) for number in value]
    if kind is Parameter.Type.INTEGER and type(value) is float and value.is_integer():
        return int(value)
    return value


def _message(parameter: Parameter) -> ParameterMessage:
    """
    Make the message of a parameter.

    :raises RefusedError: If no message can hold the value, such as an integer of 70 bits.
    """
    try:
        message = parameter.to_parameter_msg()
        serialize_message(message)
    except (AssertionError, TypeError, ValueError, OverflowError, SystemError):
        raise RefusedError(*_refusal(parameter.name, parameter.value)) from None
    return message


def _refusal(name: str, value: Any) -> Tuple[str, Dict[str, str]]:
    sentence = (f'parameter {name} cannot be {str(value):.80}: another type, or a number of less '
                'size, is expected')
    return sentence, {name: sentence}


def _range(descriptor: ParameterDescriptor) -> Optional[List[float]]:
    for limits in (*descriptor.integer_range, *descriptor.floating_point_range):
        return [limits.from_value, limits.to_value, limits.step]
    return None


class RefusedError(CameraToBaseError):
    """
    A node has refused parameters.

    `errors` holds a sentence for each parameter that is named in the reason.
    """

    def __init__(self, sentence: str, errors: Mapping[str, str]) -> None:
        super().__init__(sentence)
        self.errors = dict(errors)


class RemoteParameters:
    """
    The parameters of one node.

    :param node: The node that asks.
    :param remote: Full name of the other node.
    :param specs: What is known about its parameters beforehand: order, defaults and units.
    :param on_change: Called when a value or the list has changed.
    """

    def __init__(
        self, node: Node, remote: str, specs: List[ParameterSpec],
        on_change: Callable[[], None],
    ) -> None:
        self._node, self.remote = node, remote
        self._specs = {spec.name: spec for spec in specs}
        self._on_change = on_change
        self._descriptors: Dict[str, ParameterDescriptor] = {}
        self.values: Dict[str, Any] = {}
        self._clients = {
            kind: node.create_client(kind, f'{remote}/{service}') for kind, service in (
                (ListParameters, 'list_parameters'), (GetParameters, 'get_parameters'),
                (DescribeParameters, 'describe_parameters'),
                (SetParametersAtomically, 'set_parameters_atomically'))}
        # Counts what was announced; what was read is as new as the count when it was asked for.
        self._announced = self._asked_for = 0
        self._read_count = -1
        self._asked_at = -math.inf
        self._writers: Set[Tuple[int, ...]] = set()
        # Changes that may have to be sent again: what sends them, their answer, and since when.
        self._sent: List[Tuple[Callable[[], None], Future, float]] = []

    @property
    def is_known(self) -> bool:
        """Whether all values were read."""
        return bool(self.values)

    @property
    def data(self) -> List[Dict[str, Any]]:
        """All parameters as JSON: the known ones in the order of their list, then the others."""
        order = {name: number for number, name in enumerate(self._specs)}
        return [parameter_data(self._descriptors[name], self.values[name], self._specs.get(name))
                for name in sorted(self.values, key=lambda name: (
                    order.get(name, len(order)), name))]

    def forget(self) -> None:
        """Forget the values: the node has ended."""
        if self.values:
            self.values = {}
            self._on_change()

    def ask(self) -> None:
        """Read the values, if they are not known; send again what was not answered."""
        self._send_again()
        writers = self._find_writers()
        if writers - self._writers:
            self._writers |= writers
            self._announced += 1
        is_known = self.values and self._read_count == self._announced
        is_asked = time.monotonic() - self._asked_at < _LONGEST_ANSWER_S
        if not (is_known or is_asked) and all(
                client.service_is_ready() for client in self._clients.values()):
            self.read()

    def read(self) -> None:
        """Read the list, the descriptors and the values anew."""
        self._asked_at, self._asked_for = time.monotonic(), self._announced
        self._call(ListParameters.Request(), self._on_names)

    def change(self, values: Mapping[str, Any]) -> Future:
        """
        Set parameters, all or none.

        :returns: The future of the new values; RefusedError if the node has refused them.
        :raises RefusedError: If there is no such parameter, or the type does not fit.
        """
        parameters = [self._parameter(name, value) for name, value in values.items()]
        messages = [_message(parameter) for parameter in parameters]
        answer = Future()

        def send() -> None:
            self._call(
                SetParametersAtomically.Request(parameters=messages),
                lambda response: self._on_set(response, parameters, answer))

        send()
        self._sent.append((send, answer, time.monotonic()))
        return answer

    def on_event(self, event: ParameterEvent) -> None:
        """Take what a node has announced on /parameter_events."""
        if event.node != self.remote:
            return
        if event.new_parameters:
            # A node that starts declares its parameters one by one.
            self._announced += 1
        changed = {parameter.name: _value(parameter.value)
                   for parameter in event.changed_parameters if parameter.name in self.values}
        if changed:
            self.values.update(changed)
            self._on_change()

    def close(self) -> None:
        """Give the clients back."""
        for client in self._clients.values():
            self._node.destroy_client(client)

    def _find_writers(self) -> Set[Tuple[int, ...]]:
        # A node that was killed stays in the graph for 20 s, beside the one that replaces it.
        return {tuple(info.endpoint_gid)
                for info in self._node.get_publishers_info_by_topic('/parameter_events')
                if full_name(info.node_namespace, info.node_name) == self.remote}

    def _parameter(self, name: str, value: Any) -> Parameter:
        if name not in self._descriptors:
            sentence = f'{self.remote} has no parameter {name:.80}'
            raise RefusedError(sentence, {name: sentence})
        try:
            kind = kind_of(self._descriptors[name], self._specs.get(name))
            return Parameter(name, kind, typed(kind, value))
        except (TypeError, ValueError, OverflowError):
            raise RefusedError(*_refusal(name, value)) from None

    def _on_names(self, response: ListParameters.Response) -> None:
        names = list(response.result.names)
        self._call(DescribeParameters.Request(names=names), lambda described: self._call(
            GetParameters.Request(names=names), lambda got: self._on_values(described, got)))

    def _on_values(
        self, described: DescribeParameters.Response, got: GetParameters.Response
    ) -> None:
        self._asked_at, self._read_count = -math.inf, self._asked_for
        self._descriptors = {
            descriptor.name: descriptor for descriptor in described.descriptors}
        self.values = dict(zip(self._descriptors, map(_value, got.values)))
        self._on_change()

    def _send_again(self) -> None:
        # Once: the same values a second time change nothing.
        late = time.monotonic() - _LATE_S
        for send, answer, since in self._sent:
            if since < late and not answer.done():
                send()
        self._sent = [one for one in self._sent if one[2] >= late]

    def _on_set(
        self, response: SetParametersAtomically.Response, parameters: List[Parameter],
        answer: Future,
    ) -> None:
        if answer.done():
            return
        if response.result.successful:
            changed = {parameter.name: parameter.value for parameter in parameters}
            answer.set_result({name: _plain(value) for name, value in changed.items()})
            return
        reason = response.result.reason
        names = [parameter.name for parameter in parameters]
        named = [name for name in names if name in reason] or names
        answer.set_exception(RefusedError(reason, {name: reason for name in named}))

    def _call(self, request: Any, then: Callable[[Any], None]) -> None:
        kind = next(kind for kind in self._clients if isinstance(request, kind.Request))
        future = self._clients[kind].call_async(request)
        future.add_done_callback(lambda done: then(done.result()))


def _value(message: Any) -> Any:
    return _plain(parameter_value_to_python(message))


def _plain(value: Any) -> Optional[Any]:
    return list(value) if hasattr(value, 'tolist') else value
