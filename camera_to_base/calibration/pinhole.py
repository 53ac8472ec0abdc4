# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Calibrates a pinhole camera from flat placements of a board and from tilted ones."""

from typing import Any, Dict, List, Optional, Sequence

from camera_to_base.calibration.board_tilt import all_to_one_side, held_tilt, rough_surface
from camera_to_base.calibration.boards.placement import Placement, PrintedBoard
from camera_to_base.calibration.camera_error import camera_error
from camera_to_base.calibration.checks import check_fit
from camera_to_base.calibration.figures import (
    coverage, error_figures, surface_errors, tilt_of, warnings)
from camera_to_base.calibration.pinhole_checks import check_boards, check_place
from camera_to_base.calibration.pinhole_fit import fit_pinhole, PinholeFit
from camera_to_base.calibration.report import ErrorMap, figure_lines
from camera_to_base.calibration.result import (
    axis_fields, Calibration, figure_fields, origin_fields, report_panels, report_picture)
from camera_to_base.errors import CameraToBaseError
from camera_to_base.surface import Hull, LensModel, MatchedPoints, surface_values
from camera_to_base.uncertainty import scales_at
import numpy as np

NO_HEIGHTS = (
    "the camera's height and foot point, which objects with a height need, cannot be told from "
    'flat pictures alone: hold the board at a tilt in four more pictures (--tilted-placements 4, '
    'or --tilted FILE…)')


def calibrate_pinhole(
    board: PrintedBoard, flat: Sequence[Placement], tilted: Sequence[Placement], source: str,
    known: Optional[LensModel] = None,
) -> Calibration:
    """
    Fit lens and pose of the camera to all pictures at once.

    :param flat: The board on the table; the first one defines the camera frame.
    :param tilted: The board held at a tilt; none is enough if the lens is known.
    :param source: The pictures' origin, for the report.
    :param known: The lens, if it is known.
    :raises CalibrationError: If the pictures do not fit each other; the message names one.
    """
    height, width = flat[0].image.shape[:2]
    columns, rows = board.corners
    names = [placement.name for placement in (*flat, *tilted)]
    fit = fit_pinhole([one.matched for one in flat], [one.matched for one in tilted],
                      (width, height), known, [one.numbers for one in (*flat, *tilted)])
    matched = _kept_flat(fit)
    doubts = [*check_boards(fit, names), *check_fit(
        fit.surface, matched, (width, height), are_clicks=False)]
    error = camera_error(fit)
    camera = error.report(fit.surface)
    doubts += check_place(camera, known is not None)
    doubts += all_to_one_side(_held(flat, tilted))
    hull = Hull(matched.pixels)
    covered = coverage(hull, (width, height))
    figures = error_figures(surface_errors(fit.surface, matched), matched.rows,
                            _left_out_cm(fit, matched))
    values = {**surface_values(fit.surface, hull), **error.values}
    report = {**origin_fields('pinhole', source), 'image_size': [width, height],
              'lens': _lens(fit, known), 'tilt_deg': tilt_of(fit.surface), 'camera': camera,
              **axis_fields(fit.surface, matched), **figure_fields(figures, 'corner'),
              'pictures': _pictures(fit, names), 'coverage': covered,
              'warnings': [*warnings(figures, covered), *doubts]}
    report.update(ErrorMap(values).fields)
    panels = report_panels(
        fit.surface, matched, (width, height), image=flat[0].image,
        lattice=board.first_points().reshape(rows, columns, 2),
        error_map=report['error_map_mm'], raised=report['raised_error_map_mm'])
    return Calibration(report, values, report_picture(panels, figure_lines(report)), panels)


def _kept_flat(fit: PinholeFit) -> MatchedPoints:
    """Return the corners of the flat placements that count, in the camera frame."""
    kept = [fit.kept_of(board) for board in range(fit.problem.flat_count)]
    return MatchedPoints(
        np.concatenate([points[own] for points, own in zip(fit.placed, kept)]),
        np.concatenate([board.pixels[own] for board, own in zip(fit.problem.boards, kept)]))


def _left_out_cm(fit: PinholeFit, matched: MatchedPoints) -> np.ndarray:
    """Return how far each corner is off by a fit that has not seen its picture, shape (n,)."""
    errors = np.concatenate([one.errors for one in fit.left_out[:fit.problem.flat_count]])
    moves = scales_at(fit.surface, matched.pixels) @ errors[:, :, None]
    return np.linalg.norm(moves[:, :, 0], axis=1)


def _held(flat: Sequence[Placement], tilted: Sequence[Placement]) -> List[Any]:
    height, width = flat[0].image.shape[:2]
    surface = rough_surface([one.matched for one in flat], (width, height))
    if surface is None:
        return []
    try:
        return [held_tilt(one.matched, surface) for one in tilted]
    except CameraToBaseError:
        return []


def _lens(fit: PinholeFit, known: Optional[LensModel]) -> Dict[str, Any]:
    lens = fit.surface.lens
    return {'is_known': known is not None, 'model': lens.model, 'focal_px': list(lens.focal),
            'centre_px': list(lens.centre), 'coefficients': list(lens.coefficients)}


def _pictures(fit: PinholeFit, names: Sequence[str]) -> List[Dict[str, Any]]:
    """Return the residuals of each picture."""
    found = []
    for board, name in enumerate(names):
        kept = fit.kept_of(board)
        squares = np.sum(fit.residuals[board][kept] ** 2, axis=1)
        found.append({
            'name': name, 'is_tilted': board >= fit.problem.flat_count,
            'rms_px': round(float(np.sqrt(squares.mean() / 2)), 3),
            'left_out_rms_px': round(fit.left_out[board].rms_px, 3),
            'bad_corners': int((~kept).sum())})
    return found
