# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The result of a calibration: its values and report, drawn so that a user can judge by eye."""

from dataclasses import asdict, dataclass
from datetime import datetime
from typing import Any, List, Mapping, NamedTuple, Optional, Sequence

from camera_to_base.calibration.figures import ErrorFigures
from camera_to_base.calibration.report import ErrorRows, map_picture, RAISED_CM, Report
from camera_to_base.checks import ImageSize
from camera_to_base.errors import CalibrationError
from camera_to_base.surface import (
    Hull, MatchedPoints, sees_y_clockwise, Surface, surface_extent, top_view)
import cv2
import numpy as np

# Colours as blue, green, red.
GRID = (255, 200, 0)
HULL = (0, 220, 255)
ARROW = (60, 60, 255)
AXIS_X = (0, 0, 255)
AXIS_Y = (0, 200, 0)
PAPER = (40, 40, 40)
INK = (240, 240, 240)
EMPTY = (90, 90, 90)

PANEL_HEIGHT = 640
CAPTION_HEIGHT = 34
# The same scale for all pictures, so that a bad fit looks bad: 0.1 px is a dot, 1 px a long arrow.
ENLARGEMENT = 20
PICTURE_TITLE = ('the picture: the blue grid must lie on the surface, errors (red arrows) be '
                 f'small: drawn {ENLARGEMENT} x')
TOP_VIEW_TITLE = 'seen from above: squares must look square; bright: where the figures hold'
MAP_TITLE = '95 % of the positions are expected within so many mm (camera frame)'
RAISED_TITLE = f'the same of objects {RAISED_CM:g} cm high'
CURVE_POINTS = 60
# OpenCV draws with a resolution of 1 / 2^SHIFT px.
SHIFT = 4

# The fit is repeated without each point: a thousand points take a minute, ten thousand hours.
_MOST_POINTS = 1000


class Panel(NamedTuple):
    """
    A part of the report picture.

    :param title: What it shows.
    :param picture: Shape (PANEL_HEIGHT, w, 3), uint8, BGR.
    """

    title: str
    picture: np.ndarray


def report_panels(surface: Surface, matched: MatchedPoints, image_size: ImageSize, *,
                  image: Optional[np.ndarray] = None, lattice: Optional[np.ndarray] = None,
                  error_map: ErrorRows = (), raised: ErrorRows = ()) -> List[Panel]:
    """
    Draw the picture with the fit over it, the surface from above, and the expected errors.

    :param surface: Anything with `locate` and `pixels`.
    :param matched: The points of the fit or of the check.
    :param image_size: Width and height, in px.
    :param image: Shape (h, w, 3), uint8, BGR; None draws on an empty picture.
    :param lattice: Shape (rows, columns, 2), in cm: the points that the grid runs through; None
        draws a grid along x and y with a round step.
    :param error_map: Expected errors over the picture, see :class:`ErrorMap`; empty for none.
    :param raised: Those of objects with a height; empty for none.
    """
    if image is None:
        image = np.full((image_size[1], image_size[0], 3), EMPTY, np.uint8)
    step_cm = round_step(np.ptp(matched.points, axis=0).max() / 8)
    extent = surface_extent(matched.points, step_cm)
    lines_cm = _grid_lines(extent, step_cm) if lattice is None else _lattice_lines(lattice)
    seen, scale = _scaled(image, PANEL_HEIGHT / image.shape[0])
    maps = [Panel(title, map_picture(seen, errors)) for title, errors in (
        (MAP_TITLE, error_map), (RAISED_TITLE, raised)) if len(errors)]
    _draw_fit(seen, lambda points: (surface.pixels(points) + 0.5) * scale - 0.5,
              (matched.pixels + 0.5) * scale - 0.5, matched.points, lines_cm)
    above, project = top_view(image, surface, matched, extent, PANEL_HEIGHT)
    _draw_fit(above, project, project(surface.locate(matched.pixels)), matched.points, lines_cm)
    return [Panel(PICTURE_TITLE, seen), Panel(TOP_VIEW_TITLE, above), *maps]


def report_picture(panels: Sequence[Panel], lines: Sequence[str] = ()) -> np.ndarray:
    """
    Put the panels side by side.

    :param lines: Text below, the figures first.
    :returns: Shape (h, w, 3), uint8.
    """
    gap = np.full((PANEL_HEIGHT + CAPTION_HEIGHT, 8, 3), 255, np.uint8)
    shown = [part for panel in panels for part in (gap, _titled(panel.picture, panel.title))][1:]
    picture = np.hstack(shown)
    return np.vstack([picture, *(_caption(picture.shape[1], line, 0.62) for line in lines)])


def round_step(length: float) -> float:
    """
    Round a length up to 1, 2 or 5 times a power of ten.

    :param length: Positive.
    """
    power = 10.0 ** np.floor(np.log10(length))
    return float(power * next(digit for digit in (1, 2, 5, 10) if digit * power >= length))


def _draw_fit(canvas, project, shown, points, lines_cm):
    """Draw hull, grid, axes and arrows; `project` takes points in cm to px of the canvas."""
    trusted = Hull(shown).corners
    _dim_outside(canvas, trusted)
    for line in lines_cm:
        _polyline(canvas, project(line), GRID, 1)
    _polyline(canvas, np.vstack([trusted, trusted[:1]]), HULL, 2)
    expected = project(points)
    for start, end in zip(expected, expected + ENLARGEMENT * (shown - expected)):
        _arrow(canvas, start, end)
    _draw_axes(canvas, project, 0.3 * np.ptp(points, axis=0).min())


