# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The parameter file of a cell: where it is, what it holds, and what it would hold."""

import os
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

from camera_to_base.calibration import (
    BASE, Calibration, cell_text, part_values, parts_of, report_lines, report_of, SURFACE)
from camera_to_base.dashboard.sessions.values import CellValues, SPECS
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.files import check_folder
from camera_to_base.parameters import (
    calibration_date, ParameterFile, read_parameter_file, read_sections, Values)

# What a person shows on the simulated table is no part of the set-up.
_PASSING = ('simulated.shows', 'simulated.placement', 'simulated.touched',
            'simulated.touched_marker')
_RECORDS = {SURFACE: 'calibration.surface', BASE: 'calibration.base'}
# Of the base frame; the camera node only shows them.
_PLACE = ('rotation_deg', 'displacement_cm')
_ERROR_OF_BASE = ('base_covariance', 'calibration.base')
_MOST_NUMBERS = 6

_ENDINGS = ('.yaml', '.yml')
_ALL = {**SPECS['camera'], **SPECS['transform']}


class CellFiles:
    """
    Which file belongs to which cell: no two cells are given the same one.

    :param params_file: That of the dashboard's own cell; '' if it is not known.
    :param params_files: Those of several cells, as '/cell_1=FILE; /cell_2=FILE'.
    :param own: The namespace of the dashboard's own cell.
    :raises InvalidValueError: If `params_files` is no such list.
    """

    def __init__(self, params_file: str = '', params_files: str = '', own: str = '/') -> None:
        self._files = dict(map(_cell_and_file, filter(str.strip, params_files.split(';'))))
        if params_file:
            self._files.setdefault(own, params_file)
        self._folder = os.path.dirname(os.path.abspath(os.path.expanduser(params_file)))

    def of(self, cell: str) -> str:
        """Return a cell's file; '' if it is not known."""
        if cell in self._files or not self._files:
            return self._files.get(cell, '')
        # Another cell than those that the dashboard was started for.
        path = os.path.join(self._folder, (cell.strip('/').replace('/', '_') or 'cell') + '.yaml')
        return '' if path in map(os.path.abspath, self._files.values()) else path


def _cell_and_file(text: str) -> Sequence[str]:
    cell, _, path = map(str.strip, text.partition('='))
    if not cell.startswith('/') or not path:
        raise InvalidValueError(
            f"params_files must be a list such as '/cell_1=FILE; /cell_2=FILE', got '{text:.80}'")
    return cell, path


class StoredFile:
    """
    A parameter file on the disk, which is read again when it has changed.

    :param path: Its path; '' for none.
    """

    def __init__(self, path: str) -> None:
        self.path = os.path.abspath(os.path.expanduser(path)) if path else ''
        self._read_at: Any = None
        self._file: Optional[ParameterFile] = None

    @property
    def folder(self) -> str:
        """The folder that the dashboard writes in, and in no other."""
        return os.path.dirname(self.path) if self.path else os.getcwd()

    @property
    def content(self) -> Optional[ParameterFile]:
        """What it holds for all nodes; None if there is no such file, or it cannot be read."""
        try:
            now = os.stat(self.path).st_mtime_ns if self.path else None
        except OSError:
            now = None
        if now != self._read_at:
            self._read_at, self._file = now, None
            try:
                self._file = None if now is None else read_quietly(self.path)
            except CameraToBaseError:
                pass  # it is refused when it is to be overwritten
        return self._file

    @property
    def values(self) -> Values:
        """Its parameters by full name."""
        return self.content.values if self.content else {}

    def beside(self, name: Any) -> 'StoredFile':
        """
        Return the file with a name in the same folder, to write to.

        :raises InvalidValueError: If it is no name of a parameter file, or lies elsewhere.
        """
        if name in (None, '') and not self.path:
            raise InvalidValueError('name the file to write, such as cell.yaml')
        if name is not None and (not isinstance(name, str) or len(name) > 400 or '\0' in name):
            raise InvalidValueError('expected the name of a file, such as cell.yaml')
        path = os.path.abspath(os.path.join(self.folder, os.path.expanduser(name))) \
            if name else self.path
        if not path.endswith(_ENDINGS):
            raise InvalidValueError(f"'{path}' must end in .yaml: it is a parameter file")
        if path != self.path:
            self._refuse_elsewhere(path)
        check_folder(path, 'file')
        return self if path == self.path else StoredFile(path)

    def _refuse_elsewhere(self, path: str) -> None:
        # A link in the folder may lead out of it.
        if os.path.dirname(os.path.realpath(path)) != os.path.realpath(self.folder):
            raise InvalidValueError(
                f"'{path}' does not lie in '{self.folder}', and the dashboard writes there alone: "
                'name a file of this folder, or start the dashboard with another params_file')


def read_quietly(path: str) -> ParameterFile:
    """
    Read a file for all nodes; what is wrong with it is told without quoting it.

    :raises InvalidValueError: If it cannot be read.
    """
    try:
        with open(path, 'rb'):
            pass
        single = [section.node for section in read_sections(path) if section.node != '/**']
        file = None if single else read_parameter_file(path)
    except OSError as error:
        raise InvalidValueError(f"cannot read '{path}': {error.strerror}") from error
    except CameraToBaseError as error:
        raise InvalidValueError(
            f"'{path}' is no parameter file for all nodes: look at it on the machine that the "
            'dashboard runs on') from error
    if file is None:
        raise InvalidValueError(
            f"'{path}' has parameters for single nodes, which would be lost: name another file")
    return file


