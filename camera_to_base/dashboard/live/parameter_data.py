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

"""A node's parameter as JSON, and JSON as a parameter's value."""

from typing import Any, Dict, List, Optional

from camera_to_base.parameters import ParameterSpec
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.parameter import Parameter


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
        'choices': list(spec.choices) if spec else [], 'unit': spec.unit if spec else '',
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


def _range(descriptor: ParameterDescriptor) -> Optional[List[float]]:
    for limits in (*descriptor.integer_range, *descriptor.floating_point_range):
        return [limits.from_value, limits.to_value, limits.step]
    return None
