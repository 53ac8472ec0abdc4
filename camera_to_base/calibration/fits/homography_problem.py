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

"""The least-squares problem of the homography fit."""

from typing import Optional, Sequence, Tuple

from camera_to_base.calibration.fits.homography_start import OPEN, start_values
from camera_to_base.calibration.fits.motion import moved
from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.surface import (
    check_spread, divide, homogeneous, HomographySurface, ImageSize, MatchedPoints,
    RadialDistortion, undivide)
import numpy as np

# Prior of the lens, in units of half the picture's diagonal: a coefficient of 0 +- 0.3, and a
# centre within 0.03 (12 px of 640 x 480) of the picture's centre. Measured cameras have a
# coefficient of -0.18, and a centre off by 0.02 to 0.03.
EXPECTED_COEFFICIENT = 0.3
EXPECTED_CENTRE = 0.03

# Start values of the search: a lens without distortion, and strong barrel distortion.
START_COEFFICIENTS = (0.0, -0.3)

# Convergence is quadratic near the minimum: after a step this small, the rest is negligible.
SMALL_STEP = 1e-10

# A direction that changes the picture by less than this share of the strongest is undetermined.
OPEN_DIRECTION = 1e-6

# Without a few of its points a fit moves little, and Gauss-Newton steps find it: each is a small
# part of the one before, so the rest after a step of this size is negligible. Where so many steps
# do not suffice, the search does.
SMALL_STEP_NEAR, MOST_STEPS = 1e-7, 8
# Complex steps have no rounding error.
COMPLEX_STEP = 1e-30