def values_to_save(old: Values, cell: CellValues) -> Dict[str, Any]:
    """
    Return what a file must hold so that both nodes start with the values that they have now.

    :param old: The file's values by full name: what is not a parameter of a running node stays.
    """
    now = _values_now(cell)
    given = {name: value for name, value in now.items() if name not in _PASSING
             and name in _ALL and value != _ALL[name].default}
    if any(name in given for name in _ERROR_OF_BASE):
        # A place that happens to be the default was measured, too.
        given.update({name: now[name] for name in _PLACE})
    kept = {name: value for name, value in old.items()
            if name not in now or now[name] == value}
    if cell.transform is None and _is_another_surface(old, {**kept, **given}):
        kept = {name: value for name, value in kept.items() if not _is_of(BASE, name)}
    # In the file's order, then in that of the parameters.
    return {name: given.get(name, kept.get(name)) for name in dict.fromkeys((*old, *given))
            if name in given or name in kept}


def _values_now(cell: CellValues) -> Dict[str, Any]:
    # What both nodes have is the transform node's, unless it has the default; the base frame is
    # always the transform node's.
    camera = {name: value for name, value in (cell.camera or {}).items()
              if not _is_of(BASE, name)}
    transform = {name: value for name, value in (cell.transform or {}).items()
                 if name not in camera or name not in _ALL or value != _ALL[name].default}
    return {**camera, **transform}


def _is_of(part: str, name: str) -> bool:
    return part in parts_of([name])


def _is_another_surface(old: Values, new: Values) -> bool:
    """Return whether the base frame of a file was measured on another surface."""
    return any(_is_of(SURFACE, name) and name.startswith('surface.')
               and old.get(name) != new.get(name) for name in (*old, *new))


class Loss(NamedTuple):
    """
    What saving would remove or replace.

    :param sentence: Asks whether it may.
    :param removes: The parts of the calibration, in words.
    :param verb: What is done to them.
    """

    sentence: str
    removes: List[str]
    verb: str = 'Remove'


def loss_of(own: StoredFile, target: StoredFile, new: Values) -> Optional[Loss]:
    """
    Tell which calibration in a file would be gone, or replaced by an older one; None for none.

    :param own: The cell's file.
    :param target: The one to write.
    :param new: What it would hold.
    """
    held = parts_of(target.values)
    name = os.path.basename(target.path)
    if target is not own and held:
        return Loss(f"'{name}' exists, and holds {_and(held)}, perhaps of another cell. Replace "
                    'it?', held, 'Replace')
    lost = [part for part in held if part not in parts_of(new)]
    if lost:
        return Loss(f"'{name}' holds {_and(lost)}, which the running nodes do not have. Remove "
                    f'{"it" if len(lost) == 1 else "them"} from the file?', lost)
    newer = [part for part in held if _is_newer(_RECORDS.get(part, ''), target.values, new)]
    if newer:
        return Loss(f"'{name}' holds {_and(newer)} of a later date than the running nodes have, "
                    'perhaps from the command calibrate. Replace it? To use it, load the file.',
                    newer, 'Replace')
    return None


def _is_newer(record: str, held: Values, new: Values) -> bool:
    dates = calibration_date(held, record), calibration_date(new, record)
    return None not in dates and dates[0] > dates[1]


def _and(words: Sequence[str]) -> str:
    return ' and '.join(filter(None, (', '.join(words[:-1]), words[-1])))


def changed_values(old: Values, new: Values) -> List[Dict[str, Any]]:
    """Describe as JSON what differs between two files."""
    names = [name for name in dict.fromkeys((*old, *new)) if old.get(name) != new.get(name)]
    return [{'name': name, 'old': _text(old.get(name)), 'new': _text(new.get(name)),
             'nodes': _nodes(name)} for name in names]


def file_text(
    values: Values, old: Optional[ParameterFile], calibrations: Sequence[Optional[Calibration]]
) -> str:
    """
    Return the text of the file, the reports of its calibrations at its top.

    :param values: See :func:`values_to_save`.
    :param old: The old file, with reports of its own.
    :param calibrations: Those that were made since; the others' reports are in the file.
    """
    return cell_text(values, *(_report(part, values, old, calibrations)
                               for part in (BASE, SURFACE)))


def unlike_values(cell: CellValues) -> List[str]:
    """Name the parameters that the two nodes have both, with different values."""
    if cell.camera is None or cell.transform is None:
        return []
    return [name for name in SPECS['transform']
            if name in cell.camera and cell.camera[name] != cell.transform.get(name)]


def _report(
    part: str, values: Values, old: Optional[ParameterFile],
    calibrations: Sequence[Optional[Calibration]],
) -> List[str]:
    record = values.get(_RECORDS[part])
    for calibration in filter(None, calibrations):
        if record and part_values(calibration).get(_RECORDS[part]) == record:
            return report_lines(calibration.report)
    if old is not None and record and old.values.get(_RECORDS[part]) == record:
        return report_of(old.comments, part)
    return []


def _nodes(name: str) -> str:
    holders = [node for node, specs in SPECS.items() if name in specs]
    return 'both' if len(holders) == 2 else ''.join(holders)


def _text(value: Any) -> Optional[str]:
    if isinstance(value, list):
        if len(value) > _MOST_NUMBERS:
            return f'{len(value)} numbers'
        return ', '.join(map(_text, value)) or '(empty)'
    if isinstance(value, float):
        return f'{value:g}'
    if isinstance(value, str) and len(value) > 100:
        return f'{len(value)} characters'
    return value if value is None else str(value)
