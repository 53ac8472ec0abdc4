# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A cell's parameter file: what it would hold, what that changes, and how it is saved."""

import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence

from camera_to_base.calibration import (
    BASE, Calibration, cell_text, corrected_file_text, OfferedCorrection, part_values,
    report_lines, report_of, SURFACE)
from camera_to_base.dashboard.sessions.values import CellValues, SPECS
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.files import check_folder, write_files
from camera_to_base.parameters import (
    calibration_summary, ParameterFile, read_parameter_file, read_sections, Values)

# What a person shows on the simulated table is no part of the set-up.
_PASSING = ('simulated.shows', 'simulated.placement', 'simulated.touched',
            'simulated.touched_marker')
_RECORDS = {SURFACE: 'calibration.surface', BASE: 'calibration.base'}
_MOST_NUMBERS = 6

_ENDINGS = ('.yaml', '.yml')
_NODES = {'camera': 'camera_publisher', 'transform': 'robot_base_publisher'}


def values_to_save(old: Values, cell: CellValues) -> Dict[str, Any]:
    """
    Return what a file must hold so that both nodes start with the values that they have now.

    :param old: The file's values by full name: what is not a parameter of a running node stays.
    """
    given = {name: value for name, value in cell.given.items() if name not in _PASSING}
    running = {**(cell.camera or {}), **(cell.transform or {})}
    kept = {name: value for name, value in old.items()
            if name not in running or running[name] == value}
    # In the file's order, then in that of the parameters.
    return {name: given.get(name, kept.get(name)) for name in (*old, *given)
            if name in given or name in kept}


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


class SaveSession:
    """
    Compares what the nodes have with the file, and writes it.

    :param values: The cell's parameters.
    :param calibrations: Returns the calibrations that were made on the page.
    :param path: The file; '' if it is not known yet.
    :param on_change: Called when the state has changed.
    """

    def __init__(
        self, values: CellValues, calibrations: Callable[[], Sequence[Optional[Calibration]]],
        path: str, on_change: Callable[[], None],
    ) -> None:
        self._values, self._calibrations, self._on_change = values, calibrations, on_change
        self._path = os.path.abspath(os.path.expanduser(path)) if path else ''
        self._read_at: Any = None
        self._file: Optional[ParameterFile] = None
        self._error: Optional[str] = None
        self._saved: Optional[Dict[str, Any]] = None

    @property
    def state(self) -> Dict[str, Any]:
        """The state as JSON."""
        self._read()
        old = self._file.values if self._file else {}
        new = values_to_save(old, self._values)
        return {'path': self._path, 'from': self._path if self._file else None,
                'needs': self._needs(), 'changes': changed_values(old, new),
                'warnings': self._warnings(), 'calibration': calibration_summary(new),
                'error': self._error, 'saved': self._saved}

    def text(self) -> str:
        """Return the file as it would be saved."""
        self._read()
        old = self._file.values if self._file else {}
        return file_text(values_to_save(old, self._values), self._file, self._calibrations())

    def save(self, body: Mapping[str, Any]) -> None:
        """
        Write the file; the old one is kept.

        :param body: {'path': another file}, or {}.
        :raises InvalidValueError: If it cannot be written; then nothing is.
        """
        self._write(body, self.text)

    def keep(self, offer: OfferedCorrection, body: Mapping[str, Any]) -> None:
        """
        Write the file with the correction of a nudge, before the nodes have it.

        :param body: {'path': another file}, or {}.
        :raises InvalidValueError: If it cannot be written; then nothing is.
        """
        self._write(body, lambda: self._corrected_text(offer))

    def _corrected_text(self, offer: OfferedCorrection) -> str:
        lines = self.text().splitlines()
        values = values_to_save(self._file.values if self._file else {}, self._values)
        return corrected_file_text(self._path, ParameterFile(
            values, [line[2:] for line in lines if line.startswith('#')]), offer)

    def _write(self, body: Mapping[str, Any], text: Callable[[], str]) -> None:
        self._saved = self._error = None
        try:
            self._write_to(self._checked_path(body.get('path')), text)
        except CameraToBaseError as error:
            self._error = str(error)
            self._on_change()
            raise

    def _write_to(self, path: str, text: Callable[[], str]) -> None:
        if self._needs():
            raise InvalidValueError(self._needs())
        if path != self._path:
            self._path, self._read_at, self._file = path, None, None
        kept = write_files({path: text().encode()}, keep_old=True)
        self._read()
        self._saved = {'sentence': f'Written to {path}' + (
            f'; the old file is {kept[0]}.' if kept else '.')}
        self._on_change()

    def _checked_path(self, wanted: Any) -> str:
        if wanted in (None, '') and not self._path:
            raise InvalidValueError('name the file to write, such as cell.yaml')
        if not isinstance(wanted, (str, type(None))) or len(wanted or '') > 4000:
            raise InvalidValueError('expected the path of a file')
        path = os.path.abspath(os.path.expanduser(wanted)) if wanted else self._path
        if not path.endswith(_ENDINGS):
            raise InvalidValueError(f"'{path}' must end in .yaml: it is a parameter file")
        check_folder(path, 'file')
        if os.path.exists(path):
            self._refuse_loss(path)
        return path

    def _refuse_loss(self, path: str) -> None:
        single = [section.node for section in read_sections(path) if section.node != '/**']
        if single:
            raise InvalidValueError(
                f"'{path}' has parameters for single nodes ({', '.join(single)}), which would be "
                'lost: name another file')
        read_parameter_file(path)

    def _read(self) -> None:
        """Read the file again if it has changed on the disk."""
        try:
            now = os.stat(self._path).st_mtime_ns if self._path else None
        except OSError:
            now = None
        if now == self._read_at:
            return
        self._read_at, self._file = now, None
        try:
            if now is not None and {one.node for one in read_sections(self._path)} == {'/**'}:
                self._file = read_parameter_file(self._path)
        except CameraToBaseError as error:
            self._error = str(error)

    def _needs(self) -> Optional[str]:
        if self._values.camera is None and self._values.transform is None:
            return 'No node runs, so there is nothing to save: start them.'
        return None

    def _warnings(self) -> List[str]:
        warnings = [f'{name} does not run: what the file holds for it is kept.'
                    for node, name in _NODES.items() if getattr(self._values, node) is None]
        unlike = unlike_values(self._values)
        if unlike:
            warnings.append(
                f'The two nodes differ in {", ".join(unlike)}: the value of robot_base_publisher '
                'is saved for both.')
        return warnings
