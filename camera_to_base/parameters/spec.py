# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What a parameter is: name, default, meaning, unit and limits; unknown and renamed names."""

import array
from dataclasses import dataclass
import difflib
import math
from typing import Any, Collection, Dict, Iterable, List, Mapping, Optional, Tuple

from camera_to_base.errors import InvalidValueError

Values = Mapping[str, Any]

_KINDS = {bool: 'bool', int: 'integer', float: 'double', str: 'string'}

# Every ROS node has these; a name that ends in a dot is a group.
ROS_NAMES = ('use_sim_time', 'start_type_description_service', 'qos_overrides.')
# With at least this share of equal letters, a name counts as misspelt.
_ALIKE = 0.81


@dataclass(frozen=True)
class ParameterSpec:
    """
    One parameter: the only place for its default, its limits and its meaning.

    :param limits: Lowest and highest number, both allowed; of a list, for each number of it.
    :param step: Step between allowed whole numbers; 0 allows all.
    :param unit: Unit of the value: 'cm', 'deg'.
    :param choices: Allowed values of a text, or of each text of a list; () allows any.
    :param lengths: Allowed lengths of a list; () allows any length.
    :param constraints: Further constraints, in words.
    :param fixed: Whether it cannot be changed while the node runs.
    :param old_names: Former names, which still work, with a warning.
    """

    name: str
    default: Any
    description: str
    limits: Optional[Tuple[float, float]] = None
    step: int = 0
    unit: str = ''
    choices: Tuple[str, ...] = ()
    lengths: Tuple[int, ...] = ()
    constraints: str = ''
    fixed: bool = False
    old_names: Tuple[str, ...] = ()

    @property
    def takes_any_list(self) -> bool:
        """Return whether the default is an empty list, of which ROS cannot tell the type."""
        return isinstance(self.default, list) and not self.default

    @property
    def kind(self) -> str:
        """The declared type; a list that is empty by default is one of doubles."""
        return 'list of double' if self.takes_any_list else kind_of(self.default)

    @property
    def constraint_text(self) -> str:
        """All constraints in words, made from the limits, the unit and so on; '' for none."""
        each = 'each ' if isinstance(self.default, list) else ''
        choices = f'{each}one of {", ".join(self.choices)}' if self.choices else ''
        return '; '.join(filter(None, (self._numbers_text(), choices, self.constraints)))

    def _numbers_text(self) -> str:
        if not self.lengths:
            return self._number_text()
        counts = f'{" or ".join(map(str, self.lengths))} numbers'
        between = ', each ' if self.limits else ' '
        return between.join(filter(None, (counts, self._number_text())))

    def _number_text(self) -> str:
        if self.limits is None:
            return f'in {self.unit}' if self.unit else ''
        low, high = self.limits
        steps = f' in steps of {self.step}' if self.step else ''
        return f'{low:.10g} to {high:.10g} {self.unit}'.rstrip() + steps

    def converted(self, value: Any) -> Any:
        """Convert an int to a double, and a device index to a text, as a user would expect."""
        if isinstance(self.default, list) and value is None:
            return []  # rcl reads an empty list in a file as this
        if isinstance(value, (array.array, tuple)):
            value = list(value)  # the type of a client's numbers
        if isinstance(self.default, str) and type(value) is int:
            return str(value)
        if isinstance(self.default, float) and type(value) is int:
            return float(value)
        if self.kind == 'list of double' and kind_of(value) in (
                'list of integer', 'list of double and integer'):
            return [float(number) for number in value]
        if self.kind == 'list of double' and type(value) is str:
            return _numbers(value) or value
        return value

    def checked(self, value: Any) -> Any:
        """
        Convert a value to the declared type, and check that it is allowed.

        :raises InvalidValueError: If it has another type, or is not allowed.
        """
        typed = self._typed(value)
        if not self._allows(typed):
            wanted = self.constraint_text if self.limits or _is_finite(typed) else 'finite'
            raise InvalidValueError(f'parameter {self.name} must be {wanted}, got {typed!r}')
        return typed

    def _typed(self, value: Any) -> Any:
        try:
            typed = self.converted(value)
        except OverflowError:
            raise InvalidValueError(
                f'parameter {self.name} must be of type {self.kind}, got a whole number of more '
                'than 300 digits')
        is_empty_list = typed == [] and (self.takes_any_list or self.lengths)
        if not (kind_of(typed) == self.kind or is_empty_list):
            got = 'an empty list' if typed == [] else f'{typed!r} of type {kind_of(typed)}'
            raise InvalidValueError(
                f'parameter {self.name} must be of type {self.kind}, got {got}')
        return typed

    def _allows(self, value: Any) -> bool:
        if isinstance(value, list):
            right_length = not self.lengths or len(value) in self.lengths
            return right_length and all(map(self._allows_one, value))
        return self._allows_one(value)

    def _allows_one(self, value: Any) -> bool:
        if isinstance(value, str):
            return not self.choices or value in self.choices
        low, high = self.limits or (-math.inf, math.inf)
        return (_is_finite(value) and low <= value <= high
                and not (self.step and (value - low) % self.step))


