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
from typing import Optional, Tuple

from camera_to_base.calibration.figures import leave_one_out
from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.surface import (
    check_inside, check_spread, divide, homogeneous, HomographySurface, ImageSize, MatchedPoints,
    RadialDistortion, undivide)
import cv2
import numpy as np

# With 8 points the coefficient costs little where the lens has no distortion (0.51 -> 0.62 mm on
# average, 0.5 px noise) and gains much where it has (2.0 -> 0.7 mm); with 6, the worst case
# without distortion is twice the homography's.
POINTS_FOR_DISTORTION = 8

# Prior of the lens, in units of half the picture's diagonal: a coefficient of 0 +- 0.3, and a
# centre within 0.03 (12 px of 640 x 480) of the picture's centre. Measured cameras have a
# coefficient of -0.18, and a centre off by 0.02 to 0.03.
EXPECTED_COEFFICIENT = 0.3
EXPECTED_CENTRE = 0.03

# Start values of the search: a lens without distortion, and strong barrel distortion.
START_COEFFICIENTS = (0.0, -0.3)

# Convergence is quadratic near the minimum: after a step this small, the rest is negligible.
SMALL_STEP = 1e-10

_OPEN = ('the points do not determine the surface, too many of them lie on one line: spread them '
         'over the picture')

# A direction that changes the picture by less than this share of the strongest is undetermined.
OPEN_DIRECTION = 1e-6


@dataclass(frozen=True)
class HomographyFit:
    """
    A fitted surface, and the surfaces fitted without each point.

    :param surface: Fitted to all points.
    :param without: n surfaces, the i-th without point i; None where the others do not suffice.
    """

    surface: HomographySurface
    without: Tuple[Optional[HomographySurface], ...]


def fit_homography(matched: MatchedPoints, image_size: ImageSize) -> HomographyFit:
    """
    Fit a homography, and one radial coefficient if the points determine it.

    The fit minimises the distances in the picture between the measured pixels and the projected
    points. Clicks and corners have the same error in pixels everywhere; the positions on the
    surface count as exact. The coefficient is kept if, in leave-one-out fits, it predicts the left
    out pixels better than the homography alone does.

    :param image_size: Width and height of the picture, in px.
    :raises InvalidValueError: If a pixel lies outside the picture.
    :raises CalibrationError: If the points do not determine a homography.
    """
    check_inside(matched, image_size)
    check_spread(matched)
    plain = _fit_with_folds(_Problem(matched, image_size, with_distortion=False))
    if len(matched) < POINTS_FOR_DISTORTION:
        return plain
    try:
        radial = _fit_with_folds(_Problem(matched, image_size, with_distortion=True))
    except CalibrationError:
        return plain  # No plausible lens fits better.
    if _prediction_error(radial, matched) < _prediction_error(plain, matched):
        return radial
    return plain


def _prediction_error(fit, matched):
    """Return the leave-one-out rms in px; infinity if one of the fits fails."""
    if None in fit.without:
        return np.inf
    predicted = [surface.pixels([point])[0]
                 for surface, point in zip(fit.without, matched.points)]
    error = np.sqrt(np.mean(np.sum((predicted - matched.pixels) ** 2, axis=1)))
    return error if np.isfinite(error) else np.inf


def _fit_with_folds(problem):
    parameters, noise = problem.solve()
    everything = np.arange(len(problem.pixels))
    folds = leave_one_out(lambda kept: problem.solve_for(kept, parameters, noise), len(everything))
    return HomographyFit(problem.surface(parameters, everything), tuple(folds))


