# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A calibration's report as text, and the error that is to be expected in the picture."""

import math
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.checks import ImageSize
from camera_to_base.errors import HorizonError
from camera_to_base.parameters import checked_values, TRANSFORM_SPECS
from camera_to_base.surface import make_surface, SURFACE_SPECS
from camera_to_base.uncertainty import (
    error_ellipse, position_uncertainty, uncertain_transform_of, UNCERTAINTY_SPECS)
import cv2
import numpy as np

Report = Dict[str, Any]

# Row by row from the picture's top left, in mm; None beyond the horizon.
ErrorRows = Sequence[Sequence[Optional[float]]]
_SHARE, _MM_PER_CM = 0.95, 10
# Places of the map, along the picture's width and height.
COLUMNS, ROWS = 8, 6
_FONT = cv2.FONT_HERSHEY_SIMPLEX
# The colours go from this to this many mm; errors are compared by their ratio.
_LEAST_MM, _MOST_MM = 0.3, 30.0


# Largest errors in mm in the middle of the picture and in its corners, for each word. A touch by a
# gripper with a ruler is off by 1 to 2 mm: where the camera adds no more in the middle, it is not
# what limits the arm. A gripper that opens 1 cm wider than the object reaches it up to 5 mm off,
# and 10 mm off it pushes most objects over.
VERDICTS = (('good', 2.0, 5.0), ('fair', 5.0, 10.0), ('poor', math.inf, math.inf))

# So high is what grippers hold; the report shows the errors of such objects, too.
RAISED_CM = 5.0


def report_lines(report: Mapping[str, Any], with_map: bool = False) -> List[str]:
    """
    Write a report as lines.

    :param report: What `calibrate --json` prints.
    :param with_map: Whether to write the expected errors all over the picture, too.
    """
    return [*_model_lines(report), *figure_lines(report),
            *(_map_lines(report) if with_map else ()), *_verdict_lines(report),
            *(f'warning: {text}' for text in report['warnings'])]


def figure_lines(report: Mapping[str, Any]) -> List[str]:
    """Write the errors, and where they hold, as lines."""
    if 'points' not in report:
        return []
    lines = [f'error at {report["points"]} points: rms {report["rms_mm"]:.2f} mm, '
             f'mean {report["mean_mm"]:.2f} mm, '
             f'largest {report["max_mm"]:.2f} mm ({report["points_are"]} {report["worst_row"]})']
    if report.get('leave_one_out_rms_mm') is not None:
        lines[0] += f', each left out of the fit: rms {report["leave_one_out_rms_mm"]:.2f} mm'
    if 'coverage' in report:
        lines.append(f'the points cover {100 * report["coverage"]:.0f} % of the picture: outside '
                     'of them these figures do not hold')
    if report.get('not_covered'):
        lines += ['the ninths of the picture that the board covered (# covered, + in part):',
                  *(f'  {line}' for line in report['covered_map']),
                  f'least covered: {", ".join(report["not_covered"][:2])}: lay the board there, '
                  'too, if you work there (several pictures, or --placements)']
    if report.get('outside_hull'):
        lines.append(f'{report["outside_hull"]} of the points lie outside the area that the '
                     'calibration was measured in')
    return lines


def _map_lines(report: Mapping[str, Any]) -> Iterator[str]:
    if 'error_map_mm' not in report:
        return
    frame = ('the base transform included' if report['error_map_has_base']
             else 'without the base transform')
    yield (f'95 % of the positions are expected within so many mm, over the picture ({frame}):')
    yield from map(_map_row, report['error_map_mm'])
    if 'raised_error_map_mm' in report:
        yield f"and those of objects that are {RAISED_CM:g} cm high, for the camera's place:"
        yield from map(_map_row, report['raised_error_map_mm'])


def _map_row(row: Sequence[Optional[float]]) -> str:
    return '  ' + ' '.join('-'.rjust(6) if error is None else f'{error:6.1f}' for error in row)


def _verdict_lines(report: Mapping[str, Any]) -> Iterator[str]:
    if 'verdict_sentence' in report:
        yield (f'{report["verdict_sentence"]} '
               f'({"" if report["error_map_has_base"] else "without "}the base transform'
               f'{" included" if report["error_map_has_base"] else ""})')


def _model_lines(report: Mapping[str, Any]) -> List[str]:
    return [line for part, write in _PARTS.items() if part in report for line in write(report)]


def _source(report: Mapping[str, Any]) -> Iterator[str]:
    yield f'{report["model"]} from {report["source"]}, {report["date"]}'


def _image_size(report: Mapping[str, Any]) -> Iterator[str]:
    yield 'for pictures of {} x {} px'.format(*report['image_size'])


def _lens(report: Mapping[str, Any]) -> Iterator[str]:
    if report['distortion_coefficient'] != 0:
        u, v = report['distortion_centre']
        yield (f'lens: radial coefficient {report["distortion_coefficient"]:.4f} about pixel '
               f'({u:.1f}, {v:.1f})')
    elif report['points'] < report['points_for_distortion']:
        yield (f'lens: taken as free of distortion; {report["points_for_distortion"]} points or '
               'more can tell it, with fewer it would follow their noise')
    else:
        yield 'lens: no distortion that would locate other points better'


