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

"""Reads text tables of spreadsheets in any locale: encoding, separators, numbers."""

import csv
from pathlib import Path
import re
from typing import List, NamedTuple, Tuple

from camera_to_base.errors import InvalidValueError

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
