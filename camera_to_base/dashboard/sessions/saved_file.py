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

"""The parameter file of a cell: what it would hold, and what that changes."""

from typing import Any, Dict, List, Optional, Sequence

from camera_to_base.calibration import (
    BASE, Calibration, cell_text, part_values, report_lines, report_of, SURFACE)
from camera_to_base.dashboard.sessions.cell_values import CellValues, SPECS
from camera_to_base.parameters import ParameterFile, Values

# What a person shows on the simulated table is no part of the set-up.
_PASSING = ('simulated.shows', 'simulated.placement', 'simulated.touched',
            'simulated.touched_marker')
_RECORDS = {SURFACE: 'calibration.surface', BASE: 'calibration.base'}
_MOST_NUMBERS = 6


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
