# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Draws sheets to print: a chessboard and the four markers of a table, each with a ruler."""

import io
from textwrap import wrap
from typing import Any, Tuple

from camera_to_base.calibration.boards.charuco import MARKER_SHARE, marker_squares
from camera_to_base.checks import finite_number, whole_number
from camera_to_base.errors import InvalidValueError
from camera_to_base.markers import CELLS, marker_cells
import numpy as np

# Width and height as the sheet lies, in mm.
PAPERS = {'A4': (297.0, 210.0), 'A3': (420.0, 297.0), 'Letter': (279.4, 215.9)}
MM_PER_INCH = 25.4
PNG_DPI = 300
# Printers leave an edge white; the texts and the ruler take the rest.
_SIDE_MM, _TOP_MM, _BOTTOM_MM = 6.0, 12.0, 20.0
_RULER_MM = 100
GREY = '0.35'

NUMBERS = (0, 1, 2, 3)
LEAST_MM, LARGEST_MM = 10.0, 200.0
# A white margin of a cell on each side belongs to a marker; the cut line is beyond it.
_MARGIN_CELLS, _GAP_MM = 1.2, 3.0
_CUT_TOP_MM, _CUT_BOTTOM_MM = 10.0, 64.0
_CROSS_MM = 4.0
_TEXT = (
    'Cut along the dashed lines; the white margin belongs to the marker. Glue each marker flat, '
    'near a corner of the working area, where the camera sees it and nothing covers it, on the '
    'table that the robot stands on: they must not move against the robot. Turn them as you '
    'like.')
_COMMANDS = ('Learn them:  calibrate markers --camera 0 -o cell.yaml',
             'The robot touches the small crosses:  calibrate base --markers cell.yaml')


def sheet_content(
    paper: str, columns: int, rows: int, square_mm: float, file_format: str = 'pdf', *,
    with_markers: bool = False,
) -> bytes:
    """
    Draw a sheet.

    :param paper: One of PAPERS.
    :param columns: Inner corners along a row.
    :param rows: Inner corners along a column.
    :param square_mm: A square's edge.
    :param file_format: 'pdf', 'svg' or 'png'.
    :param with_markers: Whether to draw a ChArUco board.
    :returns: The file's content.
    :raises InvalidValueError: If the board does not fit on the paper; the text names the largest
        square that does.
    """
    columns = whole_number('the count of inner corners along a row', columns, 3, 1000)
    rows = whole_number('the count of inner corners along a column', rows, 3, 1000)
    square_mm = finite_number('square_mm', square_mm, 1, 1000)
    _refuse_too_large(paper, columns, rows, square_mm)
    # pyplot would look for a display and keep the figure.
    from matplotlib.figure import Figure

    width, height = _board_sheet_size(paper, columns, rows)
    figure = Figure((width / MM_PER_INCH, height / MM_PER_INCH))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    # In mm from the sheet's top-left corner, y downwards.
    axes.set(xlim=(0, width), ylim=(height, 0))
    left = (width - (columns + 1) * square_mm) / 2
    _draw_squares(axes, (left, _TOP_MM), columns, rows, square_mm)
    if with_markers:
        _draw_markers(axes, (left, _TOP_MM), columns, rows, square_mm)
    _draw_axes(axes, (left, _TOP_MM), columns, rows, square_mm, with_markers)
    draw_ruler(axes, width, height)
    charuco = '--charuco ' if with_markers else ''
    axes.text(width / 2, height - 4.5, f'{columns} x {rows} inner corners, {square_mm:g} mm:   '
              f'calibrate board --camera 0 --corners {columns}x{rows} --square-mm {square_mm:g} '
              f'{charuco}-o cell.yaml', ha='center', va='center', fontsize=8, color=GREY)
    content = io.BytesIO()
    figure.savefig(content, format=file_format, dpi=PNG_DPI)
    return content.getvalue()


def largest_tile_mm(
    size_mm: Tuple[float, float], counts: Tuple[int, int], above_and_below_mm: float
) -> float:
    """
    Return how large the equal squares on a sheet can be.

    :param size_mm: The sheet's width and height.
    :param counts: Of squares along a row, and along a column.
    :param above_and_below_mm: What the texts and the ruler take of the height.
    """
    (width, height), (columns, rows) = size_mm, counts
    return min((width - 2 * _SIDE_MM) / columns, (height - above_and_below_mm) / rows)


def has_one_origin(columns: int, rows: int) -> bool:
    """Return whether a board has one end with dark corner squares, and so one first corner."""
    return (columns + rows) % 2 == 1


def _board_sheet_size(paper: str, columns: int, rows: int) -> Tuple[float, float]:
    """Return the sheet's width and height in mm: upright for a board that is higher than wide."""
    return PAPERS[paper] if columns >= rows else PAPERS[paper][::-1]


