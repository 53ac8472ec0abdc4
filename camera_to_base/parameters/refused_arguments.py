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

"""Says in one sentence what is wrong with a node's ROS arguments, which rcl refuses without it."""

import re
from typing import Callable, Dict, Iterator, Optional, Sequence, Tuple

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters.file import read_sections
import yaml

_WORD = r'[A-Za-z_]\w*'
_NODE_NAME = re.compile(_WORD, re.ASCII)
_NAMESPACE = re.compile(f'/|(/{_WORD})+', re.ASCII)


def argument_problem(arguments: Sequence[str]) -> Optional[str]:
    """
    Find what is wrong in a command line that rcl has refused.

    :param arguments: The command line, with or without the program's name.
    :returns: A sentence with the argument and what to write; None if the fault is not known here.
    """
    for option, value in _options(arguments):
        found = _CHECKS[option](value)
        if found:
            return found
    return None


def _options(arguments: Sequence[str]) -> Iterator[Tuple[str, str]]:
    is_for_ros = False
    for argument, value in zip(arguments, [*arguments[1:], '']):
        is_for_ros = argument == '--ros-args' or is_for_ros and argument != '--'
        if is_for_ros and argument in _CHECKS:
            yield argument, value


def _file_problem(path: str) -> Optional[str]:
    try:
        sections = read_sections(path)
    except InvalidValueError as error:
        return str(error)
    if not sections:
        return f"'{path}' is no parameter file: it has no 'ros__parameters:'"
    for section in sections:
        for name, value in section.values.items():
            if _has_mixed_numbers(value):
                return f"'{path}': {_mixed_text(name, value)}"
    return None


def _parameter_problem(assignment: str) -> Optional[str]:
    name, separator, text = assignment.partition(':=')
    if not separator or not name:
        return f"expected -p NAME:=VALUE, got '-p {assignment}'"
    if not text:
        return f'parameter {name} has no value: write -p {name}:=VALUE, or leave it out'
    try:
        value = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError) as error:
        return f"the value of parameter {name} is no YAML, got '{text}': {_one_line(error)}"
    return _mixed_text(name, value) if _has_mixed_numbers(value) else None


def _rule_problem(rule: str) -> Optional[str]:
    name, separator, new = rule.partition(':=')
    if not separator or not name or not new:
        return f"expected -r OLD_NAME:=NEW_NAME, got '-r {rule}'"
    kind = name.rpartition(':')[2]
    if kind == '__ns' and not _NAMESPACE.fullmatch(new):
        return ("a namespace begins with '/' and is made of letters, digits and '_', and no part "
                f"of it begins with a digit, got '{new}': write -r {name}:=/cell_1, for example")
    if kind in ('__node', '__name') and not _NODE_NAME.fullmatch(new):
        return ("a node's name is made of letters, digits and '_', and does not begin with a "
                f"digit, got '{new}'")
    return None


def _has_mixed_numbers(value: object) -> bool:
    return isinstance(value, list) and {type(number) for number in value} == {int, float}


def _mixed_text(name: str, value: Sequence[float]) -> str:
    return (f'all numbers of the list {name} must be of one kind, got {list(value)}: '
            f'write {[float(number) for number in value]}')


def _one_line(error: Exception) -> str:
    return ' '.join(str(error).split())


_CHECKS: Dict[str, Callable[[str], Optional[str]]] = {
    '--params-file': _file_problem,
    '-p': _parameter_problem, '--param': _parameter_problem,
    '-r': _rule_problem, '--remap': _rule_problem,
}
