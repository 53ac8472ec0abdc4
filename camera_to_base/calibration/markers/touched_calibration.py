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
"""The surface and the base frame together, from markers that the robot has touched."""

from typing import Any, Callable, Collection, Dict, List, Mapping, NamedTuple, Sequence, Tuple

from camera_to_base.calibration.error_map import ErrorMap
from camera_to_base.calibration.figures import coverage, error_figures, MM_PER_CM
from camera_to_base.calibration.fits.alignment import rotation_deg
from camera_to_base.calibration.markers.learning import learned_markers, steady_corners
from camera_to_base.calibration.markers.touched_checks import checked_fit, CheckedFit
from camera_to_base.calibration.markers.touched_error import touched_error
from camera_to_base.calibration.markers.touched_problem import TouchedFit, TouchedMarkers
from camera_to_base.calibration.report_text import Report
from camera_to_base.calibration.result import (
    axis_fields, Calibration, figure_fields, origin_fields)
from camera_to_base.errors import CalibrationError
from camera_to_base.image_size import ImageSize
from camera_to_base.markers import Corners
from camera_to_base.parameters import calibration_record, checked_values
from camera_to_base.surface import (
    HomographySurface, Hull, MatchedPoints, RadialDistortion, sees_y_clockwise, SURFACE_SPECS,
    surface_values)
from camera_to_base.uncertainty import base_error, SURFACE_COVARIANCE, triangle_of
import numpy as np

# Three markers leave open whether the size, the lens or a touch is wrong.
LEAST_TOUCHED = 4
# The edges are looked for again where the fitted lens has them.
_ROUNDS = 2
# x, y and yaw of a pose.
_IN_PLANE = [0, 1, 5]

# Finds the markers in each of several frames, for a lens.
Look = Callable[[RadialDistortion], List[Corners]]
_Point = Tuple[float, float]


class TouchedCalibration(NamedTuple):
    """
    A surface with its base frame.

    :param calibration: The parameters of both, of the markers, and the surface's record.
    :param base_report: The report's part of the base frame.
    """

    calibration: Calibration
    base_report: Report


def markers_to_touch(frames: Sequence[Corners]) -> List[int]:
    """
    Return the numbers of the markers that frames show.

    :raises CalibrationError: If there are too few, they move, or lie in one line.
    """
    seen = sorted(steady_corners(frames))
    if len(seen) < LEAST_TOUCHED:
        _refuse_missing(range(LEAST_TOUCHED), seen)
    return seen


def _refuse_missing(wanted: Sequence[int], seen: Collection[int]) -> None:
    missing = [str(number) for number in wanted if number not in seen]
    if missing:
        raise CalibrationError(
            f'marker {" and ".join(missing)} is not seen, only {", ".join(map(str, seen))}: '
            'without a calibrated surface all four are needed; show it larger, sharper and not '
            'covered')


def calibrate_touched_markers(
    look: Look, touched: Mapping[int, _Point], marker_mm: float, image_size: ImageSize, *,
    source: str, base_z: str = 'up',
) -> TouchedCalibration:
    """
    Calibrate the surface and the base frame.

    The camera frame is laid onto the markers: its origin is the middle of the first one, x leads
    to the second one, z into the table. It is fixed to the base frame, so what is uncertain about
    x, y and yaw is all in the surface's covariance.

    :param look: Finds the markers.
    :param touched: Their middles, x and y in cm, in the base frame, by number.
    :param marker_mm: Edge of their black squares.
    :param image_size: Width and height of the frames, in px.
    :param source: The frames' origin, for the report.
    :param base_z: See `calibrate_base`.
    :raises CameraToBaseError: If touches and markers do not fit each other.
    """
    numbers = tuple(sorted(touched))
    touches = np.array([touched[number] for number in numbers], float)
    lens, corners = RadialDistortion.of_picture(image_size), {}
    for _ in range(_ROUNDS):
        # A marker at the picture's edge may be lost where the lens moves its edges.
        corners = {**corners, **steady_corners(look(lens))}
        _refuse_missing(numbers, corners)
        checked = checked_fit(
            TouchedMarkers(numbers, np.array([corners[number] for number in numbers]), touches,
                           marker_mm / MM_PER_CM), image_size, base_z)
        lens = checked.fit.surface.distortion
    return _calibration(corners, checked, touches, numbers, marker_mm, source)