class HomographyProblem:
    """
    The least-squares problem of the fit.

    It has eight numbers of a homography from surface to undistorted pixel, three of the lens, and
    three for each further placement of a board: its turn on the surface, and its shift. Points and
    pixels are normalised first, so that units and picture size do not matter. The homography's
    ninth number is 1: it is the depth of the first placement's centre, which lies in front of
    every camera that sees the points.

    :param placements: The points of each placement, in its own coordinates. Those of the first one
        are the camera frame's.
    :param image_size: Width and height of the picture, in px.
    """

    def __init__(self, placements: Sequence[MatchedPoints], image_size: ImageSize, *,
                 with_distortion: bool) -> None:
        self._image_size = image_size
        self._picture = RadialDistortion.of_picture(image_size)
        self._pixel_scale = _similarity(self._picture.centre, 1 / self._picture.radius)
        numbers = np.repeat(np.arange(len(placements)), [len(one) for one in placements])
        self._members = [numbers == number for number in range(len(placements))]
        first = placements[0].points
        centre = first.mean(axis=0)
        spread = np.sqrt(np.mean(np.sum((first - centre) ** 2, axis=1)))
        self._point_scale = _similarity(centre, 1 / spread)
        points = np.concatenate([one.points for one in placements])
        pixels = np.concatenate([one.pixels for one in placements])
        self.points = homogeneous(self._point_scale, points)[:, :2]
        self.pixels = homogeneous(self._pixel_scale, pixels)[:, :2]
        self._with_distortion = with_distortion
        self._expected = np.array(
            [EXPECTED_COEFFICIENT, EXPECTED_CENTRE, EXPECTED_CENTRE] if with_distortion else [])
        self._lens_end = 8 + len(self._expected)

    @property
    def has_one_placement(self) -> bool:
        """Whether no motion is fitted."""
        return len(self._members) == 1

    def solve(self) -> Tuple[np.ndarray, float]:
        """
        Return the parameters, and the noise of a pixel's coordinate.

        The weight of the lens's prior depends on the noise, and the noise is the residual of the
        fit; an iteration finds both. With points without noise, the prior has no weight.
        """
        everything = np.arange(len(self.pixels))
        parameters, noise = self._start(everything), 0.0
        freedom = max(2 * len(everything) - 9 - 3 * (len(self._members) - 1), 1)
        for _ in range(20 if self._with_distortion else 1):
            left = np.linalg.norm(self._misfit(parameters, everything))
            previous, noise = noise, left / np.sqrt(freedom)
            if abs(noise - previous) <= 1e-9 * noise:
                break
            parameters = self._refine(parameters, everything, noise)
        return parameters, noise

    def solve_for(
        self, kept: np.ndarray, parameters: np.ndarray, noise: float
    ) -> HomographySurface:
        """
        Return the surface fitted to some of the points, from a start value near it.

        :raises CalibrationError: If they do not determine it.
        """
        check_spread(MatchedPoints(self._placed(parameters, kept), self.pixels[kept]))
        return self.surface(self._refine_near(parameters, kept, noise), kept)

    def surface(self, parameters: np.ndarray, kept: np.ndarray) -> HomographySurface:
        """Return the surface in the units of the points and pixels."""
        homography = _homography(parameters)
        pixel_from_surface = np.linalg.inv(self._pixel_scale) @ homography @ self._point_scale
        placed = self._placed(parameters, kept)
        w = homogeneous(homography, placed)[:, 2]
        if w.min() * w.max() <= 0:
            raise CalibrationError('no camera can see the points at these pixels, some of them '
                                   'would lie behind it: are rows swapped, or x and y?')
        try:
            surface = HomographySurface(
                np.linalg.inv(pixel_from_surface), self._image_size, self._lens(parameters))
        except InvalidValueError:
            surface = None
        points = homogeneous(np.linalg.inv(self._point_scale), placed)[:, :2]
        if surface is None or np.isnan(surface.pixels(points)).any():
            raise CalibrationError("the horizon lies between the picture's centre and the points, "
                                   'or near them: tilt the camera down, or check the rows')
        return surface

    def placed_points(self, parameters: np.ndarray) -> np.ndarray:
        """Return all points in the camera frame, shape (n, 2), in the units of the points."""
        placed = self._placed(parameters, np.arange(len(self.points)))
        return homogeneous(np.linalg.inv(self._point_scale), placed)[:, :2]

    def _placed(self, trial: np.ndarray, kept: np.ndarray) -> np.ndarray:
        points = self.points[kept].astype(trial.dtype)
        motions = trial[self._lens_end:].reshape(-1, 3)
        for number, motion in enumerate(motions, 1):
            members = self._members[number][kept]
            points[members] = moved(points[members], motion)
        return points

    def _lens(self, parameters: np.ndarray) -> Optional[RadialDistortion]:
        if not self._with_distortion:
            return None
        centre = self._picture.centre + self._picture.radius * parameters[9:11]
        return RadialDistortion.of_picture(self._image_size, parameters[8], centre)

    def _start(self, kept: np.ndarray) -> np.ndarray:
        starts = START_COEFFICIENTS if self._with_distortion else (0.0,)
        candidates = [self._linear(coefficient, kept) for coefficient in starts]
        misfits = [np.linalg.norm(self._misfit(candidate, kept)) for candidate in candidates]
        return candidates[int(np.nanargmin(misfits))]

    def _linear(self, coefficient: float, kept: np.ndarray) -> np.ndarray:
        homography, motions = start_values(
            self.points[kept], divide(self.pixels[kept], coefficient),
            [members[kept] for members in self._members])
        lens = [coefficient, 0, 0] if self._with_distortion else []
        return np.concatenate([homography.ravel()[:8], lens, *motions])

    def _refine(self, parameters: np.ndarray, kept: np.ndarray, noise: float) -> np.ndarray:
        # Imported here, so that other users of this module do not load scipy.
        from scipy.optimize import least_squares

        found = least_squares(lambda trial: self._residuals(trial, kept, noise), parameters,
                              jac='cs', xtol=SMALL_STEP, ftol=None, gtol=None)
        self._check_strength(found.jac, kept)
        return found.x

    def _refine_near(self, parameters: np.ndarray, kept: np.ndarray, noise: float) -> np.ndarray:
        trial, residuals = parameters, self._residuals(parameters, kept, noise)
        least = np.linalg.norm(residuals)
        for _ in range(MOST_STEPS):
            jacobian = self._jacobian(trial, kept, noise)
            step = np.linalg.lstsq(jacobian, residuals, rcond=None)[0]
            trial = trial - step
            residuals = self._residuals(trial, kept, noise)
            if np.linalg.norm(step) <= SMALL_STEP_NEAR * np.linalg.norm(trial):
                if np.linalg.norm(residuals) > least:
                    break
                self._check_strength(jacobian, kept)
                return trial
        return self._refine(parameters, kept, noise)

    def _check_strength(self, jacobian: np.ndarray, kept: np.ndarray) -> None:
        geometry = np.delete(jacobian[:2 * len(kept)], np.s_[8:self._lens_end], axis=1)
        strength = np.linalg.svd(geometry, compute_uv=False)
        if strength[-1] < OPEN_DIRECTION * strength[0]:
            raise CalibrationError(OPEN)

    def _jacobian(self, trial: np.ndarray, kept: np.ndarray, noise: float) -> np.ndarray:
        steps = trial + COMPLEX_STEP * 1j * np.eye(len(trial))
        return np.stack([self._residuals(one, kept, noise).imag for one in steps],
                        axis=1) / COMPLEX_STEP

    def _residuals(self, trial: np.ndarray, kept: np.ndarray, noise: float) -> np.ndarray:
        expected = trial[8:self._lens_end] * (noise / self._expected)
        return np.concatenate([self._misfit(trial, kept), expected])

    def _misfit(self, trial: np.ndarray, kept: np.ndarray) -> np.ndarray:
        """Return the projected points of a trial minus their pixels, shape (2 n,)."""
        shown = homogeneous(_homography(trial), self._placed(trial, kept))
        shown = shown[:, :2] / shown[:, 2:]
        if self._with_distortion:
            shown = trial[9:11] + undivide(shown - trial[9:11], trial[8])
        return (shown - self.pixels[kept]).ravel()


def _homography(parameters: np.ndarray) -> np.ndarray:
    return np.append(parameters[:8], 1).reshape(3, 3)


def _similarity(centre: np.ndarray, scale: float) -> np.ndarray:
    return np.array([[scale, 0, -scale * centre[0]], [0, scale, -scale * centre[1]], [0, 0, 1]])
