# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Computes the transform into the base frame from objects that the robot touches, or a table."""

import csv
import io
import math
import re
from typing import Any, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.calibration.checks import (
    check_pairs, check_with_surface, check_without_surface, transform_error)
from camera_to_base.calibration.figures import error_figures, warnings
from camera_to_base.calibration.report import ErrorMap
from camera_to_base.calibration.result import (
    Calibration, figure_fields, origin_fields, refuse_too_many)
from camera_to_base.calibration.rigid_fit import fit_rigid
from camera_to_base.calibration.tables import LARGEST, PAIR_COLUMNS, read_pairs
from camera_to_base.checks import ImageSize
from camera_to_base.errors import CalibrationError, HorizonError, InvalidValueError
from camera_to_base.surface import Hull, PointPairs, Surface
from camera_to_base.uncertainty import triangle_of
import numpy as np

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

# Frames for a position, and those of them that may show nothing: a reflection, a passing shadow.
FRAMES = 20
MOST_WITHOUT = 5
# A coin at rest is located to 0.01 to 0.1 mm from frame to frame; a hand moves it by more.
LARGEST_SPREAD_CM = 0.1

_Points = Sequence[Tuple[float, float]]

# Of the distance that the camera sees between two places; a robot that was touched right is off
# by a small part of it.
_LEAST_SHARE = 0.25
# The last column says with which surface the camera points were measured.
_COLUMNS = (*PAIR_COLUMNS, 'surface')


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


class Place(NamedTuple):
    """
    Where an object rests.

    :param x: Mean over the frames, in cm, in the camera frame.
    :param y: The same.
    :param spread_cm: Root of the mean squared distance from the mean.
    :param frame_count: Number of frames.
    """

    x: float
    y: float
    spread_cm: float
    frame_count: int


def measured_place(frames: Sequence[_Points]) -> Place:
    """
    Take the mean of an object's positions.

    :param frames: For each frame the positions of all objects on it, x and y, in cm.
    :raises CalibrationError: If there is no object, there are several, or it moves.
    """
    with_object = [points for points in frames if points]
    if len(frames) - len(with_object) > MOST_WITHOUT or not with_object:
        raise CalibrationError(
            f'{len(frames) - len(with_object)} of {len(frames)} frames show no object: put one '
            'into the picture, and take your hand and the robot out of it')
    most = max(len(points) for points in with_object)
    if most > 1:
        raise CalibrationError(
            f'{most} objects are in the picture: leave only one, and take your hand and the robot '
            'out of it')
    points = np.array([points[0] for points in with_object])
    mean = points.mean(axis=0)
    spread = float(np.sqrt(np.mean(np.sum((points - mean) ** 2, axis=1))))
    if spread > LARGEST_SPREAD_CM:
        raise CalibrationError(
            f'the object has moved: its positions spread by {10 * spread:.1f} mm, allowed are '
            f'{10 * LARGEST_SPREAD_CM:g} mm: leave it alone while it is measured')
    return Place(float(mean[0]), float(mean[1]), spread, len(points))


def calibrate_base(
    pairs: PointPairs, *, source: str, surface_values: Optional[Mapping[str, Any]] = None,
    base_z: str = 'up', points_are: str = 'row',
) -> Calibration:
    """
    Fit the transform from the camera frame to the base frame.

    :param source: The pairs' origin, for the report.
    :param surface_values: The parameters of the surface that the camera points were measured
        with, by full name; None if they are not known.
    :param base_z: Direction of the base frame's z at the table: 'up', away from it, or 'down'.
    :param points_are: The report's word for a pair.
    :raises CameraToBaseError: If the pairs do not determine the transform, no transform fits them,
        or they do not fit the surface.
    """
    refuse_too_many(len(pairs))
    fit = fit_rigid(pairs)
    doubts = check_pairs(pairs, fit)
    if surface_values is None:
        doubts += check_without_surface(pairs)
    else:
        doubts += check_with_surface(pairs, fit, surface_values, base_z)
    left_out = fit.left_out_residuals
    figures = error_figures(
        np.linalg.norm(fit.residuals, axis=1), pairs.rows,
        None if left_out is None else np.linalg.norm(left_out, axis=1))
    found = {'rotation_deg': list(fit.rotation_deg),
             'displacement_cm': list(fit.displacement_cm)}
    values = {**found, 'base_covariance': triangle_of(transform_error(pairs, fit))}
    report = {**origin_fields('rigid', source), **found, **figure_fields(figures, points_are),
              'warnings': [*warnings(figures), *doubts]}
    if surface_values is not None:
        report.update(ErrorMap({**surface_values, **values}).fields)
    return Calibration(report, values)


