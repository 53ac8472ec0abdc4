# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Parameter files for `ros2 run ... --params-file`, and what they record of a calibration."""

from datetime import datetime
from itertools import accumulate
import re
from typing import (
    Any, Collection, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Tuple)

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters.spec import ParameterSpec
import yaml

# PyYAML takes seconds for more.
_MOST_CHARACTERS = 200_000

_CHANGE = '; '
# Both nodes have these: they log the same line at their start.
RECORD_SPECS = [
    ParameterSpec('calibration.surface', '',
                  'When the surface was calibrated, from what, and how well; written by '
                  'calibrate.'),
    ParameterSpec('calibration.base', '',
                  'When the base frame was calibrated, from what, and how well; written by '
                  'calibrate.'),
    ParameterSpec('calibration.device', '',
                  'The camera that the surface was calibrated with: a lasting link to a device, '
                  'the URL of a stream, or simulated; written by calibrate.'),
]
# Only the camera node has frames to compare.
OWN_CAMERA_SPECS = [
    ParameterSpec('calibration.thumbnail', '',
                  'A small picture of the calibrated surface, PNG in base64: the node compares '
                  'its background with it; written by calibrate.'),
    ParameterSpec('calibration.strict', False,
                  'Whether to publish nothing if the calibration belongs to another camera, or to '
                  'another view. Otherwise the node only warns.'),
]


class _Loader(yaml.SafeLoader):
    """Refuses aliases, as rcl does: a file with aliases could contain itself or grow endlessly."""

    def compose_node(self, parent: Optional[yaml.Node], index: Any) -> Optional[yaml.Node]:
        """Compose the next node."""
        if self.check_event(yaml.AliasEvent):
            raise InvalidValueError(
                f'an alias (*{self.peek_event().anchor}) stands in it: ROS reads none, write its '
                'value out')
        return super().compose_node(parent, index)


class ParameterFile(NamedTuple):
    """
    The content of a parameter file.

    :param values: By full name, 'surface.model' and so on.
    :param comments: The comment lines at its top, without the '#'.
    """

    values: Mapping[str, Any]
    comments: List[str]


class Section(NamedTuple):
    """
    The parameters of a file for one node, or for several.

    :param node: The node's full name, '/cell_1/camera_publisher'; '*' matches one part of it,
        '**' any number of parts.
    :param values: By full name, 'surface.model' and so on.
    """

    node: str
    values: Mapping[str, Any]

    @property
    def is_for_several(self) -> bool:
        """Whether it is for more than one node."""
        return '*' in self.node

    def stands_for(self, node: str) -> bool:
        """Return whether it applies to a node, by rclpy's rule."""
        pattern = re.escape(self.node).replace(r'/\*\*', r'(/\w+)*').replace(r'/\*', r'(/\w+)')
        return re.fullmatch(pattern, node) is not None


def parameter_text(
    values: Mapping[str, Any], comments: Iterable[str], last: Collection[str] = ()
) -> str:
    """
    Return the text of a file for all nodes.

    :param values: By full name, 'surface.model' and so on.
    :param comments: Lines for its top.
    :param last: Names that stand at the file's end, outside of their groups, as ROS allows.
    :raises InvalidValueError: If a name is both a parameter and a group.
    """
    _refuse_values_that_are_groups(values)
    tree: Dict[str, Any] = {}
    for name, value in sorted(values.items(), key=lambda item: item[0] in last):
        *groups, leaf = [name] if name in last else name.split('.')
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
    text, tree = load_yaml(path, 'parameter file')
    for name in ('/**', 'ros__parameters'):
        tree = tree.get(name) if isinstance(tree, dict) else None
    if not isinstance(tree, dict):
        raise InvalidValueError(
            f"'{path}' is no parameter file for all nodes: it has no '/**: ros__parameters:' with "
            'names below')
    return ParameterFile(_flat(tree), _comments(text))


def read_node_parameters(path: str, node: str) -> Dict[str, Any]:
    """
    Read one node's parameters from a file, as ROS does: the last section that applies wins.

    :param node: The node's full name, '/cell_1/camera_publisher'.
    :returns: The values by full name, 'surface.model' and so on.
    :raises InvalidValueError: If there is no such file, or it is no parameter file.
    """
    sections = read_sections(path)
    if not sections:
        raise InvalidValueError(f"'{path}' is no parameter file: it has no 'ros__parameters:'")
    values: Dict[str, Any] = {}
    for section in sections:
        if section.stands_for(node):
            values.update(section.values)
    return values


def read_sections(path: str) -> List[Section]:
    """
    Read all sections of a file, in order; [] for a file without parameters.

    :raises InvalidValueError: If there is no such file, or it is no YAML.
    """
    return [Section(name, _flat(tree))
            for name, tree in _sections(load_yaml(path, 'parameter file')[1])]


