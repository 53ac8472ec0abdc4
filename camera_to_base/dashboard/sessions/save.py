# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Saving: what differs from the file, what is asked first, and how the nodes go back to a file."""

from datetime import datetime
import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

from camera_to_base.calibration import Calibration, corrected_file_text, OfferedCorrection
from camera_to_base.dashboard.sessions.cell_file import (
    changed_values, file_text, loss_of, read_quietly, StoredFile, unlike_values, values_to_save)
from camera_to_base.dashboard.sessions.values import CellChanges, CellValues, SPECS
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.files import history_of, write_with_history
from camera_to_base.parameters import calibration_summary, ParameterFile

_NODES = {'camera': 'camera_publisher', 'transform': 'robot_base_publisher'}


class SaveSession:
    """
    Compares what the nodes have with the cell's file, writes it, and goes back to a former one.

    :param values: The cell's parameters.
    :param calibrations: Returns the calibrations that were made on the page.
    :param path: The file; '' if it is not known yet.
    :param on_change: Called when the state has changed.
    :param owner_of: Returns another cell whose file has a path; None for none.
    """

    def __init__(
        self, values: CellValues, calibrations: Callable[[], Sequence[Optional[Calibration]]],
        path: str, on_change: Callable[[], None],
        owner_of: Callable[[str], Optional[str]] = lambda path: None,
    ) -> None:
        self._values, self._calibrations, self._on_change = values, calibrations, on_change
        self._owner_of = owner_of
        self._file = StoredFile(path)
        self._error: Optional[str] = None
        self._question: Optional[Dict[str, Any]] = None
        self._saved: Optional[Dict[str, Any]] = None
        # What is being loaded, and the nodes' values before; then those of what was loaded.
        self._wanted: Any = '', None
        self._before: Optional[Dict[str, Any]] = None

    @property
    def path(self) -> str:
        """The cell's file; '' if it is not known."""
        return self._file.path

    @property
    def beside(self) -> Tuple[str, str]:
        """The folder of the cell's file, and the name without its ending."""
        stem = os.path.splitext(os.path.basename(self.path))[0]
        return self._file.folder, stem or 'cell'

    @property
    def actions(self) -> Dict[str, Callable[[Mapping[str, Any]], Any]]:
        """What a page can ask for, by name."""
        return {'save': self.save, 'cancel': self.cancel, 'load': self.load, 'undo': self.undo}

    @property
    def state(self) -> Dict[str, Any]:
        """The state as JSON."""
        old = self._file.values
        new = values_to_save(old, self._values)
        return {'path': self.path, 'folder': self._file.folder,
                'from': self.path if self._file.content else None,
                'needs': self._needs(), 'changes': changed_values(old, new),
                'warnings': self._warnings(),
                # Without a node and a file, it is not known what is calibrated.
                'calibration': calibration_summary(new) if new or not self._needs() else None,
                'former': _former(self.path), 'can_undo': self._before is not None,
                'question': self._question,
                'error': self._error, 'saved': self._saved}

    def text(self) -> str:
        """Return the file as it would be saved."""
        return self._text(self._file)

    def save(self, body: Mapping[str, Any]) -> None:
        """
        Write the file, unless a calibration would be gone: then the state has a question.

        :param body: {'path': another file of the folder, 'removes': what may be gone}, or {}.
        :raises InvalidValueError: If it cannot be written; then nothing is.
        """
        self._write(body, self._text)

    def keep(self, offer: OfferedCorrection, body: Mapping[str, Any]) -> None:
        """
        Write the file with the correction of a nudge, before the nodes have it.

        :param body: {'path': another file}, or {}.
        :raises InvalidValueError: If it cannot be written; then nothing is.
        """
        self._write(body, lambda file: self._corrected_text(file, offer))
        if self._question:
            raise InvalidValueError(
                f'{self._question["sentence"]} Save first, then keep the correction')

    def cancel(self, body: Mapping[str, Any]) -> None:
        """Take a question back: nothing is written."""
        self._question = None
        self._on_change()

    def load(self, body: Mapping[str, Any]) -> CellChanges:
        """
        Return what is to be set for the nodes to have the values of the file, or a former one.

        :param body: {'number': of a former file, the newest is 1}; the file itself without.
        :raises InvalidValueError: If it cannot be read.
        """
        number = body.get('number')
        paths = [self.path, *history_of(self.path)] if self.path else []
        index = 0 if number is None else number
        if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < len(paths):
            raise InvalidValueError(f'there is no former file {number!r:.20}')
        wanted = read_quietly(paths[index]).values
        self._saved = self._error = self._question = None
        self._wanted = os.path.basename(paths[index]), {node: getattr(self._values, node) or {}
                                                        for node in _NODES}
        return CellChanges({node: changes for node in _NODES if (
            changes := self._back_to(wanted, node))}, [])

    def undo(self, body: Mapping[str, Any]) -> CellChanges:
        """
        Return what is to be set for the nodes to have the values from before :meth:`load`.

        :raises InvalidValueError: If nothing was loaded.
        """
        if self._before is None:
            raise InvalidValueError('no file was loaded, so there is nothing to undo')
        before, self._wanted = self._before, ('', None)
        return CellChanges({node: changes for node in _NODES if (
            changes := self._back_to(before[node], node))}, [])

    def set_loaded(self) -> None:
        """Remember that the nodes have the values of a file, or those from before."""
        name, self._before = self._wanted
        self._saved = {'sentence': (
            f'The running nodes have the values of {name}. What is read at the start only takes '
            'effect at the next one.' if name else 'The running nodes have their values again.')}

    def _back_to(self, wanted: Mapping[str, Any], node: str) -> Dict[str, Any]:
        now = getattr(self._values, node) or {}
        back = {name: wanted.get(name, spec.default) for name, spec in SPECS[node].items()
                if name in now and not spec.fixed}
        return {name: value for name, value in back.items() if value != now[name]}

    def _text(self, file: StoredFile) -> str:
        return file_text(values_to_save(file.values, self._values), file.content,
                         self._calibrations())

    def _corrected_text(self, file: StoredFile, offer: OfferedCorrection) -> str:
        lines = self._text(file).splitlines()
        return corrected_file_text(file.path, ParameterFile(
            values_to_save(file.values, self._values),
            [line[2:] for line in lines if line.startswith('#')]), offer)

    def _write(self, body: Mapping[str, Any], text: Callable[[StoredFile], str]) -> None:
        self._saved = self._error = self._question = None
        try:
            self._write_to(self._target(body), body.get('removes'), text)
        except CameraToBaseError as error:
            self._error = str(error)
            raise
        finally:
            self._on_change()

    def _target(self, body: Mapping[str, Any]) -> StoredFile:
        if self._needs():
            raise InvalidValueError(self._needs())
        target = self._file.beside(body.get('path'))
        owner = self._owner_of(target.path)
        if owner is not None:
            raise InvalidValueError(
                f"'{target.path}' is the file of the cell {owner}: name another")
        if os.path.exists(target.path):
            read_quietly(target.path)
        return target

    def _write_to(
        self, target: StoredFile, allowed: Any, text: Callable[[StoredFile], str]
    ) -> None:
        loss = loss_of(self._file, target, values_to_save(target.values, self._values))
        if loss is not None and allowed != loss.removes:
            self._question = {**loss._asdict(), 'path': target.path}
            return
        kept = write_with_history(target.path, text(target).encode())
        self._file = target
        self._saved = {'sentence': f'Written to {target.path}' + (
            f'; the old file is {kept}.' if kept else '.')}

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


def _former(path: str) -> List[Dict[str, Any]]:
    """Describe the kept former files as JSON, the newest first."""
    return [{'number': number, 'name': os.path.basename(one), 'date': datetime.fromtimestamp(
        os.stat(one).st_mtime).isoformat(' ', 'seconds')}
        for number, one in enumerate(history_of(path), 1)] if path else []