class _Problem:
    """
    The least-squares problem of the fit.

    It has eight numbers of a homography from surface to undistorted pixel, and three of the lens.
    Points and pixels are normalised first, so that units and picture size do not matter. The
    homography's ninth number is 1: it is the depth of the points' centre, which lies in front of
    every camera that sees the points.
    """

    def __init__(self, matched, image_size, *, with_distortion):
        self._image_size = image_size
        self._picture = RadialDistortion.of_picture(image_size)
        self._pixel_scale = _similarity(self._picture.centre, 1 / self._picture.radius)
        centre = matched.points.mean(axis=0)
        spread = np.sqrt(np.mean(np.sum((matched.points - centre) ** 2, axis=1)))
        self._point_scale = _similarity(centre, 1 / spread)
        self.points = homogeneous(self._point_scale, matched.points)[:, :2]
        self.pixels = homogeneous(self._pixel_scale, matched.pixels)[:, :2]
        self._with_distortion = with_distortion
        self._expected = np.array(
            [EXPECTED_COEFFICIENT, EXPECTED_CENTRE, EXPECTED_CENTRE] if with_distortion else [])

    def solve(self):
        """
        Return the parameters, and the noise of a pixel's coordinate.

        The weight of the lens's prior depends on the noise, and the noise is the residual of the
        fit; an iteration finds both. With points without noise, the prior has no weight.
        """
        everything = np.arange(len(self.pixels))
        parameters, noise = self._start(everything), 0.0
        freedom = max(2 * len(everything) - 9, 1)
        for _ in range(20 if self._with_distortion else 1):
            left = np.linalg.norm(self._misfit(parameters, everything))
            previous, noise = noise, left / np.sqrt(freedom)
            if abs(noise - previous) <= 1e-9 * noise:
                break
            parameters = self._refine(parameters, everything, noise)
        return parameters, noise

    def solve_for(self, kept, parameters, noise):
        """
        Return the surface fitted to some of the points, from a start value near it.

        :raises CalibrationError: If they do not determine it.
        """
        check_spread(MatchedPoints(self.points[kept], self.pixels[kept]))
        return self.surface(self._refine(parameters, kept, noise), kept)

    def surface(self, parameters, kept):
        """Return the surface in the units of the points and pixels."""
        homography = _homography(parameters)
        pixel_from_surface = np.linalg.inv(self._pixel_scale) @ homography @ self._point_scale
        w = homogeneous(homography, self.points[kept])[:, 2]
        if w.min() * w.max() <= 0:
            raise CalibrationError('no camera can see the points at these pixels, some of them '
                                   'would lie behind it: are rows swapped, or x and y?')
        try:
            surface = HomographySurface(
                np.linalg.inv(pixel_from_surface), self._image_size, self._lens(parameters))
        except InvalidValueError:
            surface = None
        points = homogeneous(np.linalg.inv(self._point_scale), self.points[kept])[:, :2]
        if surface is None or np.isnan(surface.pixels(points)).any():
            raise CalibrationError("the horizon lies between the picture's centre and the points, "
                                   'or near them: tilt the camera down, or check the rows')
        return surface

    def _lens(self, parameters):
        if not self._with_distortion:
            return None
        centre = self._picture.centre + self._picture.radius * parameters[9:11]
        return RadialDistortion.of_picture(self._image_size, parameters[8], centre)

    def _start(self, kept):
        starts = START_COEFFICIENTS if self._with_distortion else (0.0,)
        candidates = [self._linear(coefficient, kept) for coefficient in starts]
        misfits = [np.linalg.norm(self._misfit(candidate, kept)) for candidate in candidates]
        return candidates[int(np.nanargmin(misfits))]

    def _linear(self, coefficient, kept):
        undistorted = divide(self.pixels[kept], coefficient)
        homography, _ = cv2.findHomography(self.points[kept], undistorted)
        if homography is None or not np.isfinite(homography).all():
            raise CalibrationError(_OPEN)
        lens = [coefficient, 0, 0] if self._with_distortion else []
        return np.append(homography.ravel()[:8], lens)

    def _refine(self, parameters, kept, noise):
        # Imported here, so that other users of this module do not load scipy.
        from scipy.optimize import least_squares

        def residuals(trial):
            expected = trial[8:] * (noise / self._expected)
            return np.concatenate([self._misfit(trial, kept), expected])

        found = least_squares(residuals, parameters, jac='cs', xtol=SMALL_STEP, ftol=None,
                              gtol=None)
        strength = np.linalg.svd(found.jac[:2 * len(kept), :8], compute_uv=False)
        if strength[-1] < OPEN_DIRECTION * strength[0]:
            raise CalibrationError(_OPEN)
        return found.x

    def _misfit(self, trial, kept):
        """Return the projected points of a trial minus their pixels, shape (2 n,)."""
        shown = homogeneous(_homography(trial), self.points[kept])
        shown = shown[:, :2] / shown[:, 2:]
        if self._with_distortion:
            shown = trial[9:11] + undivide(shown - trial[9:11], trial[8])
        return (shown - self.pixels[kept]).ravel()


def _homography(parameters):
    return np.append(parameters[:8], 1).reshape(3, 3)


def _similarity(centre, scale):
    return np.array([[scale, 0, -scale * centre[0]], [0, scale, -scale * centre[1]], [0, 0, 1]])