def _refuse_too_large(paper: str, columns: int, rows: int, square_mm: float) -> None:
    largest = largest_tile_mm(
        _board_sheet_size(paper, columns, rows), (columns + 1, rows + 1), _TOP_MM + _BOTTOM_MM)
    if square_mm > largest:
        cure = f'squares of {int(largest)} mm do' if largest >= 1 else 'choose fewer'
        raise InvalidValueError(
            f'a board of {columns + 1} x {rows + 1} squares of {square_mm:g} mm does not fit on '
            f'{paper}: {cure}')


def _draw_squares(
    axes: Any, corner: Tuple[float, float], columns: int, rows: int, square_mm: float
) -> None:
    from matplotlib.patches import Rectangle

    for row in range(rows + 1):
        for column in range(row % 2, columns + 1, 2):
            place = corner[0] + column * square_mm, corner[1] + row * square_mm
            axes.add_patch(Rectangle(place, square_mm, square_mm, facecolor='black', linewidth=0))


def _draw_markers(
    axes: Any, corner: Tuple[float, float], columns: int, rows: int, square_mm: float
) -> None:
    from matplotlib.patches import Rectangle

    cell = square_mm * MARKER_SHARE / CELLS
    for number, square in marker_squares(columns, rows).items():
        left, top = (place + square_mm * (index + (1 - MARKER_SHARE) / 2)
                     for place, index in zip(corner, square))
        for row, column in np.argwhere(marker_cells(number)):
            # A little larger than a cell: viewers draw a bright line between neighbours.
            axes.add_patch(Rectangle(
                (left + column * cell, top + row * cell), 1.01 * cell, 1.01 * cell,
                facecolor='black', linewidth=0))


def _draw_axes(
    axes: Any, corner: Tuple[float, float], columns: int, rows: int, square_mm: float,
    with_markers: bool,
) -> None:
    """Draw x and y beside the board, from the first inner corner's place on."""
    (left, top), length = corner, 1.5 * square_mm
    if not with_markers and not has_one_origin(columns, rows):
        axes.text(left, top - 5, 'origin: the corner that the picture shows nearest to its '
                  'top-left pixel', fontsize=8, color=GREY, va='center')
        return
    arrow = {'arrowstyle': '-|>', 'color': GREY}
    start = left + square_mm, top + square_mm
    axes.annotate('', (start[0] + length, top - 3), (start[0], top - 3), arrowprops=arrow)
    axes.annotate('', (left - 3, start[1] + length), (left - 3, start[1]), arrowprops=arrow)
    axes.text(start[0] + length + 2, top - 3, 'x   (the arrows start at the inner corner that is '
              "the camera frame's origin, however the sheet lies)", fontsize=8, color=GREY,
              va='center')
    axes.text(left - 3, start[1] + length + 3, 'y', fontsize=8, color=GREY, ha='center')


def draw_ruler(axes: Any, width: float, height: float) -> None:
    """Draw a ruler at the bottom of a sheet, and what it is for; lengths in mm."""
    left, line = (width - _RULER_MM) / 2 - 47, height - 10
    axes.plot([left, left + _RULER_MM], [line, line], color='black', linewidth=0.5)
    for mark in range(_RULER_MM + 1):
        length = 4 if mark % 10 == 0 else 2.5 if mark % 5 == 0 else 1.5
        axes.plot([left + mark] * 2, [line, line - length], color='black', linewidth=0.3)
    axes.text(left + _RULER_MM + 4, line - 1.5, f'0 to {_RULER_MM} mm: measure it after printing '
              "at 100 % (not 'fit to page')", fontsize=8, va='center')


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

    width, height = _cut_size(paper, columns)
    figure = Figure((width / MM_PER_INCH, height / MM_PER_INCH))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    # In mm from the sheet's top-left corner, y downwards.
    axes.set(xlim=(0, width), ylim=(height, 0))
    tile = _tile_mm(marker_mm)
    left = (width - columns * tile) / 2
    for number in NUMBERS:
        corner = left + number % columns * tile, _CUT_TOP_MM + number // columns * tile
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
            _cut_size(paper, columns), (columns, len(NUMBERS) // columns),
            _CUT_TOP_MM + _CUT_BOTTOM_MM)
        if room >= _tile_mm(marker_mm):
            return columns
        largest = max(largest, (room - _GAP_MM) / (_tile_mm(1.0) - _GAP_MM))
    raise InvalidValueError(
        f'four markers of {marker_mm:g} mm do not fit on {paper}: markers of {int(largest)} mm do')


def _cut_size(paper: str, columns: int) -> Tuple[float, float]:
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
