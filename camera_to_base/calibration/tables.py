# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Reads the tables of points for a calibration, and the intrinsics of a lens."""

import csv
from pathlib import Path
import re
from typing import Any, List, Mapping, NamedTuple, Optional, Tuple

from camera_to_base.checks import finite_numbers, ImageSize
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import load_yaml
from camera_to_base.surface import LensModel, MatchedPoints, PointPairs
import numpy as np

Record = Tuple[int, List[str]]

# With a byte order mark; Excel's "Unicode text" is UTF-16.
_MARKED = ((b'\xef\xbb\xbf', 'utf-8-sig'), (b'\xff\xfe', 'utf-16'), (b'\xfe\xff', 'utf-16'))
_WORKBOOK_START = b'PK\x03\x04'
# Spaces that group digits in French locales: no-break, thin and narrow no-break.
_SPACES = str.maketrans(dict.fromkeys('\u00a0\u2009\u202f ', ''))
_NUMBER = re.compile(r'[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?')
_WITH_COMMA = re.compile(r'[+-]?\d*,\d+([eE][+-]?\d+)?')
# '1,234' can mean one and a fraction, or more than a thousand.
_TWO_NUMBERS = re.compile(r'[+-]?[1-9]\d{0,2},\d{3}')
_GROUPED = re.compile(r'[+-]?\d{1,3}([.,])\d{3}(\1\d{3})*(?!\1)[.,]\d+')

POINT_COLUMNS = ('x_cm', 'y_cm', 'u_px', 'v_px')
SIZE_COLUMNS = ('width_px', 'height_px')
PAIR_COLUMNS = ('x_cam_cm', 'y_cam_cm', 'x_base_cm', 'y_base_cm')
LARGEST = 1e6  # In cm and px: a larger number is a typing error, and its square could overflow.
PAIR_HEIGHTS = ('z_cam_cm', 'z_base_cm')


class PointTable(NamedTuple):
    """
    A table's cells.

    :param records: The records that are not empty, each with its row number in a spreadsheet.
    :param decimal_comma: Whether numbers have a decimal comma, so that points are not decimal.
    """

    records: List[Record]
    decimal_comma: bool


