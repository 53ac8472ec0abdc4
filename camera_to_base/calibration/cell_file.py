# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A parameter file that grows with each step of a calibration: its parts, status and changes."""

from datetime import datetime
import re
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.calibration.figures import coverage
from camera_to_base.calibration.report import ErrorMap, Report, VERDICTS
from camera_to_base.calibration.result import Calibration
from camera_to_base.errors import CalibrationError, CameraToBaseError
from camera_to_base.parameters import (
    age_text, calibration_record, calibration_summary, parameter_text, ParameterFile)
from camera_to_base.surface import make_hull, make_surface, SURFACE_DEFAULTS
from camera_to_base.uncertainty import (
    CAMERA_COVARIANCE, camera_covariance, place_95, SURFACE_COVARIANCE)
import numpy as np

TITLE = 'Written by `calibrate` of camera_to_base.'
SURFACE, BASE, MARKERS = 'the surface', 'the base frame', 'the markers'
_BASE_NAMES = ('rotation_deg', 'displacement_cm', 'base_covariance', 'calibration.base')
_SURFACE_NAMES = ('calibration.surface', 'calibration.device', 'calibration.thumbnail')
# Set by a user, for any surface.
_OPTIONS = ('surface.reject_outside_hull',)
# In cm of the camera frame, which another surface puts elsewhere.
_AREAS = ('work_area', 'ignored_areas')
_HEIGHTS = 'object_height_cm', 'object_heights_cm'
# What a person looks for stands first, what only a node reads last.
_FIRST = ('source', 'surface', 'rotation_deg', 'displacement_cm')
_LAST = ('calibration.thumbnail', CAMERA_COVARIANCE, SURFACE_COVARIANCE, 'base_covariance')
_SUMMARY = re.compile('(camera|pictures|surface|accuracy|base frame)  ')

# The first line of a report, see `report_lines`.
_TITLE = re.compile(
    r'(homography|pinhole|polynomial|rigid|markers) from (.+), (\d{4}-\d\d-\d\dT\S+)')
_FIGURES = ('error at ', *(f'{word}: 95 %' for word, *_ in VERDICTS))
_WARNING = 'warning: '
_SURFACE_MODELS = 'homography', 'pinhole', 'polynomial'


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
    knows_camera = new.get('surface.camera_height_cm') or new.get('surface.model') == 'pinhole'
    for name in (name for name in _HEIGHTS if kept.get(name) and not knows_camera):
        dropped.append(f"{name}, which needs the camera's height")
        del kept[name]
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


class OfferedCorrection(NamedTuple):
    """
    What a camera node offers to keep, see its service `~/corrected_surface`.

    :param sentence: What it corrects.
    :param values: The parameters that make the correction a calibration, by full name.
    :param before: The parameters of the surface that it corrects.
    """

    sentence: str
    values: Mapping[str, Any]
    before: Mapping[str, Any]


def corrected_file_text(path: str, file: ParameterFile, offer: OfferedCorrection) -> str:
    """
    Return the text of a parameter file with a correction.

    The camera frame is the same as before, so that the base frame, the markers and the areas stay.

    :param path: The file, for the message.
    :raises CalibrationError: If it holds another surface than the one that was corrected.
    """
    others = [name for name, value in file.values.items()
              if name in offer.before and value != offer.before[name]]
    if others:
        raise CalibrationError(
            f"'{path}' has another {others[0]} than the running node, so that its correction does "
            'not belong to this file: name the file that the node was started with')
    record = offer.values['calibration.surface']
    return cell_text({**file.values, **offer.values}, [f'kept: {record}'], _without(
        file.comments, 'kept: '))


def _without(comments: Sequence[str], beginning: str) -> Sequence[str]:
    kept = [line for line in comments if line != TITLE and not line.startswith(beginning)]
    while kept and not kept[0]:
        del kept[0]
    return kept


class NextStep(NamedTuple):
    """
    What to do next with a parameter file.

    :param arguments: Those of `calibrate`; empty if the file is whole, and the cell can run.
    :param source: The camera, as far as the file names it.
    """

    arguments: Tuple[str, ...]
    source: str


def next_step(path: str, values: Mapping[str, Any]) -> NextStep:
    """Tell what a file lacks first; `values` are its parameters, by full name."""
    source = str(values.get('source', '0'))
    if 'surface.model' not in values:
        return NextStep(('board', '--camera', source, '-o', path), source)
    if 'displacement_cm' not in values and 'rotation_deg' not in values:
        way = '--markers' if values.get('markers.numbers') else '--live'
        return NextStep(('base', way, path), source)
    return NextStep((), source)


