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

"""Finds the parameters on a node's command line, and those that have no effect."""

from functools import lru_cache
import os
from typing import Any, Collection, Iterable, List, NamedTuple, Optional, Sequence

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters.file import read_sections, Section
from camera_to_base.parameters.names import (
    meant_name, misspelt_name, name_warnings, unknown_name_text, unknown_names)
from camera_to_base.parameters.spec import ParameterSpec


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
        one of the node's own.
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
          for name in unknown_names(shared & set(given), own) if meant_name(name, own))]


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
