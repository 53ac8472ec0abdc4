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

"""Reads the tables of points for a calibration."""

from pathlib import Path
from typing import Optional, Tuple

from camera_to_base.calibration.table_text import number, read_table
from camera_to_base.errors import InvalidValueError
from camera_to_base.surface import ImageSize, MatchedPoints, PointPairs
import numpy as np

POINT_COLUMNS = ('x_cm', 'y_cm', 'u_px', 'v_px')
SIZE_COLUMNS = ('width_px', 'height_px')
PAIR_COLUMNS = ('x_cam_cm', 'y_cam_cm', 'x_base_cm', 'y_base_cm')
LARGEST = 1e6  # In cm and px: a larger number is a typing error, and its square could overflow.
PAIR_HEIGHTS = ('z_cam_cm', 'z_base_cm')


def read_points(path: str) -> Tuple[MatchedPoints, Optional[ImageSize]]:
    """
    Read the columns x_cm, y_cm, u_px and v_px, in any order, with a header.

    :returns: The points, with row numbers as in a spreadsheet (the header is row 1); and the
        picture's width and height in px, or None without the columns width_px and height_px.
    :raises InvalidValueError: Saying what is wrong in which row.
    """
    values, rows = _read(path, POINT_COLUMNS, SIZE_COLUMNS)
    matched = MatchedPoints(_columns(values, 'x_cm', 'y_cm'), _columns(values, 'u_px', 'v_px'),
                            rows)
    if not set(SIZE_COLUMNS) <= set(values):
        return matched, None
    return matched, _image_size(_columns(values, *SIZE_COLUMNS), rows)


def read_pairs(path: str) -> PointPairs:
    """
    Read the columns x_cam_cm, y_cam_cm, x_base_cm and y_base_cm, in any order, with a header.

    The columns z_cam_cm and z_base_cm are optional, and 0 by default.

    :raises InvalidValueError: Saying what is wrong in which row.
    """
    values, rows = _read(path, PAIR_COLUMNS, PAIR_HEIGHTS)
    for name in PAIR_HEIGHTS:
        values.setdefault(name, [0.0] * len(rows))
    return PointPairs(_columns(values, 'x_cam_cm', 'y_cam_cm', 'z_cam_cm'),
                      _columns(values, 'x_base_cm', 'y_base_cm', 'z_base_cm'), rows)


def refuse_other_size(table_size: Optional[ImageSize], image_size: ImageSize) -> None:
    """
    Refuse a table that was measured in a picture of another size.

    :param table_size: Width and height in px, or None if the table does not say.
    :param image_size: Width and height in px.
    :raises InvalidValueError: Naming both sizes.
    """
    if table_size is not None and tuple(table_size) != tuple(image_size):
        raise InvalidValueError(
            f'the table is from a picture of {table_size[0]} x {table_size[1]} px, not of '
            f'{image_size[0]} x {image_size[1]} px: measure the points in a picture of that size')


def _read(path, required, optional):
    """Return a list of numbers for each column, and the rows' numbers."""
    table = read_table(Path(path))
    records = table.records
    if not records:
        raise InvalidValueError(f'{path} is empty: expected a header with {", ".join(required)}')
    (_, header), *records = records
    header = [name.strip().lower() for name in header]
    missing = [name for name in required if name not in header]
    if missing:
        raise InvalidValueError(f'{path} has no column {", ".join(missing)}: its header is '
                                f'{", ".join(header)}, needed are {", ".join(required)}')
    twice = [name for name in (*required, *optional) if header.count(name) > 1]
    if twice:
        raise InvalidValueError(f'{path} has column {twice[0]} twice: remove one of them')
    if not records:
        raise InvalidValueError(f'{path} has a header but no rows: add the measured points')
    names = [name for name in (*required, *optional) if name in header]
    values = {name: [_number(table, cells, header.index(name), name, row)
                     for row, cells in records] for name in names}
    return values, tuple(row for row, _ in records)


def _number(table, record, index, name, row):
    text = record[index].strip() if index < len(record) else ''
    if not text:
        raise InvalidValueError(f'row {row}: {name} is missing')
    try:
        value = number(text, table.decimal_comma)
    except InvalidValueError as error:
        raise InvalidValueError(f'row {row}: {name}: {error}') from None
    if not np.isfinite(value):
        raise InvalidValueError(f'row {row}: {name} is {text}: expected a finite number')
    if abs(value) > LARGEST:
        raise InvalidValueError(f'row {row}: {name} is {text}: expected at most {LARGEST:g}')
    return value


def _columns(values, *names):
    return np.stack([values[name] for name in names], axis=1)


def _image_size(sizes, rows):
    other = (sizes != sizes[0]).any(axis=1)
    if other.any():
        index = int(np.argmax(other))
        raise InvalidValueError(
            f'row {rows[index]}: the picture is {sizes[index][0]:g} x {sizes[index][1]:g} px, but '
            f'{sizes[0][0]:g} x {sizes[0][1]:g} px in row {rows[0]}: use one picture size')
    width, height = sizes[0]
    if width < 1 or height < 1 or width % 1 or height % 1:
        raise InvalidValueError(f'row {rows[0]}: {width:g} x {height:g} px is no picture size')
    return int(width), int(height)
