# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The report of a fitted board, and how well each placement fits it."""

from typing import Any, Dict, List, Optional, Sequence

from camera_to_base.calibration import Calibration, Placement, report_lines
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import checked_values, default_values
from camera_to_base.settings import camera_settings, CAMERA_SPECS
from camera_to_base.surface import Surface
import cv2
import numpy as np

# Of the panels of a report picture, in their order.
PANEL_NAMES: List[str] = ['fit', 'above', 'errors', 'raised']

_MM_PER_CM = 10.0


def report_data(calibration: Calibration, placement_count: int) -> Dict[str, Any]:
    """Describe a fit; its pictures are named as the server serves them."""
    report = calibration.report
    return {
        'held_out_mm': report['leave_one_out_rms_mm'], 'rms_mm': report['rms_mm'],
        'largest_mm': report['max_mm'], 'points': report['points'],
        'placements': placement_count, 'covered': report['coverage'],
        'lines': [line for line in report_lines(report) if not line.startswith('warning: ')],
        'warnings': list(report['warnings']), 'error_map_mm': report['error_map_mm'],
        'pictures': [{'title': panel.title, 'url': f'/api/report/{name}.png?{report["date"]}'}
                     for name, panel in zip(PANEL_NAMES, calibration.panels)],
        'text_url': f'/api/report/board.txt?{report["date"]}'}


def report_part(calibration: Optional[Calibration], name: str) -> bytes:
    """
    Return a part of the report: a picture of PANEL_NAMES, 'fit.png', or 'board.txt'.

    :raises InvalidValueError: If there is none.
    """
    stem, _, ending = name.partition('.')
    if calibration is not None and name == 'board.txt':
        return '\n'.join([*report_lines(calibration.report), '']).encode()
    if calibration is None or stem not in PANEL_NAMES or ending != 'png':
        raise InvalidValueError(f'there is no report {name:.40}')
    picture = calibration.panels[PANEL_NAMES.index(stem)].picture
    return cv2.imencode('.png', picture)[1].tobytes()


def placement_errors(calibration: Calibration, flat: Sequence[Placement]) -> List[float]:
    """
    Return how well the corners of each placement on the table fit its printed board.

    The calibrated surface tells where the corners lie; the board is laid over them as well as
    it can be, and what is left is the error.

    :param flat: The placements that were fitted.
    :returns: Of each, the rms in mm.
    """
    settings = camera_settings(checked_values(
        CAMERA_SPECS, {**default_values(CAMERA_SPECS), **calibration.values}))
    return [round(_MM_PER_CM * shape_error_cm(settings.surface, one), 3) for one in flat]


def tilted_errors(calibration: Calibration) -> List[float]:
    """Return how well each tilted picture fits, in px rms; none without tilted pictures."""
    return [one['rms_px'] for one in calibration.report.get('pictures', ()) if one['is_tilted']]


def shape_error_cm(surface: Surface, placement: Placement) -> float:
    """Return the rms distance of a placement's corners from the board that fits them best."""
    seen = surface.locate(placement.matched.pixels)
    printed = np.asarray(placement.matched.points, float)
    seen, printed = seen - seen.mean(axis=0), printed - printed.mean(axis=0)
    left, _, right = np.linalg.svd(printed.T @ seen)
    return float(np.sqrt(np.mean(np.sum((printed @ left @ right - seen) ** 2, axis=1))))
