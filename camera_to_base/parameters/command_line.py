# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The parameters on a node's command line: found, without effect, or refused by rcl."""

from functools import lru_cache
import os
import re
from typing import (
    Any, Callable, Collection, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence,
    Tuple)

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters.file import read_sections, Section
from camera_to_base.parameters.spec import (
    meant_name, misspelt_name, name_warnings, ParameterSpec, unknown_name_text, unknown_names)
import yaml

_WORD = r'[A-Za-z_]\w*'
_NODE_NAME = re.compile(_WORD, re.ASCII)
_NAMESPACE = re.compile(f'/|(/{_WORD})+', re.ASCII)


class GivenArguments(NamedTuple):
    """
    The parameters on a node's command line.

    :param files: The parameter files, in order.
    :param names: Names of the parameters that are set on the command line itself.
    """

    files: List[str]
    names: List[str]


def given_arguments(arguments: Sequence[str]) -> GivenArguments:
    """Find the parameters in a command line, between `--ros-args` and `--`."""
    found = GivenArguments([], [])
    is_for_ros = False
    for argument, value in zip(arguments, [*arguments[1:], '']):
        is_for_ros = argument == '--ros-args' or is_for_ros and argument != '--'
        if is_for_ros and argument == '--params-file':
            found.files.append(value)
        elif is_for_ros and argument in ('-p', '--param'):
            # A node's name may precede the parameter's.
            found.names.append(value.partition(':=')[0].rpartition(':')[2])
    return found


def value_in_files(arguments: Sequence[str], node: str, name: str) -> Any:
    """
    Return the value that parameter files of a command line give another node; None without one.

    :param node: The other node's full name.
    :param name: The parameter's name.
    """
    values = [section.values[name] for path in given_arguments(arguments).files
              for section in _readable_sections(path) or ()
              if section.stands_for(node) and name in section.values]
    return values[-1] if values else None


def gives_other_values(
    arguments: Sequence[str], node: str, specs: Iterable[ParameterSpec]
) -> bool:
    """
    Return whether parameter files of a command line change a parameter of a node.

    :param node: The node's full name.
    """
    values = {spec.name: value_in_files(arguments, node, spec.name) for spec in specs}
    return any(values[spec.name] is not None
               and spec.converted(values[spec.name]) != spec.default for spec in specs)


def given_warnings(
    node: str, given: Iterable[str], arguments: Sequence[str], own: Collection[str],
    others: Optional[Collection[str]],
) -> List[str]:
    """
    Warn of unknown parameter names, and of files without parameters for a node.

    :param node: Its full name.
    :param given: Names of all parameters that were set.
    :param arguments: The node's command line.
    :param own: Names of the node's own parameters.
    :param others: Names of the parameters of other nodes that share its files; None if unknown.
        Then an unknown name in a section for several nodes gives a warning only if it resembles
        one of the node's own, and has no group: groups such as `surface` have many nodes' names.
    """
    files = given_arguments(arguments).files
    shared = set()
    if others is None:
        sections = [section for path in files for section in _readable_sections(path) or ()]
        for_all, for_one = (
            {name for section in sections if section.is_for_several is several
             and section.stands_for(node) for name in section.values}
            for several in (True, False))
        shared = for_all - for_one - set(given_arguments(arguments).names)
    known = [*own, *(others or ())]
    return [
        *(warning for path in files for warning in file_warnings(path, node)),
        *name_warnings([name for name in given if name not in shared], known),
        *(unknown_name_text(name, meant_name(name, own))
          for name in unknown_names(shared & set(given), own)
          if '.' not in name and meant_name(name, own))]


def file_warnings(path: str, node: str) -> List[str]:
    """
    Warn of a parameter file without parameters for a node, unless it is for unrelated nodes.

    :param node: Its full name.
    """
    sections = _readable_sections(path)
    if sections is None:
        return []
    if not any(section.values for section in sections):
        return [f"'{path}' holds no parameters"]
    own = [section for section in sections if section.stands_for(node)]
    if any(not section.is_for_several for section in own):
        return []
    name = _last(node)
    # If the file is for both namespaces, the same name in the other one is another node.
    return [
        f"'{path}' has parameters for '{section.node}', and none for this node alone, '{node}'"
        for section in sections if misspelt_name(name, [_last(section.node)])
        and not section.is_for_several and not (own and _last(section.node) == name)]


def _readable_sections(path: str) -> Optional[List[Section]]:
    try:
        return _read_once(path, os.stat(path).st_mtime_ns)
    except OSError:
        return None


@lru_cache(maxsize=4)
def _read_once(path: str, changed_at: int) -> Optional[List[Section]]:
    # ROS has already refused a file that cannot be read.
    try:
        return read_sections(path)
    except InvalidValueError:
        return None


def _last(name: str) -> str:
    return name.rpartition('/')[2]


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