def node_namespaces(path: str, nodes: Iterable[str]) -> List[str]:
    """
    List the namespaces of the nodes that a file names, such as '/cell_1'; '' for none.

    :param nodes: The nodes' names, without namespaces.
    :raises InvalidValueError: If there is no such file, or it is no YAML.
    """
    names = [section.node.rpartition('/') for section in read_sections(path)]
    return sorted({namespace for namespace, _, node in names
                   if node in nodes and '*' not in namespace})


def load_yaml(path: str, kind: str) -> Tuple[str, Any]:
    """
    Load a file.

    :param kind: The messages' word for the file.
    :returns: Its text, and its parsed content.
    :raises InvalidValueError: If there is no such file, or it is no YAML.
    """
    try:
        with open(path, encoding='utf-8') as file:
            text = file.read()
    except (OSError, ValueError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise InvalidValueError(f"cannot read the {kind} '{path}': {reason}") from error
    if len(text) > _MOST_CHARACTERS:
        raise InvalidValueError(
            f"the {kind} '{path}' has {len(text)} characters, at most {_MOST_CHARACTERS} are read")
    try:
        return text, yaml.load(text, _Loader)
    # For a value that does not fit its tag, PyYAML raises Python's own exceptions.
    except (yaml.YAMLError, ValueError, LookupError, AttributeError, RecursionError) as error:
        reason = ' '.join(str(error).split())
        raise InvalidValueError(f"'{path}' is no YAML: {reason}") from error


def _sections(tree: Any, name: str = '') -> Iterator[Tuple[str, Any]]:
    # A namespace may be a separate level, or part of a node's name.
    for key, branch in (tree.items() if isinstance(tree, dict) else ()):
        if key == 'ros__parameters' and isinstance(branch, (dict, type(None))):
            yield name, branch
        else:
            yield from _sections(branch, f'{name}/{str(key).strip("/")}')


def _refuse_values_that_are_groups(values: Mapping[str, Any]) -> None:
    for name in values:
        for group in accumulate(name.split('.')[:-1], '{}.{}'.format):
            if group in values:
                raise InvalidValueError(
                    f"'{group}' has a value and cannot be the group of '{name}': rename one")


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
        # An indent belongs to the text: tables have one.
        lines.append(line[1:].removeprefix(' ').rstrip())
    return lines


def calibration_record(report: Mapping[str, Any]) -> str:
    """
    Write in one line when a part was calibrated, from what, and how well.

    :param report: The report of the calibration.
    """
    return (f'{report["date"]}, {report["model"]} from {report["source"]}, '
            f'rms {report["rms_mm"]:.2f} mm at {report["points"]} points')


def changed_record(record: str, how: str, now: datetime) -> str:
    """
    Write in one line that a calibration was changed, and what it was made from.

    :param record: Its line before; '' for none.
    :param how: What was done to it.
    :param now: When.
    """
    date, _, made_from = record.partition(', ')
    if made_from and _CHANGE not in made_from:
        made_from += f' on {date[:10]}'
    made_from = made_from.partition(_CHANGE)[0]
    words = f'{made_from}{_CHANGE}{how}' if made_from else how
    return f'{now.isoformat(timespec="seconds")}, {words}'


def calibration_summary(values: Mapping[str, Any], now: Optional[datetime] = None) -> str:
    """
    Say in one line what the parameters hold of a calibration.

    :param values: By full name; missing ones have their defaults.
    :param now: With its time zone; None for the present time.
    """
    now = now or datetime.now().astimezone()
    surface = _part('surface', values.get('calibration.surface'),
                    values.get('surface.model', 'parallel') != 'parallel', now)
    base = _part('base frame', values.get('calibration.base'), False, now)
    device = values.get('calibration.device')
    return f'calibration: {surface}; {base}' + (f'; camera {device}' if device else '')


def calibration_date(
    values: Mapping[str, Any], record: str = 'calibration.surface'
) -> Optional[datetime]:
    """
    Tell when the surface was calibrated; None where that is not recorded.

    :param values: By full name.
    :param record: Name of the record of what was calibrated.
    """
    date = str(values.get(record) or '').partition(', ')[0]
    try:
        return datetime.fromisoformat(date).astimezone()
    except ValueError:
        return None


def age_text(date: str, now: datetime) -> str:
    """
    Say how long ago a date is.

    :param date: In ISO 8601.
    :param now: With its time zone.
    :returns: The date itself where it is none.
    """
    try:
        days = (now - datetime.fromisoformat(date)).days
    except (TypeError, ValueError):
        return date
    if days < 1:
        return f'{date} (less than a day ago)'
    return f'{date} ({days} day{"s" * (days > 1)} ago)'


def _part(name: str, record: Optional[str], is_set: bool, now: datetime) -> str:
    if not record:
        return f'{name} {"without a record" if is_set else "not calibrated"}'
    date, _, rest = record.partition(', ')
    return f'{name} of {age_text(date, now)}, {rest}'
