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

"""Checks whether the points of a surface fit are plausible measurements."""

from typing import List, Optional, Sequence

from camera_to_base.calibration.checks.outliers import find_outlier
from camera_to_base.calibration.figures import MM_PER_CM, surface_errors
from camera_to_base.errors import CalibrationError, HorizonError
from camera_to_base.surface import HomographySurface, Hull, ImageSize, MatchedPoints, Surface
import numpy as np

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
