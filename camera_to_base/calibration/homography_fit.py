# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Fits the homography surface to matched points: start values, least squares, board motions."""

from dataclasses import dataclass
from typing import List, Optional, Sequence, Tuple

from camera_to_base.calibration.figures import leave_out
from camera_to_base.checks import ImageSize
from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.surface import (
    check_inside, check_spread, divide, homogeneous, HomographySurface, MatchedPoints,
    RadialDistortion, undivide)
import cv2
import numpy as np

OPEN = ('the points do not determine the surface, too many of them lie on one line: spread them '
        'over the picture')

# The homography from the first placement is poor far from it. In each round, homography and
# motions are computed from each other, with all points.
_ROUNDS = 5

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

# With 8 points the coefficient costs little where the lens has no distortion (0.51 -> 0.62 mm on
# average, 0.5 px noise) and gains much where it has (2.0 -> 0.7 mm); with 6, the worst case
# without distortion is twice the homography's.
POINTS_FOR_DISTORTION = 8

# Several placements have hundreds of points. Each of at most so many fits leaves out a few of
# them, spread over all placements.
_MOST_FITS = 50


def moved(points: np.ndarray, motion: np.ndarray) -> np.ndarray:
    """
    Turn points about the origin, and shift them.

    :param points: Shape (n, 2).
    :param motion: The angle from x towards y in rad, and the shift in x and y; complex numbers
        are allowed, for derivatives.
    :returns: Shape (n, 2).
    """
    cos, sin = np.cos(motion[0]), np.sin(motion[0])
    return points @ np.array([[cos, sin], [-sin, cos]]) + motion[1:]


def plane_motion(points: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """
    Find the motion that takes points to targets, by least squares.

    :param points: Shape (n, 2).
    :param targets: Shape (n, 2).
    :returns: Angle and shift, shape (3,), see :func:`moved`.
    """
    centre, target_centre = points.mean(axis=0), targets.mean(axis=0)
    product = (points - centre).T @ (targets - target_centre)
    angle = np.arctan2(product[0, 1] - product[1, 0], product[0, 0] + product[1, 1])
    turned = moved(centre[None], np.array([angle, 0.0, 0.0]))[0]
    return np.array([angle, *(target_centre - turned)])


def start_values(
    points: np.ndarray, pixels: np.ndarray, members: Sequence[np.ndarray]
) -> Tuple[np.ndarray, List[np.ndarray]]:
    """
    Compute a homography, and the motion of each further placement.

    :param points: Shape (n, 2), each in the coordinates of its placement.
    :param pixels: Shape (n, 2), without distortion.
    :param members: For each placement which of the points are its own, shape (n,).
    :returns: From the camera frame to pixels, shape (3, 3), and a motion each, see `moved`.
    :raises CalibrationError: If the points do not determine them.
    """
    homography = _direct(points[members[0]], pixels[members[0]])
    motions: List[np.ndarray] = []
    for _ in range(_ROUNDS if len(members) > 1 else 0):
        shown = homogeneous(np.linalg.inv(homography), pixels)
        shown = shown[:, :2] / shown[:, 2:]
        motions = [plane_motion(points[own], shown[own]) for own in members[1:]]
        placed = points.copy()
        for own, motion in zip(members[1:], motions):
            placed[own] = moved(points[own], motion)
        homography = _direct(placed, pixels)
        homography /= homography[2, 2]
    return homography, motions


def _direct(points: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    homography, _ = cv2.findHomography(points, pixels)
    if homography is None or not np.isfinite(homography).all():
        raise CalibrationError(OPEN)
    return homography


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
