# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Checks whether the points and pairs of a calibration are plausible, and how uncertain it is."""

from typing import Any, List, Mapping, Optional, Sequence, Union

from camera_to_base.calibration.figures import find_outlier, MM_PER_CM, surface_errors
from camera_to_base.calibration.rigid_fit import PAIRS_TO_TELL_A_BAD_ONE, RigidFit, spread
from camera_to_base.checks import ImageSize
from camera_to_base.errors import CalibrationError, HorizonError
from camera_to_base.surface import (
    HomographySurface, Hull, make_hull, make_surface, MatchedPoints, PointPairs,
    PolynomialSurface, Surface, SURFACE_DEFAULTS)
from camera_to_base.uncertainty import base_error, fit_error, FitError, scales_at, warp_design
import numpy as np

# The usual error of a coordinate: corners are found by the command, points are clicked.
_EXPECTED_PX = {'corner': 0.15, 'row': 0.5}

# Share of the diagonal of the points' box. Simulated tables of 5 to 20 points with errors of
# 1 px and 0.5 mm stay below 1.2 %; two exchanged rows give more than 2 % in 39 of 40 tables, and
# so do shuffled columns. On OpenCV's 26 sample boards it is 0.05 to 0.1 %.
LARGEST_RMS_SHARE = 0.02
# A square of this share of the picture has 7 % of its height: an error of 0.2 px at its corners
# becomes 3 px and more at the picture's corners.
SMALLEST_COVERAGE = 0.005
# Usual sizes of a table. Another size is reported: the unit may be wrong.
SMALLEST_EXTENT_CM = 3.0
LARGEST_EXTENT_CM = 300.0
# Beyond these it must be wrong.
_STAMP_CM, _HALL_CM = 1.0, 1000.0
# Of the extent, for the corners of a board: 26 sample boards have 0.05 to 0.1 %.
_DOUBTFUL_RMS_SHARE = 0.0025
# Corners are found to 0.1 to 0.2 px in pictures of this width, and a lens's model fits to about as
# much. A camera 90 cm above the table that comes 3 cm nearer between two placements gives 0.4 to
# 0.6 px. Its shift and its turn about the surface's normal cannot be told from the board's, and do
# no harm for that reason.
_USUAL_WIDTH, _DOUBTFUL_MISFIT_PX, _LARGEST_MISFIT_PX = 640, 0.5, 1.0
# The smallest error of a click.
_FLOOR_PX = 0.3
# Number of parameters of a homography, and of the lens.
_NUMBERS, _LENS_NUMBERS = 8, 3

# Nearer pairs do not determine the rotation. Farther ones do not fit on a table, unless a surface
# file shows a larger one.
SMALLEST_SPREAD_CM = 1.0
LARGEST_SPREAD_CM = 150.0
# The smallest error of a gripper tip and a ruler.
TOUCH_ERROR_CM = 0.1
# Expected errors at the far end of the table from which on the pairs are reported, and refused.
DOUBTFUL_ERROR_CM = 0.5
LARGEST_ERROR_CM = 2.0
DOUBTFUL_RMS_CM = 0.3
# Component of a table's normal along the base's z. If it is smaller, the surface is a wall, and z
# cannot show on which side of it the camera is.
_LEVEL = 0.1


def surface_error(
    surface: Union[HomographySurface, PolynomialSurface], matched: MatchedPoints,
    image_size: ImageSize, points_are: str, counts: Sequence[int] = (),
) -> FitError:
    """
    Estimate how uncertain a fitted surface is.

    :param surface: Fitted to the points.
    :param image_size: Width and height of the picture, in px.
    :param points_are: 'corner' or 'row', the report's word for a point.
    :param counts: How many of the points belong to each placement of a board, in order; the
        places of all but the first were fitted, too. Empty for one placement.
    """
    cm_per_px = scales_at(surface, matched.pixels)
    errors_cm = matched.points - surface.locate(matched.pixels)
    residuals = np.linalg.solve(cm_per_px, errors_cm[:, :, None])[:, :, 0]
    design = warp_design(matched.pixels, image_size, surface.distortion)
    motions = np.linalg.solve(cm_per_px, _motion_design(matched.points, counts))
    return fit_error(np.concatenate([design, motions], axis=2), residuals, matched.points,
                     expected_px=_EXPECTED_PX[points_are])