def default_values(specs: Iterable[ParameterSpec]) -> Dict[str, Any]:
    """Return the default of each parameter."""
    return {spec.name: spec.default for spec in specs}


def checked_values(specs: Iterable[ParameterSpec], given: Values) -> Dict[str, Any]:
    """
    Return the value of each parameter: the given one, or the default.

    :param given: By full name; unknown names are left out.
    :raises InvalidValueError: If one has another type, or is beyond its limits.
    """
    return {spec.name: spec.checked(given[spec.name]) if spec.name in given else spec.default
            for spec in specs}


def grouped(values: Values, prefix: str) -> Dict[str, Any]:
    """Return the values whose names have a prefix, by their names without it."""
    return {name[len(prefix):]: value for name, value in values.items()
            if name.startswith(prefix)}


def _is_finite(value: Any) -> bool:
    return all(isinstance(number, str) or math.isfinite(number)
               for number in (value if isinstance(value, list) else [value]))


def _numbers(text: str) -> Optional[List[float]]:
    # `ros2 param` sends a list as text if YAML reads one of its numbers as text, such as the 6e-05
    # of `ros2 param dump`, or if it mixes ints and doubles.
    try:
        return [float(number) for number in text.strip('[] ').split(',')]
    except ValueError:
        return None


def kind_of(value: Any) -> str:
    """Return the name of a value's type in ROS, such as 'double' or 'list of integer'."""
    if not hasattr(value, '__len__') or isinstance(value, str):
        return _KINDS.get(type(value), type(value).__name__)
    kinds = {kind_of(item) for item in value}
    return f'list of {" and ".join(sorted(kinds)) or "nothing"}'


def misspelt_name(name: str, known: Collection[str]) -> Optional[str]:
    """Return the known name with nearly the same spelling; None if there is none."""
    return next(iter(difflib.get_close_matches(name, known, n=1, cutoff=_ALIKE)), None)


def meant_name(name: str, known: Iterable[str]) -> Optional[str]:
    """
    Return the known name that was probably meant by an unknown one; None if there is none.

    The unknown name may be misspelt, the start of a known name (`reach` for `reach_cm`, `surface`
    for `surface.model`), without its group (`threshold` for `detector.threshold`), or with a
    wrong one.
    """
    known = list(known)
    last = _last(name)
    candidates = (
        misspelt_name(name, known),
        next((other for other in known if other.startswith((f'{name}_', f'{name}.'))), None),
        next((other for other in known if _last(other) == last), None),
        # With a group, it may be a parameter of another node: surface.pinhole.rotation is no
        # rotation_deg.
        next((other for other in known if last == name and _last(other).startswith(f'{last}_')),
             None),
        next((other for other in known if misspelt_name(last, [_last(other)])), None))
    return next(filter(None, candidates), None)


def unknown_name_text(name: str, meant: Optional[str], kind: str = 'parameter') -> str:
    """Return a warning of an unknown name of a parameter, or of something else."""
    hint = f": did you mean '{meant}'?" if meant else ''
    return f"there is no {kind} '{name}', it is left out{hint}"


def unknown_names(given: Iterable[str], known: Collection[str]) -> List[str]:
    """List the given names that are neither known nor those of every ROS node."""
    return sorted(name for name in given
                  if name not in known and not _is_of_ros(name))


def name_warnings(given: Iterable[str], known: Collection[str]) -> List[str]:
    """Warn of each given name that no parameter has, with the name that was meant."""
    return [unknown_name_text(name, meant_name(name, known))
            for name in unknown_names(given, known)]


def all_names(specs: Iterable[ParameterSpec]) -> List[str]:
    """List the parameters' names, and their old names."""
    return [name for spec in specs for name in (spec.name, *spec.old_names)]


def with_new_names(
    specs: Iterable[ParameterSpec], given: Values
) -> Tuple[Dict[str, Any], List[str]]:
    """
    Move the values of renamed parameters to their new names.

    :param given: By full name. If both names are given, the new name's value is used.
    :returns: The values, and a warning for each old name.
    """
    new_names = {old: spec.name for spec in specs for old in spec.old_names}
    renamed = {new_names[name]: value for name, value in given.items() if name in new_names}
    kept = {name: value for name, value in given.items() if name not in new_names}
    return {**renamed, **kept}, [
        f"parameter '{old}' is called '{new_names[old]}' now: rename it, its old name will be "
        'left out in the next release' for old in given if old in new_names]


def _is_of_ros(name: str) -> bool:
    return any(name == own or own.endswith('.') and name.startswith(own) for own in ROS_NAMES)


def _last(name: str) -> str:
    return name.rpartition('.')[2]
