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

"""What a parameter file holds of a calibration, how old and how good it is, and what it lacks."""

from datetime import datetime
import re
from typing import Any, Iterator, List, Mapping, NamedTuple, Optional, Tuple

from camera_to_base.calibration.cell_file import BASE
from camera_to_base.calibration.error_map import VERDICTS
from camera_to_base.calibration.figures import coverage
from camera_to_base.calibration.report_text import Report
from camera_to_base.parameters import age_text, calibration_summary
from camera_to_base.surface import make_hull, make_surface, SURFACE_DEFAULTS

# The first line of a report, see `report_lines`.
_TITLE = re.compile(r'(homography|polynomial|rigid|markers) from (.+), (\d{4}-\d\d-\d\dT\S+)')
_FIGURES = ('error at ', *(f'{word}: 95 %' for word, *_ in VERDICTS))
_WARNING = 'warning: '


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
        return NextStep(('board', '--camera', source, '--placements', '4', '-o', path), source)
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
        holds += _surface_lines(values, _newest(sections, 'homography', 'polynomial'), now)
    else:
        lacks.append('the surface')
    if values.get('surface.camera_height_cm'):
        holds.append(f'camera: {values["surface.camera_height_cm"]:g} cm above the surface')
    else:
        lacks.append("the camera's height, which objects that are not flat need (calibrate board "
                     'with --intrinsics)')
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
            'lacks': lacks, 'warnings': warnings}


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
    models = ('rigid',) if part == BASE else ('homography', 'polynomial')
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
    known = {**SURFACE_DEFAULTS, **values, 'object_height_cm': 0.0}
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