def transform_error(pairs: PointPairs, fit: RigidFit) -> np.ndarray:
    """Estimate the covariance of a fitted base transform, see `base_error`."""
    is_flat = not (pairs.camera_points[:, 2].any() or pairs.base_points[:, 2].any())
    return base_error(pairs.camera_points @ fit.rotation.T, fit.left_out_residuals, is_flat)


def _motion_design(points: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Return how the shift and the turn of each further placement move points, (n, 2, 3 m)."""
    design = np.zeros((len(points), 2, 3 * max(len(counts) - 1, 0)))
    starts = np.cumsum([0, *counts])
    for number, (start, end) in enumerate(zip(starts[1:-1], starts[2:])):
        offsets = points[start:end] - points[start:end].mean(axis=0)
        part = design[start:end, :, 3 * number:3 * number + 3]
        part[:, 0, 0] = part[:, 1, 1] = 1.0
        part[:, 0, 2], part[:, 1, 2] = -offsets[:, 1], offsets[:, 0]
    return design


def check_fit(
    surface: Surface, matched: MatchedPoints, image_size: ImageSize, *, are_clicks: bool
) -> List[str]:
    """
    Check that the errors of a fit are plausible, and that its points cover enough of the picture.

    :param image_size: Width and height of the picture, in px.
    :param are_clicks: Whether a person measured the points; otherwise they are a board's corners.
    :returns: Sentences about what is doubtful.
    :raises CalibrationError: If the errors are too large, the points too near each other, or the
        extent is none of a table.
    """
    share = Hull(matched.pixels).area / (image_size[0] * image_size[1])
    if share < SMALLEST_COVERAGE:
        width, height = np.ptp(matched.pixels, axis=0)
        raise CalibrationError(
            f'all points lie within {width:.0f} x {height:.0f} px of a picture of {image_size[0]} '
            f'x {image_size[1]} px, too near each other to tell anything of the rest: spread them '
            'over the working area')
    extent = float(np.linalg.norm(np.ptp(matched.points, axis=0)))
    errors = surface_errors(surface, matched)
    rms = float(np.sqrt(np.mean(errors ** 2)))
    if rms > LARGEST_RMS_SHARE * extent:
        raise CalibrationError(
            f'the points are no measurement of a surface: the best fit is off by {10 * rms:.0f} '
            f'mm rms, {100 * rms / extent:.0f} % of their extent of {extent:.0f} cm, most at row '
            f'{matched.rows[int(np.argmax(errors))]}: are rows or columns exchanged, or is one of '
            f'another picture? Up to {100 * LARGEST_RMS_SHARE:g} % can be errors of measurement')
    if not _STAMP_CM <= extent <= _HALL_CM:
        raise CalibrationError(
            f'the points span {extent:.3g} cm, which is no table: are the numbers in '
            f'{"m" if extent < _STAMP_CM else "mm"} instead of cm?')
    doubts = [] if are_clicks or rms <= _DOUBTFUL_RMS_SHARE * extent else [
        f'the corners are found to {10 * rms:.1f} mm rms only, {100 * rms / extent:.1f} % of '
        "the board's extent, where sharp pictures of a flat board give 0.1 %: is the picture "
        'blurred, or the board bent?']
    if SMALLEST_EXTENT_CM <= extent <= LARGEST_EXTENT_CM:
        return doubts
    return [*doubts, f'the points span {extent:.3g} cm, which is an unusual table: are all '
            'numbers in cm?']


def check_placements(
    surface: HomographySurface, placements: Sequence[MatchedPoints], image_size: ImageSize
) -> List[str]:
    """
    Check that one surface fits all placements of a board: the camera must not move between them.

    :param placements: The points of each, in the camera frame.
    :returns: Sentences about what is doubtful.
    :raises CalibrationError: If a placement does not fit.
    """
    errors = [float(np.sqrt(np.mean(np.sum(
        (surface.pixels(one.points) - one.pixels) ** 2, axis=1)))) for one in placements]
    worst = int(np.argmax(errors))
    scale = image_size[0] / _USUAL_WIDTH
    text = (f'the placements of the board do not fit each other: number {worst + 1} is off by '
            f'{errors[worst]:.1f} px rms: was the camera moved between the pictures, or is the '
            'board bent, or not flat on the table? Take all pictures again')
    if errors[worst] > _LARGEST_MISFIT_PX * scale:
        raise CalibrationError(text)
    return [text] if errors[worst] > _DOUBTFUL_MISFIT_PX * scale else []


def refuse_outlier(
    surface: HomographySurface, without: Sequence[Optional[HomographySurface]],
    matched: MatchedPoints,
) -> None:
    """
    Refuse a table with one row that does not fit the others.

    :param without: The n surfaces that were fitted without one point each, or None.
    :raises CalibrationError: If there is one; the message names the row and the fit without it.
    """
    if None in without:
        return
    count = len(matched)
    others = [matched.take(np.delete(np.arange(count), index)) for index in range(count)]
    squares = np.array([_squares_px(fold, kept) for fold, kept in zip(without, others)])
    if not np.isfinite(squares).all():
        return
    lens = _LENS_NUMBERS if surface.distortion.coefficient else 0
    index = find_outlier(_squares_px(surface, matched), squares, dimensions=2,
                         parameters=_NUMBERS + lens, floor=_FLOOR_PX)
    if index is not None:
        raise CalibrationError(_outlier_text(without[index], others[index], matched, index))


def _squares_px(surface: HomographySurface, matched: MatchedPoints) -> float:
    return float(np.sum((surface.pixels(matched.points) - matched.pixels) ** 2))


def _outlier_text(
    surface: HomographySurface, others: MatchedPoints, matched: MatchedPoints, index: int
) -> str:
    try:
        left_out = MM_PER_CM * float(
            np.linalg.norm(surface.locate(matched.pixels[index:index + 1])
                           - matched.points[index]))
        off = f'{left_out:.1f} mm'
    except HorizonError:
        off = 'more than the picture shows'
    rms = MM_PER_CM * float(np.sqrt(np.mean(surface_errors(surface, others) ** 2)))
    return (f'row {matched.rows[index]} does not belong to the others: it is off by {off} from '
            f'the fit to them, which they meet to {rms:.1f} mm rms: measure it again or delete it')


def check_pairs(pairs: PointPairs, fit: RigidFit) -> List[str]:
    """
    Check the pairs by themselves, without a surface.

    :returns: Sentences about what is doubtful.
    :raises CalibrationError: If the pairs lie too near each other.
    """
    extent = spread(pairs.camera_points)
    if extent < SMALLEST_SPREAD_CM:
        raise CalibrationError(
            f'all pairs lie within {10 * extent:.1f} mm, too near each other to tell how the '
            'frames are turned: are the numbers in m instead of cm? Otherwise spread the points '
            'over the working area')
    doubts = []
    if len(pairs) < PAIRS_TO_TELL_A_BAD_ONE:
        doubts.append(f'with {len(pairs)} pairs a bad one cannot be told from the others: give '
                      f'{PAIRS_TO_TELL_A_BAD_ONE} or more')
    rms = np.sqrt(np.mean(np.sum(fit.residuals ** 2, axis=1)))
    if rms > DOUBTFUL_RMS_CM:
        doubts.append(f'the pairs are off by {10 * rms:.1f} mm rms, where a ruler and a gripper '
                      'tip are off by 1 to 2 mm: measure them again')
    return doubts


def check_without_surface(pairs: PointPairs) -> List[str]:
    """
    Check the pairs if the surface is not known.

    :returns: Sentences about what is doubtful.
    :raises CalibrationError: If the pairs lie too far apart for a table.
    """
    extent = spread(pairs.camera_points)
    if extent > LARGEST_SPREAD_CM:
        raise CalibrationError(
            f'the pairs lie up to {extent:.0f} cm apart, which is no table: are the numbers in mm '
            'instead of cm? For so large a table give --surface, which tells')
    return ['without --surface nothing shows whether the base frame is mirrored, or the columns '
            "of the two frames exchanged: give the surface's file"]


def check_with_surface(
    pairs: PointPairs, fit: RigidFit, values: Mapping[str, Any], base_z: str
) -> List[str]:
    """
    Check the pairs against the surface that the camera points were measured with.

    :param values: The surface's parameters by full name; missing ones have their defaults.
    :param base_z: 'up' if the base frame's z points away from the table, 'down' if into it.
    :returns: Sentences about what is doubtful.
    :raises CalibrationError: If a point cannot have been seen, the base frame is mirrored, columns
        are exchanged, or the pairs lie too near each other for the size of the surface.
    """
    # The pairs lie on the surface, whatever object height the parameters set.
    values = {**SURFACE_DEFAULTS, **values}
    surface = make_surface(values)
    width, height = values['surface.image_size']
    # With a pixel around it, so that an object at the edge may be rounded.
    picture = Hull([[-1, -1], [width + 1, -1], [width + 1, height + 1], [-1, height + 1]])
    hull = make_hull(values) or picture
    _refuse_exchanged(pairs, surface, hull)
    _refuse_unseen(pairs, surface, picture)
    _refuse_mirrored(fit, surface, hull, base_z)
    return [*_precision(pairs, fit, surface, hull), *_outside(pairs, surface, hull)]


def _inside(points: np.ndarray, surface: Surface, hull: Hull) -> np.ndarray:
    """Return which points (n, 3) the surface shows within an area, shape (n,)."""
    pixels = surface.pixels(points[:, :2])
    return np.array([bool(np.isfinite(pixel).all()) and hull.contains(pixel) for pixel in pixels])


def _refuse_exchanged(pairs: PointPairs, surface: Surface, hull: Hull) -> None:
    if (_inside(pairs.base_points, surface, hull).all()
            and not _inside(pairs.camera_points, surface, hull).all()):
        raise CalibrationError(
            'the base points lie in the area that the camera was calibrated in, and the camera '
            'points do not: are the columns of the two frames exchanged?')


def _refuse_unseen(pairs: PointPairs, surface: Surface, picture: Hull) -> None:
    unseen = ~_inside(pairs.camera_points, surface, picture)
    if unseen.any():
        index = int(np.argmax(unseen))
        x, y, _ = pairs.camera_points[index]
        raise CalibrationError(
            f'row {pairs.rows[index]}: the camera point ({x:g}, {y:g}) cm lies outside of the '
            'picture: is it in mm instead of cm, are columns exchanged, or is the surface of '
            'another camera?')


def _refuse_mirrored(fit: RigidFit, surface: Surface, hull: Hull, base_z: str) -> None:
    # Up is the side of the table on which the camera is.
    up_in_camera_frame = -1.0 if _sees_y_clockwise(surface, hull) else 1.0
    up_in_base_frame = up_in_camera_frame * fit.rotation[2, 2]
    if (up_in_base_frame if base_z == 'up' else -up_in_base_frame) < -_LEVEL:
        away = 'into the table' if base_z == 'up' else 'away from the table'
        raise CalibrationError(
            f"the pairs put the base frame's z {away}, so it is mirrored: has one of the base "
            'axes the wrong sign, or are x_base_cm and y_base_cm exchanged? For a robot that '
            'hangs above the table and counts z downwards say --base-z down')


def _sees_y_clockwise(surface: Surface, hull: Hull) -> bool:
    """Return whether the camera sees y clockwise from x, in the middle of an area."""
    origin = surface.locate([hull.corners.mean(axis=0)])[0]
    start, along_x, along_y = surface.pixels(origin + [[0, 0], [1e-3, 0], [0, 1e-3]])
    (u_of_x, v_of_x), (u_of_y, v_of_y) = along_x - start, along_y - start
    return bool(u_of_x * v_of_y - v_of_x * u_of_y > 0)


def _precision(
    pairs: PointPairs, fit: RigidFit, surface: Surface, hull: Hull
) -> List[str]:
    """Warn of pairs too near each other for the area, and give the error that results."""
    freedom = max(2 * len(pairs) - 3, 1)
    deviation = max(TOUCH_ERROR_CM, np.sqrt(np.sum(fit.residuals ** 2) / freedom))
    centre = pairs.camera_points[:, :2].mean(axis=0)
    arms = np.sum((pairs.camera_points[:, :2] - centre) ** 2)
    try:
        farthest = np.linalg.norm(surface.locate(hull.corners) - centre, axis=1).max()
    except HorizonError:
        return []  # A surface without a hull, whose picture has no far end.
    error = float(deviation * np.sqrt(2 / len(pairs) + farthest ** 2 / arms))
    text = (f'the pairs lie within {spread(pairs.camera_points):.1f} cm: errors of '
            f'{10 * deviation:.1f} mm in them become {10 * error:.0f} mm at the far end of the '
            'table: spread them over the working area')
    if error > LARGEST_ERROR_CM:
        raise CalibrationError(text)
    return [text] if error > DOUBTFUL_ERROR_CM else []


def _outside(pairs: PointPairs, surface: Surface, hull: Hull) -> List[str]:
    outside = ~_inside(pairs.camera_points, surface, hull)
    rows = [str(row) for row, is_outside in zip(pairs.rows, outside) if is_outside]
    if not rows:
        return []
    return ['the camera points of these rows lie outside of the area that the surface was '
            'calibrated in, where its figures do not hold: ' + ', '.join(rows)]
