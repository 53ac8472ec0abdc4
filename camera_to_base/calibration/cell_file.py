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

"""The parts of a parameter file that grows with each step of a calibration."""

import re
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence

from camera_to_base.calibration.error_map import ErrorMap
from camera_to_base.calibration.result import Calibration
from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import calibration_record, parameter_text
from camera_to_base.uncertainty import SURFACE_COVARIANCE

TITLE = 'Written by `calibrate` of camera_to_base.'
SURFACE, BASE, MARKERS = 'the surface', 'the base frame', 'the markers'
_BASE_NAMES = ('rotation_deg', 'displacement_cm', 'base_covariance', 'calibration.base')
_SURFACE_NAMES = ('calibration.surface', 'calibration.device', 'calibration.thumbnail')
# Set by a user, for any surface.
_OPTIONS = ('surface.reject_outside_hull',)
# In cm of the camera frame, which another surface puts elsewhere.
_AREAS = ('work_area', 'ignored_areas')
_HEIGHT = 'object_height_cm'
# What a person looks for stands first, what only a node reads last.
_FIRST = ('source', 'surface', 'rotation_deg', 'displacement_cm')
_LAST = ('calibration.thumbnail', SURFACE_COVARIANCE, 'base_covariance')
_SUMMARY = re.compile('(camera|pictures|surface|accuracy|base frame)  ')


class GrownFile(NamedTuple):
    """
    A file's parameters after a step.

    :param values: By full name.
    :param dropped: What was left out because it depends on a part that has changed.
    """

    values: Dict[str, Any]
    dropped: List[str]

    @property
    def warnings(self) -> List[str]:
        """Say what was left out."""
        return [f'left out of the file: {name}: it was made for the former surface; measure it '
                'again' for name in self.dropped]


def parts_of(values: Mapping[str, Any]) -> List[str]:
    """List the parts that a file holds: SURFACE, MARKERS, BASE."""
    held = {_part(name) for name in values}
    return [part for part in (SURFACE, MARKERS, BASE) if part in held]


def parts_to_lose(values: Mapping[str, Any], part: str) -> List[str]:
    """List the parts that a new part replaces, or makes wrong."""
    return [held for held in parts_of(values) if held == part or part == SURFACE]


def grown(old: Mapping[str, Any], new: Mapping[str, Any], part: str) -> GrownFile:
    """
    Add a part to a file's parameters, or replace it; keep what does not depend on it.

    :param old: The file's parameters by full name.
    :param new: Those of the part; a surface may bring its markers.
    :param part: SURFACE, MARKERS or BASE.
    """
    if part != SURFACE:
        kept = {name: value for name, value in old.items() if _part(name) != part}
        return GrownFile({**kept, **new}, [])
    kept = {name: value for name, value in old.items() if _part(name) is None}
    dropped = [other for other in (MARKERS, BASE)
               if other in parts_of(old) and other not in parts_of(new)]
    # A list that is empty, or 0, depends on nothing.
    for name in (name for name in _AREAS if kept.get(name)):
        dropped.append(name)
        del kept[name]
    if kept.get(_HEIGHT) and not new.get('surface.camera_height_cm'):
        dropped.append(f"{_HEIGHT}, which needs the camera's height")
        del kept[_HEIGHT]
    return GrownFile({**kept, **new}, dropped)


def part_values(calibration: Calibration) -> Dict[str, Any]:
    """Return what a calibration adds to a file: its parameters, and its record, if any."""
    report = calibration.report
    if report['model'] == 'markers':
        return dict(calibration.values)
    record = 'calibration.base' if report['model'] == 'rigid' else 'calibration.surface'
    return {**calibration.values, record: calibration_record(report)}


def cell_text(values: Mapping[str, Any], *reports: Sequence[str]) -> str:
    """
    Return the text of a parameter file that says at its top how it was calibrated.

    :param values: By full name.
    :param reports: The lines of each report, the newest report first.
    """
    kept = [[line for line in report if not _SUMMARY.match(line)] for report in reports]
    comments = [line for report in kept if any(report) for line in ('', *report)]
    ordered = sorted(values.items(), key=lambda item: _place(item[0]))
    return parameter_text(dict(ordered), [TITLE, *_summary(values), *comments], _LAST)


def _place(name: str) -> int:
    group = name.partition('.')[0]
    return _FIRST.index(group) if group in _FIRST else len(_FIRST)


def _summary(values: Mapping[str, Any]) -> Iterator[str]:
    """Write what a person looks for, a line each."""
    lines = {'camera': values.get('calibration.device') or values.get('source')}
    if 'surface.image_size' in values:
        lines['pictures'] = '{} x {} px'.format(*values['surface.image_size'])
    lines['surface'] = values.get('calibration.surface')
    lines['accuracy'] = _accuracy(values)
    lines['base frame'] = values.get('calibration.base')
    return (f'{name:<12}{text}' for name, text in lines.items() if text)


def _accuracy(values: Mapping[str, Any]) -> Optional[str]:
    if SURFACE_COVARIANCE not in values:
        return None
    try:
        return ErrorMap(values).fields.get('verdict_sentence')
    except CameraToBaseError:
        return None


def _part(name: str) -> Optional[str]:
    if name in _BASE_NAMES:
        return BASE
    if name.startswith('markers.'):
        return MARKERS
    is_surface = name.startswith('surface.') and name not in _OPTIONS
    return SURFACE if is_surface or name in _SURFACE_NAMES else None
