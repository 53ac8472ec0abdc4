# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Declares and checks a node's parameters, and holds them as one frozen value."""

import sys
from typing import Any, Callable, Collection, Dict, Generic, List, Optional, Tuple, TypeVar

from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import (
    all_names, checked_values, given_warnings, ParameterSpec, Values, with_new_names)
from rcl_interfaces.msg import (
    FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult)
from rclpy.node import Node
from rclpy.parameter import Parameter

T = TypeVar('T')
# A text that nobody gives.
_NOT_GIVEN = '\0'


class NodeParameters(Generic[T]):
    """
    A node's parameters as one frozen value, which is replaced as a whole.

    :param node: The node that declares them.
    :param specs: What to declare; each value is checked by its spec, here and nowhere else.
    :param build: Makes the frozen value of the checked values, or raises CameraToBaseError.
    :param on_change: Called after the frozen value was replaced at run time.
    :param others: Names of the parameters that other nodes take from the same files; None where
        they are not known.
    :param cli_args: The node's own command line, beside the process's.
    `left_out` says in a sentence each what was given in vain at the start, see `given_warnings`.

    :raises CameraToBaseError: If the values at start cannot be used.
    :raises rclpy.exceptions.ParameterException: If ROS refuses one.
    """

    def __init__(
        self,
        node: Node,
        specs: List[ParameterSpec],
        build: Callable[[Values], T],
        on_change: Callable[[], None] = lambda: None,
        *,
        others: Optional[Collection[str]] = None,
        cli_args: Optional[List[str]] = None,
    ) -> None:
        self._node = node
        self._specs = {spec.name: spec for spec in specs}
        self._build = build
        self._on_change = on_change
        given = self._with_new_names(_given(node, all_names(specs)))
        self._values: Dict[str, Any] = checked_values(specs, given)
        for spec in specs:
            _declare(node, spec, self._values[spec.name])
        self.current: T = build(self._values)
        self.left_out: List[str] = self._left_out([*sys.argv, *(cli_args or ())], others)
        for warning in self.left_out:
            node.get_logger().warning(warning)
        self._next: Tuple[Dict[str, Any], T] = self._values, self.current
        node.add_pre_set_parameters_callback(self._convert)
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._replace)

    def _with_new_names(self, given: Values) -> Dict[str, Any]:
        renamed, warnings = with_new_names(self._specs.values(), given)
        for warning in warnings:
            self._node.get_logger().warning(warning)
        return renamed

    def _left_out(
        self, arguments: List[str], others: Optional[Collection[str]]
    ) -> List[str]:
        # rclpy has no public way to ask for what was given.
        given = getattr(self._node, '_parameter_overrides', {})
        old_names = set(all_names(self._specs.values())) - set(self._specs)
        return given_warnings(
            self._node.get_fully_qualified_name(), set(given) - old_names, arguments,
            self._specs, others)

    def _convert(self, parameters: List[Parameter]) -> List[Parameter]:
        by_name = self._with_new_names({parameter.name: parameter for parameter in parameters})
        return [self._converted(name, parameter) for name, parameter in by_name.items()]

    def _converted(self, name: str, parameter: Parameter) -> Parameter:
        if name not in self._specs:
            return parameter
        spec = self._specs[name]
        value = spec.converted(parameter.value)
        if value == [] and not spec.takes_any_list:
            # Of an empty list rclpy cannot tell the type; a fixed one is not to change.
            return Parameter(name, Parameter.Type.DOUBLE_ARRAY, [])
        return Parameter(name, value=value)

    def _check(self, parameters: List[Parameter]) -> SetParametersResult:
        given = {parameter.name: parameter.value for parameter in parameters
                 if parameter.name in self._specs}
        try:
            # Others are declared after ours, by rclpy itself: nothing is to be made anew for them.
            self._next = self._changed(given) if given else (self._values, self.current)
        except CameraToBaseError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _changed(self, given: Values) -> Tuple[Dict[str, Any], T]:
        changed = {name: self._specs[name].checked(value) for name, value in given.items()}
        values = {**self._values, **changed}
        return values, self._build(values)

    def _replace(self, parameters: List[Parameter]) -> None:
        if any(parameter.name in self._specs for parameter in parameters):
            self._values, self.current = self._next
            self._on_change()


def _given(node: Node, names: List[str]) -> Dict[str, Any]:
    # rclpy refuses an int where a double is declared. So each override is first read whatever its
    # type is, and the parameter is declared with the converted value later.
    anything = ParameterDescriptor(dynamic_typing=True)
    values = {name: node.declare_parameter(name, _NOT_GIVEN, anything).value for name in names}
    for name in names:
        node.undeclare_parameter(name)
    return {name: value for name, value in values.items() if value != _NOT_GIVEN}


def _declare(node: Node, spec: ParameterSpec, value: Any) -> None:
    node.declare_parameter(spec.name, value, _descriptor(spec), ignore_override=True)


def _descriptor(spec: ParameterSpec) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(
        description=spec.description, additional_constraints=spec.constraint_text,
        read_only=spec.fixed, dynamic_typing=spec.takes_any_list)
    if spec.limits and type(spec.default) is int:
        descriptor.integer_range = [IntegerRange(
            from_value=spec.limits[0], to_value=spec.limits[1], step=spec.step)]
    elif spec.limits and type(spec.default) is float:
        descriptor.floating_point_range = [FloatingPointRange(
            from_value=float(spec.limits[0]), to_value=float(spec.limits[1]))]
    return descriptor
