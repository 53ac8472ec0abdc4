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

"""Declares and checks a node's parameters, and holds them as one frozen value."""

from typing import Any, Callable, Dict, Generic, List, Tuple, TypeVar

from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameter_spec import meant_name, ParameterSpec, unknown_name_text, Values
from rcl_interfaces.msg import (
    FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult)
from rclpy.node import Node
from rclpy.parameter import Parameter

T = TypeVar('T')


class NodeParameters(Generic[T]):
    """
    A node's parameters as one frozen value, which is replaced as a whole.

    :param node: The node that declares them.
    :param specs: What to declare.
    :param build: Makes the frozen value of the parameters' values, or raises CameraToBaseError.
    :param on_change: Called after the frozen value was replaced at run time.
    :raises CameraToBaseError: If the values at start cannot be used.
    :raises rclpy.exceptions.ParameterException: If one has the wrong type or is out of range.
    """

    def __init__(
        self,
        node: Node,
        specs: List[ParameterSpec],
        build: Callable[[Values], T],
        on_change: Callable[[], None] = lambda: None,
    ) -> None:
        self._specs = {spec.name: spec for spec in specs}
        self._build = build
        self._on_change = on_change
        self._values: Dict[str, Any] = {spec.name: _declare(node, spec) for spec in specs}
        self.current: T = build(self._values)
        self._warn_of_misspelt_names(node)
        self._next: Tuple[Dict[str, Any], T] = self._values, self.current
        node.add_pre_set_parameters_callback(self._convert)
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._replace)

    def _warn_of_misspelt_names(self, node: Node) -> None:
        # A file may hold another node's parameters, too, so an unknown name alone says nothing.
        # rclpy has no public way to ask for what was given.
        for name in set(getattr(node, '_parameter_overrides', {})) - set(self._specs):
            meant = meant_name(name, self._specs)
            if meant:
                node.get_logger().warning(unknown_name_text(name, meant))

    def _convert(self, parameters: List[Parameter]) -> List[Parameter]:
        return [Parameter(parameter.name, value=self._specs[parameter.name].converted(
                    parameter.value)) if parameter.name in self._specs else parameter
                for parameter in parameters]

    def _check(self, parameters: List[Parameter]) -> SetParametersResult:
        values = {**self._values, **{parameter.name: parameter.value for parameter in parameters
                                     if parameter.name in self._specs}}
        try:
            self._next = values, self._build(values)
        except CameraToBaseError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _replace(self, parameters: List[Parameter]) -> None:
        if any(parameter.name in self._specs for parameter in parameters):
            self._values, self.current = self._next
            self._on_change()


def _declare(node: Node, spec: ParameterSpec) -> Any:
    # rclpy refuses an int where a double is declared. So an override is first read whatever its
    # type is, and the parameter is then declared with the converted value.
    anything = ParameterDescriptor(dynamic_typing=True)
    value = spec.typed(node.declare_parameter(spec.name, spec.default, anything).value)
    node.undeclare_parameter(spec.name)
    return node.declare_parameter(
        spec.name, value, _descriptor(spec), ignore_override=True).value


def _descriptor(spec: ParameterSpec) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(
        description=spec.description, additional_constraints=spec.constraints,
        read_only=spec.fixed, dynamic_typing=spec.takes_any_list)
    if spec.limits and type(spec.default) is int:
        descriptor.integer_range = [IntegerRange(
            from_value=spec.limits[0], to_value=spec.limits[1], step=spec.step)]
    elif spec.limits:
        descriptor.floating_point_range = [FloatingPointRange(
            from_value=float(spec.limits[0]), to_value=float(spec.limits[1]))]
    return descriptor
