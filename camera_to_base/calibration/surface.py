# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Computes the parameters of a surface from matched points or from placements of a board."""

from dataclasses import replace
from typing import Any, List, Mapping, Optional, Sequence

from camera_to_base.calibration.boards.placement import (
    map_lines, outer_edge, Placement, PrintedBoard, shares_of, uncovered)
from camera_to_base.calibration.checks import (
    check_fit, check_placements, refuse_outlier, surface_error)
from camera_to_base.calibration.figures import (
    coverage, error_figures, left_out_errors, surface_errors, tilt, warnings)
from camera_to_base.calibration.homography_fit import fit_homography, POINTS_FOR_DISTORTION
from camera_to_base.calibration.marker_learning import with_markers
from camera_to_base.calibration.pinhole import calibrate_pinhole, NO_HEIGHTS
from camera_to_base.calibration.polynomial_fit import fit_polynomial
from camera_to_base.calibration.report import ErrorMap, figure_lines, Report
from camera_to_base.calibration.result import (
    axis_fields, Calibration, figure_fields, origin_fields, refuse_too_many, report_panels,
    report_picture)
from camera_to_base.calibration.tables import refuse_other_size
from camera_to_base.checks import ImageSize
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import checked_values
from camera_to_base.surface import (
    Hull, LensModel, make_hull, make_surface, MatchedPoints, SURFACE_SPECS, surface_values,
    view_thumbnail)
from camera_to_base.uncertainty import SURFACE_COVARIANCE, triangle_of
import numpy as np


def calibrate_surface(
    matched: MatchedPoints, image_size: ImageSize, *, source: str, model: str = 'homography',
    points_are: str = 'row', image: Optional[np.ndarray] = None,
    lattice: Optional[np.ndarray] = None, further: Sequence[MatchedPoints] = (),
) -> Calibration:
    """
    Fit the surface.

    :param image_size: Width and height of the picture, in px.
    :param source: The points' origin, for the report.
    :param model: 'homography' or 'polynomial'.
    :param points_are: The report's word for a point.
    :param image: The background of the report picture; see :func:`report_picture`.
    :param lattice: The grid to draw; see :func:`report_picture`.
    :param further: Points of further placements of a board, see :func:`fit_homography`.
    :raises CameraToBaseError: If the points do not determine the surface.
    """
    counts = [len(matched), *map(len, further)]
    refuse_too_many(sum(counts))
    if model == 'homography':
        fit = fit_homography(matched, image_size, further)
        matched = _together([matched, *further], fit.points)
        found = {'distortion_coefficient': fit.surface.distortion.coefficient,
                 'distortion_centre': list(fit.surface.distortion.centre),
                 'points_for_distortion': POINTS_FOR_DISTORTION,
                 'tilt_deg': tilt(fit.surface, fit.without)}
    else:
        fit = fit_polynomial(matched, image_size)
        found = {'equations': list(fit.equations),
                 'r_squared': [fit.y_r_squared, fit.px_per_cm_r_squared]}
    if points_are == 'row' and model == 'homography':
        refuse_outlier(fit.surface, fit.without, matched)
    doubts = [] if not further else check_placements(
        fit.surface, _parts(matched, counts), image_size)
    doubts += check_fit(fit.surface, matched, image_size, are_clicks=points_are == 'row')
    hull = Hull(matched.pixels)
    covered = coverage(hull, image_size)
    figures = error_figures(surface_errors(fit.surface, matched), matched.rows,
                            left_out_errors(fit.without, matched))
    report = {**origin_fields(model, source), 'image_size': list(image_size), **found,
              **axis_fields(fit.surface, matched), **figure_fields(figures, points_are),
              'coverage': covered, 'warnings': [*warnings(figures, covered), *doubts]}
    error = surface_error(fit.surface, matched, image_size, points_are, counts)
    values = {**surface_values(fit.surface, hull),
              SURFACE_COVARIANCE: triangle_of(error.covariance)}
    report.update(ErrorMap(values).fields)
    panels = report_panels(fit.surface, matched, image_size, image=image, lattice=lattice,
                           error_map=report['error_map_mm'])
    return Calibration(report, values, report_picture(panels, figure_lines(report)), panels)