class TouchedPair(NamedTuple):
    """
    A place of the object in both frames.

    :param suggestion: Where it was to be put.
    :param camera_point: x and y, in cm, in the camera frame.
    :param base_point: x and y, in cm, in the base frame.
    """

    suggestion: Suggestion
    camera_point: Tuple[float, float]
    base_point: Tuple[float, float]


def point_pairs(pairs: Sequence[Any], rows: Sequence[int] = ()) -> PointPairs:
    """
    Return the points of pairs, which lie on the surface and on the table of the base frame.

    :param pairs: With a `camera_point` and a `base_point` each.
    :param rows: What messages call the pairs; 1 to n by default.
    """
    camera = [(*pair.camera_point, 0.0) for pair in pairs]
    base = [(*pair.base_point, 0.0) for pair in pairs]
    return PointPairs(np.array(camera).reshape(-1, 3), np.array(base).reshape(-1, 3), tuple(rows))


def same_touch(
    pairs: Sequence[TouchedPair], camera_point: Tuple[float, float],
    base_point: Tuple[float, float],
) -> Optional[str]:
    """
    Tell why a base point cannot be that of a new place, a sentence; None if it can.

    :param pairs: Those of the other places.
    :param camera_point: Where the camera sees the object, x and y, in cm.
    :param base_point: Where the robot is said to touch it, x and y, in cm.
    """
    for pair in pairs:
        seen_cm = math.dist(pair.camera_point, camera_point)
        typed_cm = math.dist(pair.base_point, base_point)
        if typed_cm < _LEAST_SHARE * seen_cm:
            how = 'this' if typed_cm == 0 else f'within {10 * typed_cm:.1f} mm of this'
            return ('another place has {} position, ({:.2f}, {:.2f}) cm, but the camera sees the '
                    'two places {:.1f} cm apart: touch this one, and give its position'.format(
                        how, *pair.base_point, seen_cm))
    return None


def pairs_text(pairs: Sequence[TouchedPair], surface: str) -> str:
    """
    Write pairs as a table that `calibrate base` reads, too.

    :param surface: The record of the surface that the camera points were measured with.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator='\n')
    writer.writerow(_COLUMNS)
    writer.writerows([*map(repr, (*pair.camera_point, *pair.base_point)), surface]
                     for pair in pairs)
    return text.getvalue()


def read_kept_pairs(
    path: str, surface: str, suggestions: Iterator[Suggestion]
) -> List[TouchedPair]:
    """
    Read the pairs that :func:`pairs_text` has written.

    :param surface: The record of the surface that is used now.
    :param suggestions: Those that the objects were laid by, from the first on.
    :returns: The pairs; [] if they were measured with another surface.
    :raises InvalidValueError: If the file is none of these.
    """
    try:
        with open(path, encoding='utf-8', newline='') as file:
            header, *rows = csv.reader(file)
    except (OSError, ValueError, csv.Error):
        header, rows = [], []
    if tuple(header) != _COLUMNS:
        raise InvalidValueError(
            f"'{path}' is there, which is no table of pairs of an interrupted calibration, and "
            'would be overwritten: give it another name')
    if any(row[-1] != surface for row in rows) or not rows:
        return []
    points = read_pairs(path)
    return [TouchedPair(suggestion, tuple(camera), tuple(base))
            for suggestion, camera, base in zip(
                suggestions, points.camera_points[:, :2].tolist(),
                points.base_points[:, :2].tolist())]


def calibrate_touches(
    pairs: PointPairs, surface_values: Mapping[str, Any], base_z: str
) -> Calibration:
    """
    Fit the base frame to pairs, see :func:`calibrate_base`.

    :param surface_values: The parameters of the surface that the camera points were measured with.
    :param base_z: Direction of the base frame's z at the table: 'up' or 'down'.
    """
    return calibrate_base(
        pairs, source='objects that the robot touched', base_z=base_z,
        surface_values=surface_values, points_are='place')