def _calibration(
    corners: Corners, checked: CheckedFit, touches: np.ndarray,
    numbers: Tuple[int, ...], marker_mm: float, source: str,
) -> TouchedCalibration:
    fit = checked.fit
    surface, base_values = _camera_frame(fit)
    hull = Hull(fit.pixels)
    covariance = touched_error(fit, touches)
    figures = error_figures(np.linalg.norm(fit.places[:, :2] - touches, axis=1), numbers,
                            checked.left_out_cm)
    touched = f'touched markers {", ".join(map(str, numbers))}'
    source = f'{touched} of {marker_mm:g} mm, without a board (lens not measured), {source}'
    errors = figure_fields(figures, 'marker')
    base_report = {**origin_fields('rigid', touched), **errors, 'warnings': []}
    lens = surface.distortion
    values: Dict[str, Any] = {
        **surface_values(surface, hull), SURFACE_COVARIANCE: triangle_of(covariance),
        **base_values, 'calibration.base': calibration_record(base_report)}
    learned = learned_markers([corners], checked_values(SURFACE_SPECS, {
        name: value for name, value in values.items() if name.startswith('surface.')}),
        source=source, marker_mm=marker_mm)
    report = {
        **origin_fields('homography', source), 'image_size': list(surface.image_size),
        'distortion_coefficient': lens.coefficient, 'distortion_centre': list(lens.centre),
        'lens_deviation': float(np.sqrt(covariance[8, 8])),
        **axis_fields(surface, MatchedPoints(surface.locate(fit.pixels), fit.pixels)), **errors,
        'coverage': coverage(hull, surface.image_size), 'markers': learned.report['markers'],
        'rotation_deg': base_values['rotation_deg'],
        'displacement_cm': base_values['displacement_cm'],
        'warnings': [*checked.doubts, *learned.report['warnings']]}
    values.update(learned.values)
    report.update(ErrorMap(values).fields)
    return TouchedCalibration(Calibration(report, values), base_report)


def _camera_frame(fit: TouchedFit) -> Tuple[HomographySurface, Dict[str, Any]]:
    """Lay the camera frame onto the markers; return the surface in it, and the base frame."""
    origin, second = fit.places[0, :2], fit.places[1, :2]
    along_x = (second - origin) / np.linalg.norm(second - origin)
    # As the picture shows it, y is clockwise from x.
    clockwise = 1.0 if sees_y_clockwise(MatchedPoints(fit.points, fit.pixels)) else -1.0
    turn = np.column_stack([along_x, clockwise * np.array([-along_x[1], along_x[0]])])
    camera_from_base = np.eye(3)
    camera_from_base[:2, :2], camera_from_base[:2, 2] = turn.T, -turn.T @ origin
    surface = HomographySurface(camera_from_base @ fit.surface.surface_from_pixel,
                                fit.surface.image_size, fit.surface.distortion)
    rotation = np.diag([1.0, 1.0, clockwise])
    rotation[:2, :2] = turn
    arms = np.column_stack([fit.places[:, :2] - origin, np.zeros(len(fit.places))])
    covariance = base_error(arms, None, flat=True).covariance
    covariance[_IN_PLANE] = covariance[:, _IN_PLANE] = 0.0
    return surface, {'rotation_deg': list(rotation_deg(rotation)),
                     'displacement_cm': [*origin.tolist(), 0.0],
                     'base_covariance': triangle_of(covariance)}