def _tilt(report: Mapping[str, Any]) -> Iterator[str]:
    told = report['tilt_deg'] is not None
    yield (f'the camera looks at the surface at {report["tilt_deg"]:.1f} degrees from straight '
           'down' if told else "the camera's tilt cannot be told from these points")


def _pinhole(report: Mapping[str, Any]) -> Iterator[str]:
    lens, camera = report['lens'], report['camera']
    spread = 'known' if lens['is_known'] else f'95 %: ± {camera["focal_px_95"]:.1f} px'
    numbers = ', '.join(f'{value:.4f}' for value in lens['coefficients']) or 'none'
    yield (f'lens: focal length {camera["focal_px"]:.1f} px ({spread}), centre '
           '({:.1f}, {:.1f}) px, '.format(*lens['centre_px'])
           + f'distortion ({lens["model"]}): {numbers}')
    yield ('the camera is {height_cm:.1f} cm above the surface (95 %: ± {height_cm_95:.2f} cm), '
           'its foot point at ({}, {}) cm (± {foot_cm_95:.2f} cm)'.format(
               *(f'{value:.1f}' for value in camera['foot_cm']), **camera))


def _pictures(report: Mapping[str, Any]) -> Iterator[str]:
    for picture in report['pictures']:
        kind = 'tilted' if picture['is_tilted'] else 'flat'
        yield (f'{picture["name"]} ({kind}): off by {picture["rms_px"]:.2f} px rms, left out of '
               f'the fit: {picture["left_out_rms_px"]:.2f} px')


def _heights(report: Mapping[str, Any]) -> Iterator[str]:
    yield report['heights']


def _axes(report: Mapping[str, Any]) -> Iterator[str]:
    yield ('camera frame: origin at pixel ({:.1f}, {:.1f}), '.format(*report['origin_px'])
           + 'x towards pixel ({:.1f}, {:.1f}), '.format(*report['x_towards_px'])
           + 'y towards pixel ({:.1f}, {:.1f}), '.format(*report['y_towards_px'])
           + f'z {report["z_points"]}')


def _equations(report: Mapping[str, Any]) -> Iterator[str]:
    for equation, r_squared in zip(report['equations'], report['r_squared']):
        yield f'{equation}   (R^2 = {r_squared:.6f})'


def _sheet(report: Mapping[str, Any]) -> Iterator[str]:
    if 'marker_mm' in report:
        yield f'four markers of {report["marker_mm"]:g} mm, 0 to 3, on {report["paper"]}'
        return
    columns, rows = report['corners']
    yield (f'a chessboard of {columns} x {rows} inner corners, {report["square_mm"]:g} mm apart, '
           f'on {report["paper"]}')


def _status(report: Mapping[str, Any]) -> Iterator[str]:
    yield report['summary']
    yield from report['holds']
    yield from (f'not in the file: {part}' for part in report['lacks'])
    if 'offer' in report:
        yield f'running node: {report["offer"]}'


def _kept_correction(report: Mapping[str, Any]) -> Iterator[str]:
    yield f'kept: surface of {report["kept_correction"]}'


def _markers(report: Mapping[str, Any]) -> Iterator[str]:
    yield from (f'marker {number}: middle at ({x:.2f}, {y:.2f}) cm, edges of {edge_mm:.1f} mm'
                for number, x, y, edge_mm in report['markers'])


def _rotation(report: Mapping[str, Any]) -> Iterator[str]:
    yield ('camera frame in the base frame: rotated by roll {:.3f}, pitch {:.3f}, yaw {:.3f} '
           'degrees about the fixed axes'.format(*report['rotation_deg']))
    yield 'its origin there: ({:.3f}, {:.3f}, {:.3f}) cm'.format(*report['displacement_cm'])


_PARTS = {
    'source': _source,
    'image_size': _image_size,
    'distortion_coefficient': _lens,
    'equations': _equations,
    'tilt_deg': _tilt,
    'lens': _pinhole,
    'pictures': _pictures,
    'heights': _heights,
    'origin_px': _axes,
    'rotation_deg': _rotation,
    'markers': _markers,
    'paper': _sheet,
    'status_of': _status,
    'kept_correction': _kept_correction,
}


class Verdict(NamedTuple):
    """
    What a map says in a word.

    :param word: See VERDICTS.
    :param middle_mm: The largest error in the middle of the picture.
    :param corners_mm: The largest error in the corners that show the surface; None for none.
    """

    word: str
    middle_mm: float
    corners_mm: Optional[float]

    @property
    def sentence(self) -> str:
        """Tell the errors behind the word."""
        corners = ('the corners do not show the surface' if self.corners_mm is None
                   else f'{self.corners_mm:.1f} mm in the corners')
        good = VERDICTS[0]
        limits = '' if self.word == good[0] else (
            f'; good is {good[1]:g} mm and {good[2]:g} mm: measure more points, there, too')
        return (f'{self.word}: 95 % of positions within {self.middle_mm:.1f} mm in the middle and '
                f'{corners}{limits}')


