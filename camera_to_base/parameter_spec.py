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

"""What a parameter is: name, default, meaning and limits, without ROS."""

from dataclasses import dataclass
from typing import Any, Mapping, Optional, Tuple

Values = Mapping[str, Any]

_KINDS = {bool: 'bool', int: 'integer', float: 'double', str: 'string'}


@dataclass(frozen=True)
class ParameterSpec:
    """
    One parameter, as `ros2 param describe` shows it.

    :param limits: Lowest and highest number, both allowed.
    :param step: Distance of allowed whole numbers; 0 allows all.
    :param constraints: What else must hold, in words.
    :param fixed: Cannot be changed while the node runs.
    """

    name: str
    default: Any
    description: str
    limits: Optional[Tuple[float, float]] = None
    step: int = 0
    constraints: str = ''
    fixed: bool = False

    @property
    def takes_any_list(self) -> bool:
        """Tell whether the default is an empty list, of which ROS cannot tell the type."""
        return isinstance(self.default, list) and not self.default

    def has_type_of(self, value: Any) -> bool:
        """Tell whether a value has the declared type."""
        return self.takes_any_list or kind_of(value) == kind_of(self.default)

    def converted(self, value: Any) -> Any:
        """Make a double of an int and a text of a device index, as a user would expect."""
        if self.takes_any_list and value is None:
            return []  # what rcl makes of an empty list in a file
        if isinstance(self.default, str) and type(value) is int:
            return str(value)
        if isinstance(self.default, float) and type(value) is int:
            return float(value)
        if kind_of(self.default) == 'list of double' and kind_of(value) == 'list of integer':
            return [float(number) for number in value]
        return value


def kind_of(value: Any) -> str:
    """Name the type that ROS gives a value; a list of several types has none."""
    if not hasattr(value, '__len__') or isinstance(value, str):
        return _KINDS.get(type(value), type(value).__name__)
    kinds = {kind_of(item) for item in value}
    return f'list of {" and ".join(sorted(kinds)) or "nothing"}'