def check_surface(
    values: Mapping[str, Any], matched: MatchedPoints, table_size: Optional[ImageSize] = None
) -> Report:
    """
    Compute the error of a surface on points that it was not made from.

    :param values: Its parameters by full name; missing ones have their defaults.
    :param table_size: Width and height of the points' picture, in px; None if unknown.
    :raises CameraToBaseError: If the parameters do not define a surface, the picture sizes differ,
        or a pixel does not show the surface.
    """
    if not any(name.startswith('surface.') for name in values):
        raise InvalidValueError(
            'expected the parameters of a surface, as calibrate board and calibrate points write '
            f'them, got {", ".join(values) or "none"}')
    error_map = ErrorMap(values)
    # The points lie on the surface, whatever object height the parameters set.
    values = checked_values(SURFACE_SPECS, values)
    surface, hull = make_surface(values), make_hull(values)
    refuse_other_size(table_size, values['surface.image_size'])
    figures = error_figures(surface_errors(surface, matched), matched.rows)
    outside = 0 if hull is None else sum(not hull.contains(pixel) for pixel in matched.pixels)
    return {'model': values['surface.model'], **figure_fields(figures, 'row'),
            'outside_hull': outside, 'warnings': [], **error_map.fields}


def _together(placements: Sequence[MatchedPoints], points: np.ndarray) -> MatchedPoints:
    """Return the points of all placements, where the fit has put them in the camera frame."""
    if len(placements) == 1:
        return placements[0]
    return MatchedPoints(points, np.concatenate([placement.pixels for placement in placements]))


def _parts(matched: MatchedPoints, counts: Sequence[int]) -> List[MatchedPoints]:
    """Divide the points of all placements into those of each."""
    return [matched.take(np.arange(end - count, end))
            for count, end in zip(counts, np.cumsum(counts))]


def _check_lens_size(lens_size: ImageSize, image_size: ImageSize) -> None:
    if tuple(lens_size) != tuple(image_size):
        raise InvalidValueError(
            'the intrinsics are for pictures of {} x {} px, but this one has {} x {} px: use '
            'those of its size'.format(*lens_size, *image_size))


def calibrate_placements(
    board: PrintedBoard, placements: Sequence[Placement], lens: Optional[LensModel] = None,
    tilted: Sequence[Placement] = (),
) -> Calibration:
    """
    Fit the surface to all placements of a board, which lies on it in each.

    The values hold a thumbnail of the surface, and markers that lie beside the board, too. The
    camera's place is told if the lens is known, or the board was held at a tilt, too.

    :param placements: The first one defines the camera frame.
    :param lens: The lens; None if it is not known.
    :param tilted: Pictures of the board held at a tilt above the surface.
    :raises CalibrationError: If the placements do not fit each other.
    """
    first, *further = placements
    height, width = first.image.shape[:2]
    source = _source_of(board, placements, tilted)
    if lens is not None:
        _check_lens_size(lens.image_size, (width, height))
    if lens is not None or tilted:
        calibration = calibrate_pinhole(board, placements, tilted, source, lens)
    else:
        columns, rows = board.corners
        calibration = calibrate_surface(
            first.matched, (width, height), image=first.image,
            lattice=board.first_points().reshape(rows, columns, 2), points_are='corner',
            further=[placement.matched for placement in further], source=source)
        calibration.report['heights'] = NO_HEIGHTS
    report = calibration.report
    report['warnings'] += [
        doubt for placement in (*placements, *tilted) for doubt in placement.doubts]
    report['covered_map'] = map_lines(shares_of(placements))
    report['not_covered'] = uncovered(shares_of(placements))
    thumbnail = view_thumbnail(first.image, [outer_edge(first)])
    return with_markers(replace(
        calibration, values={'calibration.thumbnail': thumbnail, **calibration.values}),
        first.image)


def _source_of(
    board: PrintedBoard, placements: Sequence[Placement], tilted: Sequence[Placement]
) -> str:
    names = ', '.join(dict.fromkeys(one.name.partition(', placement ')[0] for one in placements))
    places = f', in {len(placements)} places' if len(placements) > 1 else ''
    held = f', held at {len(tilted)} tilts' if tilted else ''
    return f'{board.text}, in {names}{places}{held}'
