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
"""Draws the four markers of a table to print, with cut lines, a ruler, and where to put them."""

import io
from textwrap import wrap
from typing import Any, Tuple

from camera_to_base.calibration.boards.sheet import (
    draw_ruler, GREY, largest_tile_mm, MM_PER_INCH, PAPERS, PNG_DPI)
from camera_to_base.checks import finite_number
from camera_to_base.errors import InvalidValueError
from camera_to_base.markers import CELLS, marker_cells
import numpy as np

NUMBERS = (0, 1, 2, 3)
LEAST_MM, LARGEST_MM = 10.0, 200.0
# A white margin of a cell on each side belongs to a marker; the cut line is beyond it.
_MARGIN_CELLS, _GAP_MM = 1.2, 3.0
_TOP_MM, _BOTTOM_MM = 10.0, 64.0
_CROSS_MM = 4.0
_TEXT = (
    'Cut along the dashed lines; the white margin belongs to the marker. Glue each marker flat, '
    'near a corner of the working area, where the camera sees it and nothing covers it, on the '
    'table that the robot stands on: they must not move against the robot. Turn them as you '
    'like.')
_COMMANDS = ('Learn them:  calibrate markers --camera 0 -o cell.yaml',
             'The robot touches the small crosses:  calibrate base --markers cell.yaml')


def marker_sheet_content(paper: str, marker_mm: float, file_format: str = 'pdf') -> bytes:
    """
    Draw the sheet.

    :param paper: One of PAPERS.
    :param marker_mm: Edge of a marker's black square.
    :param file_format: 'pdf', 'svg' or 'png'.
    :returns: The file's content.
    :raises InvalidValueError: If the markers do not fit on the paper; the text names the largest
        that do.
    """
    marker_mm = finite_number('marker_mm', marker_mm, LEAST_MM, LARGEST_MM)
    columns = _columns(paper, marker_mm)
    # pyplot would look for a display and keep the figure.
    from matplotlib.figure import Figure

    width, height = _size(paper, columns)
    figure = Figure((width / MM_PER_INCH, height / MM_PER_INCH))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    # In mm from the sheet's top-left corner, y downwards.
    axes.set(xlim=(0, width), ylim=(height, 0))
    tile = _tile_mm(marker_mm)
    left = (width - columns * tile) / 2
    for number in NUMBERS:
        corner = left + number % columns * tile, _TOP_MM + number // columns * tile
        _draw_marker(axes, number, corner, marker_mm)
    _draw_advice(axes, width, height)
    draw_ruler(axes, width, height)
    axes.text(width / 2, height - 4.5, f'markers 0 to 3, {marker_mm:g} mm', ha='center',
              va='center', fontsize=8, color=GREY)
    content = io.BytesIO()
    figure.savefig(content, format=file_format, dpi=PNG_DPI)
    return content.getvalue()


def _tile_mm(marker_mm: float) -> float:
    return marker_mm * (1 + 2 * _MARGIN_CELLS / CELLS) + _GAP_MM


def _columns(paper: str, marker_mm: float) -> int:
    """Return how many markers stand side by side; refuse markers that are too large."""
    largest = 0.0
    for columns in (4, 2):
        room = largest_tile_mm(
            _size(paper, columns), (columns, len(NUMBERS) // columns), _TOP_MM + _BOTTOM_MM)
        if room >= _tile_mm(marker_mm):
            return columns
        largest = max(largest, (room - _GAP_MM) / (_tile_mm(1.0) - _GAP_MM))
    raise InvalidValueError(
        f'four markers of {marker_mm:g} mm do not fit on {paper}: markers of {int(largest)} mm do')


def _size(paper: str, columns: int) -> Tuple[float, float]:
    return PAPERS[paper] if columns == 4 else PAPERS[paper][::-1]


def _draw_marker(
    axes: Any, number: int, corner: Tuple[float, float], marker_mm: float
) -> None:
    from matplotlib.patches import Rectangle

    tile, cell = _tile_mm(marker_mm), marker_mm / CELLS
    left, top = (place + (tile - marker_mm) / 2 for place in corner)
    edge = tile - _GAP_MM
    axes.add_patch(Rectangle(
        (corner[0] + _GAP_MM / 2, corner[1] + _GAP_MM / 2), edge, edge, fill=False,
        edgecolor=GREY, linewidth=0.4, linestyle=(0, (6, 4))))
    for row, column in np.argwhere(marker_cells(number)):
        # A little larger than a cell: viewers draw a bright line between neighbours.
        axes.add_patch(Rectangle(
            (left + column * cell, top + row * cell), 1.01 * cell, 1.01 * cell,
            facecolor='black', linewidth=0))
    # What is printed a little too large is covered by the margin.
    _cover_beyond(axes, left, top, marker_mm, cell)
    middle, half = (left + marker_mm / 2, top + marker_mm / 2), _CROSS_MM / 2
    for ends in (((-half, half), (0, 0)), ((0, 0), (-half, half))):
        axes.plot([middle[0] + end for end in ends[0]], [middle[1] + end for end in ends[1]],
                  color='0.5', linewidth=0.8)
    axes.text(left, top - 0.4 * cell, f'{number}', fontsize=5, color=GREY, va='center')


def _cover_beyond(axes: Any, left: float, top: float, marker_mm: float, cell: float) -> None:
    from matplotlib.patches import Rectangle

    for place, size in (((left + marker_mm, top), (0.05 * cell, marker_mm + 0.05 * cell)),
                        ((left, top + marker_mm), (marker_mm + 0.05 * cell, 0.05 * cell))):
        axes.add_patch(Rectangle(place, *size, facecolor='white', linewidth=0))


def _draw_advice(axes: Any, width: float, height: float) -> None:
    """Draw a table with its markers, and say what to do."""
    from matplotlib.patches import Rectangle

    left, top = 12.0, height - 58.0
    axes.add_patch(Rectangle((left, top), 40, 28, fill=False, edgecolor=GREY, linewidth=0.8))
    for number, (x, y) in zip(NUMBERS, ((3, 3), (33, 3), (33, 21), (3, 21))):
        axes.add_patch(Rectangle((left + x, top + y), 4, 4, facecolor='black', linewidth=0))
        axes.text(left + x + (6 if x < 20 else -2), top + y + 2, str(number), fontsize=6,
                  color=GREY, va='center', ha='center')
    axes.text(left + 20, top + 14, 'working area', fontsize=6, color=GREY, ha='center',
              va='center')
    # Letters of this size are 1.4 mm wide.
    lines = [*wrap(_TEXT, int((width - left - 52) / 1.4)), *_COMMANDS]
    axes.text(left + 46, top + 14, '\n'.join(lines), fontsize=7.5, va='center', linespacing=1.5)
