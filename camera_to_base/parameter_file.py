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


"""Reads and writes parameter files, as `ros2 run ... --ros-args --params-file` takes them."""

from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Tuple

from camera_to_base.errors import InvalidValueError
import yaml


class ParameterFile(NamedTuple):
    """
    The content of a parameter file.

    :param values: By full name, 'surface.model' and so on.
    :param comments: The lines of comment at its top, without the '#'.
    """

    values: Mapping[str, Any]
    comments: List[str]


def parameter_text(values: Mapping[str, Any], comments: Iterable[str]) -> str:
    """
    Make the text of a file for all nodes.

    :param values: By full name, 'surface.model' and so on.
    :param comments: Lines for its top.
    """
    tree: Dict[str, Any] = {}
    for name, value in values.items():
        *groups, leaf = name.split('.')
        branch = tree
        for group in groups:
            branch = branch.setdefault(group, {})
        branch[leaf] = value
    body = yaml.safe_dump({'/**': {'ros__parameters': tree}}, default_flow_style=None,
                          sort_keys=False, width=90)
    return ''.join(f'# {line}'.rstrip() + '\n' for line in comments) + body


def read_parameter_file(path: str) -> ParameterFile:
    """
    Read a file's parameters for all nodes.

    :raises InvalidValueError: If there is no such file, or it holds none.
    """
    text, content = load_yaml(path, 'parameter file')
    try:
        tree = content['/**']['ros__parameters']
    except (KeyError, TypeError) as error:
        raise InvalidValueError(
            f"'{path}' is no parameter file for all nodes: it has no '/**: ros__parameters:'"
        ) from error
    return ParameterFile(_flat(tree), _comments(text))


def load_yaml(path: str, kind: str) -> Tuple[str, Any]:
    """
    Load a file.

    :param kind: What messages call it.
    :returns: Its text, and the content of that.
    :raises InvalidValueError: If there is no such file, or it is no YAML.
    """
    try:
        with open(path, encoding='utf-8') as file:
            text = file.read()
        return text, yaml.safe_load(text)
    except (OSError, UnicodeDecodeError) as error:
        raise InvalidValueError(f"cannot read the {kind} '{path}': {error}") from error
    except yaml.YAMLError as error:
        reason = ' '.join(str(error).split())
        raise InvalidValueError(f"'{path}' is no YAML: {reason}") from error


def _flat(tree: Any, prefix: str = '') -> Dict[str, Any]:
    values: Dict[str, Any] = {}
    for name, value in (tree or {}).items():
        if isinstance(value, dict):
            values.update(_flat(value, f'{prefix}{name}.'))
        else:
            values[f'{prefix}{name}'] = value
    return values


def _comments(text: str) -> List[str]:
    lines = []
    for line in text.splitlines():
        if not line.startswith('#'):
            break
        lines.append(line[1:].strip())
    return lines