def file_status(
    path: str, values: Mapping[str, Any], comments: List[str], now: datetime
) -> Report:
    """
    Tell what a file holds.

    :param path: What the advice calls the file.
    :param values: Its parameters, by full name.
    :param comments: The lines at its top.
    :param now: With its time zone.
    :returns: `holds`, lines for each part; `lacks`; and `warnings`, those of
        the reports that are in the comments.
    :raises CameraToBaseError: If the parameters make no surface.
    """
    sections = _sections(comments)
    holds, lacks = [], []
    if 'surface.model' in values:
        holds += _surface_lines(values, _newest(sections, *_SURFACE_MODELS), now)
    else:
        lacks.append('the surface')
    camera = camera_fields(values)
    if camera is not None:
        holds.append(_camera_line(camera))
    elif values.get('surface.camera_height_cm'):
        holds.append(f'camera: {values["surface.camera_height_cm"]:g} cm above the surface')
    else:
        lacks.append("the camera's height, which objects with a height need (calibrate board, "
                     'with the board held at a tilt, too)')
    if values.get('markers.numbers'):
        names = ', '.join(f'{number:g}' for number in values['markers.numbers'])
        holds.append(f'markers: {names}')
    if 'displacement_cm' in values or 'rotation_deg' in values:
        holds += _base_lines(values, _newest(sections, 'rigid'), now)
    else:
        lacks.append('the base frame')
    warnings = [line.removeprefix(_WARNING) for _, lines in sections for line in lines
                if line.startswith(_WARNING)]
    return {'status_of': path, 'summary': calibration_summary(values, now), 'holds': holds,
            'lacks': lacks, 'camera': camera, 'warnings': warnings}


def camera_fields(values: Mapping[str, Any]) -> Optional[Dict[str, Any]]:
    """
    Return where the camera is by a file's parameters.

    The keys that end in _95 say within how much the truth lies with a chance of 95 %; None for not
    known.

    :param values: By full name.
    :returns: `height_cm`, `foot_cm` and `focal_px`; None if the file does not tell the place.
    :raises CameraToBaseError: If the parameters make no surface.
    """
    surface = make_surface({**SURFACE_DEFAULTS, **values})
    place = surface.camera_place if 'surface.model' in values else None
    if place is None:
        return None
    lens = getattr(surface, 'lens', None)
    found = {'height_cm': place.height_cm, 'height_cm_95': None, 'foot_cm': list(place.foot_cm),
             'foot_cm_95': None, 'focal_px': None if lens is None else float(np.mean(lens.focal)),
             'focal_px_95': None}
    if values.get(CAMERA_COVARIANCE):
        found.update(place_95(camera_covariance(values[CAMERA_COVARIANCE])))
    return found


def _camera_line(camera: Mapping[str, Any]) -> str:
    sure = ('' if camera['height_cm_95'] is None else
            ' (95 %: ± {height_cm_95:.2f} cm, foot point ± {foot_cm_95:.2f} cm)'.format(**camera))
    return f'camera: {camera["height_cm"]:.4g} cm above the surface{sure}'


def without_report(comments: List[str], model: str) -> List[str]:
    """Leave the reports of a model out of a file's comments, which a new one replaces."""
    kept, is_left_out = [], False
    for line in comments:
        title = _TITLE.fullmatch(line)
        is_left_out = title[1] == model if title else is_left_out and line != ''
        if not is_left_out:
            kept.append(line)
    return kept


def report_of(comments: List[str], part: str) -> List[str]:
    """
    Return the lines of the newest report of a part, SURFACE or BASE; [] if there is none.

    :param comments: The lines at a file's top.
    """
    models = ('rigid',) if part == BASE else _SURFACE_MODELS
    section = _newest(_sections(comments), *models)
    if section is None:
        return []
    title, lines = section
    return [title[0], *(lines[:lines.index('')] if '' in lines else lines)]


_Section = Tuple[re.Match, List[str]]


def _sections(comments: List[str]) -> List[_Section]:
    """Return each report's title, and the lines below it."""
    found: List[_Section] = []
    for line in comments:
        title = _TITLE.fullmatch(line)
        if title:
            found.append((title, []))
        elif found:
            found[-1][1].append(line)
    return found


def _newest(sections: List[_Section], *models: str) -> Optional[_Section]:
    # `calibrate base` writes its report above those that it copies.
    return next((section for section in sections if section[0][1] in models), None)


def _surface_lines(
    values: Mapping[str, Any], section: Optional[_Section], now: datetime
) -> Iterator[str]:
    known = {**SURFACE_DEFAULTS, **values}
    make_surface(known)
    size, hull = known['surface.image_size'], make_hull(known)
    yield f'surface: {known["surface.model"]} for pictures of {size[0]} x {size[1]} px' + _origin(
        section, now)
    yield from _figures(section)
    if hull is not None:
        yield (f'  measured in {100 * coverage(hull, size):.0f} % of the picture; outside of it '
               'the figures do not hold')


def _base_lines(
    values: Mapping[str, Any], section: Optional[_Section], now: datetime
) -> Iterator[str]:
    yield 'base frame' + _origin(section, now)
    for name in ('rotation_deg', 'displacement_cm'):
        if name in values:
            yield f'  {name}: ' + ', '.join(f'{number:.2f}' for number in values[name])
    yield from _figures(section)


def _origin(section: Optional[_Section], now: datetime) -> str:
    if section is None:
        return ': the comments do not tell from what, when, or how good'
    _, source, date = section[0].groups()
    return f', from {source}, {age_text(date, now)}'


def _figures(section: Optional[_Section]) -> Iterator[str]:
    lines = section[1] if section else []
    yield from (f'  {line}' for line in lines if line.startswith(_FIGURES))
