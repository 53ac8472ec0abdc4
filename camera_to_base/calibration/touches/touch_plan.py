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

"""Where objects are best put for pairs, and the robot's position as a person types it."""

import math
import re
from typing import Iterator, NamedTuple, Optional, Tuple

from camera_to_base.calibration.tables import LARGEST
from camera_to_base.errors import HorizonError, InvalidValueError
from camera_to_base.image_size import ImageSize
from camera_to_base.surface import Hull, Surface

# Shares of the area's width and height. The first five determine the transform well, and tell a
# bad pair; the others are for those who want more.
_PLACES = (('top left', 0.15, 0.15), ('top right', 0.85, 0.15), ('bottom right', 0.85, 0.85),
           ('bottom left', 0.15, 0.85), ('middle', 0.5, 0.5), ('top', 0.5, 0.15),
           ('right', 0.85, 0.5), ('bottom', 0.5, 0.85), ('left', 0.15, 0.5))
# Displays and pages set minus signs and spaces of typography.
_PLAIN = str.maketrans('\u2212\u2013\u2012\u00a0\u2009\u202f', '---   ')
# x -8.68, y 16.69 cm
_LABELLED = re.compile(r'x\s*[:=]?\s*(.+?)\s*[,;]?\s*\by\s*[:=]?\s*(.+)')
_WITH_UNIT = re.compile(r'(.*?\d[.,]?)\s*(mm|cm|m|)')
_CM_PER_UNIT = {'': 1.0, 'cm': 1.0, 'mm': 0.1, 'm': 100.0}


class Suggestion(NamedTuple):
    """
    A place for an object.

    :param name: Its place in the picture.
    :param pixel: u and v, in px.
    :param point: x and y, in cm, in the camera frame.
    """

    name: str
    pixel: Tuple[float, float]
    point: Tuple[float, float]


def suggested_places(
    surface: Surface, hull: Optional[Hull], image_size: ImageSize
) -> Iterator[Suggestion]:
    """
    Suggest places that are spread over the calibrated area; after nine they repeat.

    :param hull: The calibrated area; None stands for the whole picture.
    """
    low, high = (0.0, 0.0), image_size
    if hull is not None:
        low, high = hull.corners.min(axis=0), hull.corners.max(axis=0)
    while True:
        for name, along, down in _PLACES:
            pixel = low[0] + along * (high[0] - low[0]), low[1] + down * (high[1] - low[1])
            try:
                point = tuple(map(float, surface.locate([pixel])[0]))
            except HorizonError:
                continue
            yield Suggestion(name, tuple(map(float, pixel)), point)


def read_typed_position(text: str) -> Tuple[float, float]:
    """
    Read x and y as a person types them, or pastes them from a display.

    As in '12.5 -3', '12,5; -3', '125 -30 mm', 'x -8.68, y 16.69 cm', '(−7.37, 15.46)'.

    :returns: In cm; cm is also the unit where none is given.
    :raises InvalidValueError: If these are not two numbers.
    """
    cells, unit = _without_units(re.sub('[()]', '', text.translate(_PLAIN)).strip().lower())
    numbers = _two_numbers(cells)
    if numbers is None:
        raise InvalidValueError(
            f"expected x and y with a space between, as in 12.5 -3.4, got '{text.strip()}'")
    found = tuple(number * _CM_PER_UNIT[unit] for number in numbers)
    if max(map(abs, found)) > LARGEST:
        raise InvalidValueError(
            f"'{text.strip()}' is farther away than {LARGEST:g} cm: is the unit right? Write it "
            'behind the numbers: mm, cm or m')
    return found


def _without_units(text: str) -> Tuple[str, str]:
    """Return the text of the numbers without labels and units, and the unit; '' for none."""
    labelled = _LABELLED.fullmatch(text)
    parts = [_WITH_UNIT.fullmatch(part) for part in (labelled.groups() if labelled else [text])]
    units = {part[2] for part in parts if part} - {''}
    if None in parts or len(units) > 1:
        return '', ''
    return ';'.join(part[1] for part in parts), ''.join(units)


def _two_numbers(text: str) -> Optional[Tuple[float, float]]:
    # A comma may be a decimal comma, or stand between the numbers: '12,5 -3,4' and '12.5,-3.4'.
    cells = re.split(r'\s*;\s*|\s*,\s+|\s+', text.strip())
    if len(cells) == 1 and ('.' in text or ',-' in text):  # 12,5 alone may be one number
        cells = text.split(',')
    try:
        x, y = (float(cell.replace(',', '.')) for cell in cells)
    except ValueError:
        return None
    return (x, y) if math.isfinite(x) and math.isfinite(y) else None
