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

"""Fit the homography surface to matched points."""

from dataclasses import dataclass
from typing import Optional, Sequence, Tuple

from camera_to_base.calibration.figures import leave_out
from camera_to_base.calibration.fits.homography_problem import HomographyProblem
from camera_to_base.errors import CalibrationError
from camera_to_base.surface import (
    check_inside, check_spread, HomographySurface, ImageSize, MatchedPoints)
import numpy as np

# With 8 points the coefficient costs little where the lens has no distortion (0.51 -> 0.62 mm on
# average, 0.5 px noise) and gains much where it has (2.0 -> 0.7 mm); with 6, the worst case
# without distortion is twice the homography's.
POINTS_FOR_DISTORTION = 8

# Several placements have hundreds of points. Each of at most so many fits leaves out a few of
# them, spread over all placements.
_MOST_FITS = 50


@dataclass(frozen=True)
class HomographyFit:
    """
    A fitted surface, and the surfaces fitted without each point.

    :param surface: Fitted to all points.
    :param without: n surfaces, the i-th without point i; None where the others do not suffice.
    :param points: The points in the camera frame, shape (n, 2), in cm. They are those that were
        given, except for further placements.
    """

    surface: HomographySurface
    without: Tuple[Optional[HomographySurface], ...]
    points: np.ndarray


def fit_homography(
    matched: MatchedPoints, image_size: ImageSize, further: Sequence[MatchedPoints] = ()
) -> HomographyFit:
    """
    Fit a homography, and one radial coefficient if the points determine it.

    The fit minimises the distances in the picture between the measured pixels and the projected
    points. Clicks and corners have the same error in pixels everywhere; the positions on the
    surface count as exact. The coefficient is kept if, in leave-one-out fits, it predicts the left
    out pixels better than the homography alone does.

    :param matched: The points, in the camera frame.
    :param image_size: Width and height of the picture, in px.
    :param further: Points of further placements of the board, each in the coordinates of its own
        placement: its turn and its shift on the surface are fitted, too.
    :raises InvalidValueError: If a pixel lies outside the picture.
    :raises CalibrationError: If the points do not determine a homography.
    """
    placements = [matched, *further]
    for placement in placements:
        check_inside(placement, image_size)
        check_spread(placement)
    plain = _fit_with_folds(HomographyProblem(placements, image_size, with_distortion=False))
    if sum(map(len, placements)) < POINTS_FOR_DISTORTION:
        return plain
    try:
        radial = _fit_with_folds(HomographyProblem(placements, image_size, with_distortion=True))
    except CalibrationError:
        return plain  # No plausible lens fits better.
    pixels = np.concatenate([placement.pixels for placement in placements])
    if _prediction_error(radial, pixels) < _prediction_error(plain, pixels):
        return radial
    return plain


def _prediction_error(fit: HomographyFit, pixels: np.ndarray) -> float:
    """Return the leave-one-out rms in px; infinity if one of the fits fails."""
    if None in fit.without:
        return np.inf
    predicted = [surface.pixels([point])[0] for surface, point in zip(fit.without, fit.points)]
    error = np.sqrt(np.mean(np.sum((predicted - pixels) ** 2, axis=1)))
    return error if np.isfinite(error) else np.inf


def _fit_with_folds(problem: HomographyProblem) -> HomographyFit:
    parameters, noise = problem.solve()
    count = len(problem.pixels)
    folds = leave_out(lambda kept: problem.solve_for(kept, parameters, noise), count,
                      count if problem.has_one_placement else _MOST_FITS)
    return HomographyFit(problem.surface(parameters, np.arange(count)), tuple(folds),
                         problem.placed_points(parameters))