def _dim_outside(canvas, trusted):
    inside = np.zeros(canvas.shape[:2], np.uint8)
    cv2.fillConvexPoly(inside, trusted.round().astype(np.int32), 1)
    canvas[inside == 0] //= 2


def _draw_axes(canvas, project, length):
    for end, colour, name in (((length, 0), AXIS_X, 'x'), ((0, length), AXIS_Y, 'y')):
        origin, tip = project(np.array([(0.0, 0.0), end]))
        if _drawable(origin, tip):
            cv2.arrowedLine(canvas, _fixed(origin), _fixed(tip), colour, 3, cv2.LINE_AA, SHIFT,
                            0.12)
            _label(canvas, name, tip + 16 * (tip - origin) / np.linalg.norm(tip - origin), colour)
            cv2.circle(canvas, _fixed(origin), 6 << SHIFT, INK, 2, cv2.LINE_AA, SHIFT)


def _grid_lines(extent, step):
    """Return the grid's lines, each of shape (n, 2), in cm."""
    (x_low, y_low), (x_high, y_high) = extent
    along_x = np.linspace(x_low, x_high, CURVE_POINTS)
    along_y = np.linspace(y_low, y_high, CURVE_POINTS)
    rows = [np.stack([along_x, np.full(CURVE_POINTS, y)], axis=1)
            for y in step * np.arange(np.ceil(y_low / step - 1e-6), y_high / step + 1e-6)]
    columns = [np.stack([np.full(CURVE_POINTS, x), along_y], axis=1)
               for x in step * np.arange(np.ceil(x_low / step - 1e-6), x_high / step + 1e-6)]
    return rows + columns


def _lattice_lines(lattice):
    """Return the lines through a lattice, a step longer at each end, each of shape (n, 2)."""
    return [np.linspace(2 * line[0] - line[1], 2 * line[-1] - line[-2], CURVE_POINTS)
            for lines in (lattice, lattice.swapaxes(0, 1)) for line in lines]


def _polyline(canvas, pixels, colour, width):
    for start, end in zip(pixels[:-1], pixels[1:]):
        if _drawable(start, end):
            cv2.line(canvas, _fixed(start), _fixed(end), colour, width, cv2.LINE_AA, SHIFT)


def _arrow(canvas, start, end):
    if _drawable(start, end):
        cv2.arrowedLine(canvas, _fixed(start), _fixed(end), ARROW, 2, cv2.LINE_AA, SHIFT, 0.3)
        cv2.circle(canvas, _fixed(start), 2 << SHIFT, ARROW, -1, cv2.LINE_AA, SHIFT)


def _drawable(*pixels):
    """Return whether OpenCV can draw there: it needs finite numbers within 32 bits."""
    return bool((np.abs(pixels) < 1e5).all())


def _fixed(pixel):
    return tuple(int(round(value * (1 << SHIFT))) for value in pixel)


def _scaled(image, factor):
    method = cv2.INTER_AREA if factor < 1 else cv2.INTER_LINEAR
    return cv2.resize(image, None, fx=factor, fy=factor, interpolation=method), factor


def _titled(panel, title):
    return np.vstack([_caption(panel.shape[1], title, 0.5), panel])


def _caption(width, text, size):
    strip = np.full((CAPTION_HEIGHT, width, 3), PAPER, np.uint8)
    text_width = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, size, 1)[0][0]
    size *= min(1.0, (width - 16) / text_width) if text else 1.0
    cv2.putText(strip, text, (8, 23), cv2.FONT_HERSHEY_SIMPLEX, size, INK, 1, cv2.LINE_AA)
    return strip


def _label(canvas, text, pixel, colour):
    cv2.circle(canvas, _fixed(pixel), 11 << SHIFT, INK, -1, cv2.LINE_AA, SHIFT)
    place = tuple(int(round(value)) for value in pixel + (-6, 5))
    cv2.putText(canvas, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.6, colour, 2, cv2.LINE_AA)


@dataclass(frozen=True)
class Calibration:
    """
    The result of a calibration.

    :param report: The report that `calibrate --json` prints.
    :param values: The nodes' parameters, by full name.
    :param picture: The report picture, shape (h, w, 3), uint8; None if there is none.
    :param panels: Its parts.
    """

    report: Report
    values: Mapping[str, Any]
    picture: Optional[np.ndarray] = None
    panels: Sequence[Panel] = ()


def refuse_too_many(count: int) -> None:
    """
    Refuse more points than can be left out one after the other.

    :raises CalibrationError: If there are more than a thousand.
    """
    if count > _MOST_POINTS:
        raise CalibrationError(
            f'{count} points are too many to leave out each of them once: give {_MOST_POINTS} at '
            'most, spread over the working area')


def origin_fields(model: str, source: str) -> Report:
    """Return a report's fields that say what was fitted to what, and when."""
    return {'model': model, 'source': source,
            'date': datetime.now().astimezone().isoformat(timespec='seconds')}


def figure_fields(figures: ErrorFigures, points_are: str) -> Report:
    """Return a report's fields of the errors."""
    return {**asdict(figures), 'points_are': points_are}


def axis_fields(surface: Surface, matched: MatchedPoints) -> Report:
    """Return a report's fields that say where the picture shows the camera frame, if it does."""
    length = float(np.ptp(matched.points, axis=0).max())
    pixels = surface.pixels([[0, 0], [length, 0], [0, length]])
    if not np.isfinite(pixels).all():
        return {}
    origin, x_end, y_end = pixels.round(1).tolist()
    clockwise = sees_y_clockwise(matched)
    return {'origin_px': origin, 'x_towards_px': x_end, 'y_towards_px': y_end,
            'z_points': 'into the surface' if clockwise else 'towards the camera'}