def verdict_of(errors: ErrorRows) -> Optional[Verdict]:
    """
    Sum a map up.

    :param errors: Of COLUMNS x ROWS places.
    :returns: None if the middle does not show the surface.
    """
    middle = [errors[row][column] for row in (ROWS // 2 - 1, ROWS // 2)
              for column in (COLUMNS // 2 - 1, COLUMNS // 2)]
    if None in middle:
        return None
    corners = [error for row in (0, -1) for error in (errors[row][0], errors[row][-1])
               if error is not None]
    worst = max(corners, default=None)
    word = next(word for word, most_middle, most_corners in VERDICTS
                if max(middle) <= most_middle and (worst or 0.0) <= most_corners)
    return Verdict(word, max(middle), worst)


class ErrorMap:
    """
    The long half axis of the ellipse that contains 95 % of the errors, over the picture.

    :param values: The parameters of a calibration by full name; missing ones have their defaults.
        The base transform counts where they have it.
    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        known = {**checked_values([*SURFACE_SPECS, *UNCERTAINTY_SPECS], values),
                 'detector.method': values.get('detector.method', 'precise')}
        self.image_size: ImageSize = tuple(known['surface.image_size'])
        self._uncertainty = position_uncertainty(known, make_surface(known))
        self._knows_place = known['surface.model'] == 'pinhole'
        self._transform = None
        if 'displacement_cm' in values:
            self._transform = uncertain_transform_of(checked_values(TRANSFORM_SPECS, values))

    @property
    def has_base(self) -> bool:
        """Whether the base transform is included."""
        return self._transform is not None

    @property
    def fields(self) -> Report:
        """Return a report's fields of the map."""
        errors = self.errors_mm()
        verdict = verdict_of(errors)
        raised = {'raised_error_map_mm': self.errors_mm(height_cm=RAISED_CM)
                  } if self._knows_place else {}
        return {'error_map_mm': errors, 'error_map_has_base': self.has_base, **raised,
                **({'verdict': verdict.word, 'verdict_sentence': verdict.sentence}
                   if verdict else {})}

    def errors_mm(
        self, columns: int = COLUMNS, rows: int = ROWS, height_cm: float = 0.0
    ) -> List[List[Optional[float]]]:
        """
        Return the map, row by row from the picture's top left.

        :param height_cm: Of the objects, known without an error.
        :returns: Errors in mm at the middles of equal parts; None beyond the horizon.
        """
        width, height = self.image_size
        return [[self._at(((column + 0.5) * width / columns, (row + 0.5) * height / rows),
                          height_cm)
                 for column in range(columns)] for row in range(rows)]

    def _at(self, pixel: Tuple[float, float], height_cm: float) -> Optional[float]:
        try:
            x, y = self._uncertainty.surface.locate([pixel])[0].tolist()
        except HorizonError:
            return None
        covariance = self._uncertainty.of_pixel(pixel, self.image_size, height_cm).matrix
        if self._transform is not None:
            covariance = self._transform.base_covariance((x, y, 0.0), covariance)
        return _MM_PER_CM * error_ellipse(covariance, _SHARE).long


def map_picture(image: np.ndarray, errors: ErrorRows) -> np.ndarray:
    """
    Draw a map over a picture: green for small errors, red for large ones, and the numbers.

    :param image: Shape (h, w, 3), uint8, BGR.
    :returns: Of the same shape.
    """
    height, width = image.shape[:2]
    numbers = np.array([[np.nan if error is None else error for error in row] for row in errors])
    share = np.log(np.clip(numbers, _LEAST_MM, _MOST_MM) / _LEAST_MM) / np.log(
        _MOST_MM / _LEAST_MM)
    # From blue-green over yellow to red.
    hue = np.nan_to_num(90 * (1 - share)).astype(np.uint8)
    cells = cv2.merge([hue, np.full_like(hue, 200), np.where(np.isnan(share), 0, 220).astype(
        np.uint8)])
    colours = cv2.resize(cv2.cvtColor(cells, cv2.COLOR_HSV2BGR), (width, height),
                         interpolation=cv2.INTER_CUBIC)
    drawn = cv2.addWeighted(image, 0.55, colours, 0.45, 0)
    scale = height / 480 * 0.5
    for (row, column), error in np.ndenumerate(numbers):
        text = '-' if np.isnan(error) else f'{error:.1f}'
        (across, up), _ = cv2.getTextSize(text, _FONT, scale, 1)
        place = (round((column + 0.5) * width / numbers.shape[1] - across / 2),
                 round((row + 0.5) * height / numbers.shape[0] + up / 2))
        for colour, thickness in (((0, 0, 0), 3), ((255, 255, 255), 1)):
            cv2.putText(drawn, text, place, _FONT, scale, colour, thickness, cv2.LINE_AA)
    return drawn