def read_table(path: Path) -> PointTable:
    """
    Read a table's cells.

    Columns are separated by tabs, semicolons or commas, as in the header. A first line `sep=;` is
    for Excel, which does not count it as a row.

    :raises InvalidValueError: If there is no such file, or it is no table of text.
    """
    try:
        lines = _text(path.read_bytes()).splitlines()
    except (OSError, ValueError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise InvalidValueError(f'cannot read the table {path}: {reason}') from error
    if lines and re.fullmatch(r'"?sep=.?"?', lines[0].strip(), re.IGNORECASE):
        del lines[0]
    header = next(filter(str.strip, lines), '')
    delimiter = next((mark for mark in '\t;' if mark in header), ',')
    try:
        rows = list(enumerate(csv.reader(lines, delimiter=delimiter), start=1))
    except csv.Error as error:
        raise InvalidValueError(f'cannot read the table {path}: {error}') from error
    records = [(row, cells) for row, cells in rows if any(cell.strip() for cell in cells)]
    _refuse_long_rows(records, delimiter)
    return PointTable(records, _has_decimal_comma(records, delimiter))


def number(text: str, decimal_comma: bool) -> float:
    """
    Read a number with a decimal point or comma, and groups of digits if they are unambiguous.

    :param decimal_comma: Whether the table has decimal commas.
    :raises InvalidValueError: If it is no number, or ambiguous; the message says which.
    """
    plain = text.translate(_SPACES).replace('\u2212', '-')  # the minus sign of typesetting
    if _GROUPED.fullmatch(plain):
        group = next(mark for mark in plain if mark in '.,')
        plain = plain.replace(group, '')
    elif decimal_comma and '.' in plain:
        raise InvalidValueError(
            f'{text!r} has a point in a table with decimal commas: write it without the point')
    elif _TWO_NUMBERS.fullmatch(plain) and not decimal_comma:
        raise InvalidValueError(f'{text!r} can be two numbers: write it without the comma')
    plain = plain.replace(',', '.')
    if not _NUMBER.fullmatch(plain) and plain.lower().lstrip('+-') not in ('nan', 'inf'):
        raise InvalidValueError(f'not a number: {text!r}')
    return float(plain)


def _text(content: bytes) -> str:
    if content.startswith(_WORKBOOK_START):
        raise InvalidValueError("it is a spreadsheet's workbook: save it as CSV")
    for mark, encoding in _MARKED:
        if content.startswith(mark):
            return content.decode(encoding)
    if b'\0' in content[:4]:
        return content.decode('utf-16-le' if content[1:2] == b'\0' else 'utf-16-be')
    try:
        return content.decode('utf-8')
    except UnicodeDecodeError:
        # Windows in Western Europe; the few bytes without a character are replaced.
        return content.decode('cp1252', errors='replace')


def _has_decimal_comma(records: List[Record], delimiter: str) -> bool:
    cells = [cell.strip().translate(_SPACES) for _, record in records for cell in record]
    return any(_WITH_COMMA.fullmatch(cell) for cell in cells
               if delimiter == ';' or not _TWO_NUMBERS.fullmatch(cell))


def _refuse_long_rows(records: List[Record], delimiter: str) -> None:
    """Refuse rows with more cells than the header: 2,5 without quotes is two cells."""
    for row, cells in records[1:]:
        width = len(records[0][1])
        if any(cell.strip() for cell in cells[width:]):
            raise InvalidValueError(
                f'row {row} has {len(cells)} cells, but the header has {width}: is {delimiter!r} '
                'both the separator and the decimal mark? Save the table with semicolons')


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


def read_camera_info(path: str) -> LensModel:
    """
    Read a camera_info file.

    :raises InvalidValueError: If there is no such file, or its content is invalid; the message
        names the file, the key and the value.
    """
    _, content = load_yaml(path, 'camera_info file')
    try:
        return _lens(content)
    except InvalidValueError as error:
        raise InvalidValueError(f"'{path}' is no camera_info file: {error}") from error


def lens_of_camera_info(info: Any, is_rectified: bool = False) -> Optional[LensModel]:
    """
    Make a lens of what a driver publishes.

    :param info: A sensor_msgs/CameraInfo.
    :param is_rectified: Whether the pictures have no distortion any more: then it is that of P.
    :returns: None where the driver does not know it: K is 0.
    :raises InvalidValueError: If it describes no lens, or a part of the sensor's pixels.
    """
    if not info.k[0]:
        return None
    if max(info.binning_x, info.binning_y) > 1 or info.roi.width or info.roi.height:
        raise InvalidValueError(
            'camera_info is of all pixels of the sensor, and the pictures show a part of them '
            '(binning or roi): let the driver publish whole pictures')
    size = [info.width, info.height]
    if is_rectified:
        return LensModel.of_matrix(size, np.reshape(info.p, (3, 4))[:, :3])
    return LensModel.of_matrix(
        size, np.reshape(info.k, (3, 3)), list(info.d), info.distortion_model or 'plumb_bob')


def _lens(content: Any) -> LensModel:
    size = [_value(content, 'image_width'), _value(content, 'image_height')]
    # Older files have no such key; ROS reads them the same way.
    model = content.get('distortion_model', 'plumb_bob')
    if not isinstance(model, str):
        raise InvalidValueError(f'distortion_model must be a name, got {model!r}')
    matrix = finite_numbers('camera_matrix.data', _data(content, 'camera_matrix'), 9)
    coefficients = finite_numbers(
        'distortion_coefficients', _data(content, 'distortion_coefficients'), -1)
    return LensModel.of_matrix(size, matrix.reshape(3, 3), coefficients, model)


def _data(content: Any, key: str) -> Any:
    return _value(_value(content, key), 'data', f'{key}.data')


def _value(content: Any, key: str, name: str = '') -> Any:
    if not isinstance(content, Mapping) or key not in content:
        raise InvalidValueError(f'it has no {name or key}')
    return content[key]
