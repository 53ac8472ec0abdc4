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

"""The robot session's parts as JSON."""

from typing import Any, Callable, Dict, List, Optional

from camera_to_base.calibration import report_lines
from camera_to_base.dashboard.sessions.robot.followed_object import Point
from camera_to_base.dashboard.sessions.robot.pair_list import Pair, PairFit

PixelOf = Callable[[Point], Optional[List[float]]]
_BAD_SENTENCE = 'it does not belong to the others: measure it again, or remove it'


def pair_data(
    pair: Pair, fit: Optional[PairFit], invalid_because: Optional[str], pixel_of: PixelOf
) -> Dict[str, Any]:
    """Describe a pair; `pixel_of` gives the pixel of a point."""
    is_unfit = fit is not None and fit.unfit == pair.number
    return {
        'number': pair.number, 'name': pair.touched.suggestion.name,
        'camera': point_data(pair.touched.camera_point),
        'base': point_data(pair.touched.base_point), 'pixel': pixel_of(pair.touched.camera_point),
        'residual_mm': fit and fit.residuals_mm.get(pair.number),
        'left_out_mm': fit and fit.left_out_mm.get(pair.number),
        'fits': not is_unfit, 'sentence': _BAD_SENTENCE if is_unfit else None,
        'valid': invalid_because is None, 'invalid_because': invalid_because}


def fit_data(fit: PairFit) -> Dict[str, Any]:
    """Describe the fit to all valid pairs."""
    report = fit.calibration.report if fit.calibration else None
    if report is None:
        return {'sentence': 'The pairs do not fit.', 'rms_mm': None, 'left_out_rms_mm': None,
                'lines': [], 'warnings': [], 'can_accept': False, 'error': fit.error}
    return {
        'sentence': f'The pairs fit to {report["rms_mm"]:.2f} mm rms, the worst to '
                    f'{report["max_mm"]:.2f} mm.',
        'rms_mm': report['rms_mm'], 'left_out_rms_mm': report['leave_one_out_rms_mm'],
        'lines': [line for line in report_lines(report) if not line.startswith('warning: ')],
        'warnings': report['warnings'], 'can_accept': True, 'error': None}


def point_data(point: Point) -> Dict[str, float]:
    """Describe a point, in cm."""
    return {'x': round(point[0], 3), 'y': round(point[1], 3)}
