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
"""The markers on the surface that a calibration knows: their parameters."""

from typing import Any, Dict

from camera_to_base.errors import InvalidValueError
from camera_to_base.markers.seen import TABLE_MARKERS
from camera_to_base.markers.surface_fit import Corners
from camera_to_base.parameters import ParameterSpec, Values
import numpy as np

NUMBERS, CORNERS = 'markers.numbers', 'markers.corners_cm'
# With fewer, no surface is computed.
LEAST_MARKERS = 3
_COUNTS = tuple(range(LEAST_MARKERS, len(TABLE_MARKERS) + 1))
_LEAST_AREA = 1e-4

MARKER_SPECS = [
    ParameterSpec(NUMBERS, [],
                  'The numbers of the markers that lie on the surface; written by `calibrate '
                  'markers`. Empty for none.', (0, len(TABLE_MARKERS) - 1),
                  lengths=(0, *_COUNTS)),
    ParameterSpec(CORNERS, [],
                  'Where the corners of these markers lie, in the camera frame: x and y of each, '
                  'as it is printed from the top left clockwise, one marker after the other.',
                  (-10000, 10000), unit='cm', lengths=(0, *(8 * count for count in _COUNTS))),
]


def known_markers(values: Values) -> Corners:
    """
    Read the markers of a calibration from its parameters.

    :param values: By full name.
    :returns: By number, shape (4, 2), x and y, in cm; none is {}.
    :raises InvalidValueError: If the parameters do not belong together.
    """
    numbers, corners = values[NUMBERS], values[CORNERS]
    if numbers:
        refuse_polynomial(values)
    if 8 * len(numbers) != len(corners):
        raise InvalidValueError(
            f'{CORNERS} must be 8 numbers for each of {NUMBERS}, got {len(corners)} for '
            f'{len(numbers)}')
    found = {int(number): np.reshape(corners[8 * index:8 * index + 8], (4, 2)).astype(float)
             for index, number in enumerate(numbers)}
    if len(found) != len(numbers) or any(number % 1 for number in numbers):
        raise InvalidValueError(
            f'{NUMBERS} must be different whole numbers, got {list(numbers)}')
    for number, marker in found.items():
        if abs(_area(marker)) < _LEAST_AREA:
            raise InvalidValueError(f'{CORNERS}: marker {number} has no area')
    return found


def refuse_polynomial(values: Values) -> None:
    """
    Refuse a surface that cannot be computed anew.

    :raises InvalidValueError: If it is the polynomial, which no camera elsewhere has.
    """
    if values['surface.model'] == 'polynomial':
        raise InvalidValueError(
            'markers need surface.model homography or parallel: calibrate with calibrate board, '
            'or calibrate points without --model polynomial')


def marker_values(corners: Corners) -> Dict[str, Any]:
    """Give the parameters that :func:`known_markers` reads, rounded to a tenth of a micrometre."""
    numbers = sorted(corners)
    flat = np.concatenate([corners[number].ravel() for number in numbers])
    return {NUMBERS: [float(number) for number in numbers], CORNERS: flat.round(5).tolist()}


def _area(corners: np.ndarray) -> float:
    x, y = corners.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
