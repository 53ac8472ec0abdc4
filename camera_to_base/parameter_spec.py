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
import difflib
from typing import Any, Collection, Dict, Iterable, List, Mapping, Optional, Tuple

from camera_to_base.errors import InvalidValueError

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
        if kind_of(self.default) in ('list of double', 'list of nothing') and type(value) is str:
            return _numbers(value) or value
        return value

    def typed(self, value: Any) -> Any:
        """
        Convert a value to the declared type.

        :raises InvalidValueError: If it is of another.
        """
        try:
            typed = self.converted(value)
        except OverflowError:
            raise InvalidValueError(
                f'parameter {self.name} must be of type {kind_of(self.default)}, got a whole '
                'number of more than 300 digits')
        if not self.has_type_of(typed):
            raise InvalidValueError(
                f'parameter {self.name} must be of type {kind_of(self.default)}, '
                f'got {typed!r} of type {kind_of(typed)}')
        return typed

    def checked(self, value: Any) -> Any:
        """
        Convert a value to the declared type, and check that it is within the limits.

        :raises InvalidValueError: If it is of another type, or is not.
        """
        typed = self.typed(value)
        if not self._allows(typed):
            low, high = self.limits
            steps = f' in steps of {self.step}' if self.step else ''
            raise InvalidValueError(
                f'parameter {self.name} must be {low:g} to {high:g}{steps}, got {typed!r}')
        return typed

    def _allows(self, value: Any) -> bool:
        if self.limits is None:
            return True
        low, high = self.limits
        return low <= value <= high and not (self.step and (value - low) % self.step)


def checked_values(specs: Iterable[ParameterSpec], given: Values) -> Dict[str, Any]:
    """
    Give the value of each parameter, as a node has it that was started with some.

    :param given: By full name; names of no spec are left out.
    :raises InvalidValueError: If one is of another type, or beyond its limits.
    """
    return {spec.name: spec.checked(given[spec.name]) if spec.name in given else spec.default
            for spec in specs}


def meant_name(name: str, known: Collection[str]) -> Optional[str]:
    """Tell which known name somebody meant who has written an unknown one; None for any."""
    return next(iter(difflib.get_close_matches(name, known, n=1, cutoff=0.8)), None)


def unknown_name_text(name: str, meant: Optional[str], kind: str = 'parameter') -> str:
    """Warn of a name that no parameter has, or nothing else of a kind."""
    hint = f": did you mean '{meant}'?" if meant else ''
    return f"there is no {kind} '{name}', it is left out{hint}"


def _numbers(text: str) -> Optional[List[float]]:
    # `ros2 param` sends a list as text if YAML takes one of its numbers for text, as it does 6e-05
    # (which `ros2 param dump` writes), or if it is of ints and doubles.
    try:
        return [float(number) for number in text.strip('[] ').split(',')]
    except ValueError:
        return None


def kind_of(value: Any) -> str:
    """Name the type that ROS gives a value; a list of several types has none."""
    if not hasattr(value, '__len__') or isinstance(value, str):
        return _KINDS.get(type(value), type(value).__name__)
    kinds = {kind_of(item) for item in value}
    return f'list of {" and ".join(sorted(kinds)) or "nothing"}'
