# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Fits a pinhole camera to a board that lies on the table and is held at a tilt."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import List, Optional, Sequence, Tuple

from camera_to_base.calibration.homography_fit import start_values
from camera_to_base.calibration.pinhole_error import BoardError, PinholeEquations
from camera_to_base.calibration.pinhole_problem import (
    expected_px, LENS_NUMBERS, lens_of, PinholeProblem)
from camera_to_base.checks import ImageSize
from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.surface import (
    check_inside, check_spread, LensModel, MatchedPoints, PinholeSurface)
import cv2
import numpy as np

# The sets of coefficients of k1 k2 p1 p2 k3 that are tried.
CANDIDATES = ((), (0,), (0, 1), (0, 1, 2, 3), (0, 1, 2, 3, 4))
# Focal lengths that the search starts from, in widths of the picture.
_START_FOCAL = (0.6, 1.0, 2.0)
# A corner is a bad one if it is off by so many robust standard deviations, and usual errors.
_BAD_DEVIATIONS, _BAD_EXPECTED, _ROUNDS = 6.0, 5.0, 3
# A simpler lens may predict left-out boards worse by this factor of the squared error.
_SIMPLER = 1.02
# How often the print's exactness is estimated anew.
_PRINT_ROUNDS = 2
# Of a picture's corners; more are no single bad ones.
_MOST_BAD = 0.1
# Median length of a vector of two normal numbers.
_MEDIAN_LENGTH = 1.1774
NO_CAMERA = ('no camera sees the board at these pixels: are the pictures of one camera, at one '
             'zoom and focus, and of one board?')


@dataclass(frozen=True)
class PinholeFit:
    """
    A fitted camera.

    :param problem: What was fitted.
    :param numbers: The solution.
    :param kept: Shape (n,), which of all boards' corners count; the others are bad ones.
    :param richest: The fit with all coefficients; None if this is it, or the lens is known.
    """

    problem: PinholeProblem
    numbers: np.ndarray
    kept: np.ndarray
    richest: Optional['PinholeFit'] = None

    @cached_property
    def surface(self) -> PinholeSurface:
        """The camera over the surface."""
        return self.problem.surface(self.numbers)

    @cached_property
    def equations(self) -> PinholeEquations:
        """The linear equations at the solution."""
        return PinholeEquations(self.problem, self.numbers, self.kept)

    @cached_property
    def left_out(self) -> List[BoardError]:
        """What each board says that the fit has not seen."""
        return self.equations.left_out()

    @cached_property
    def residuals(self) -> List[np.ndarray]:
        """Shown minus measured pixels of each board, shape (n, 2) each, the bad ones included."""
        residuals = self.problem.residuals(self.numbers)
        return [residuals[rows].reshape(-1, 2) for rows in self.problem.rows]

    def kept_of(self, board: int) -> np.ndarray:
        """Return which of a board's corners count, shape (n,)."""
        rows = self.problem.rows[board]
        return self.kept[rows.start // 2:rows.stop // 2]

    @property
    def placed(self) -> List[np.ndarray]:
        """Where each flat placement's points lie in the camera frame, shape (n, 2) each, in cm."""
        return [self.problem.placed(self.numbers, board)
                for board in range(self.problem.flat_count)]


def fit_pinhole(
    flat: Sequence[MatchedPoints], tilted: Sequence[MatchedPoints], image_size: ImageSize,
    known: Optional[LensModel] = None, corners: Optional[Sequence[np.ndarray]] = None,
) -> PinholeFit:
    """
    Fit the lens and the pose of the camera.

    The fit minimises the distances in the picture between the measured and the projected corners.
    All flat placements lie in one plane. Of the coefficients k1 k2 p1 p2 k3 those are fitted that
    left-out boards want. Single bad corners are left out. No print is perfect: where each corner
    truly is on the board is fitted, too, as with object-releasing methods (Strobl and Hirzinger,
    ICCV workshops 2011).

    :param flat: The points of each flat placement, in its own coordinates; those of the first one
        are the camera frame's.
    :param tilted: The points of each board that is held at a tilt.
    :param known: The lens, if it is known: then flat placements are enough.
    :param corners: Which of the board's corners the points of each board are, shape (n,) each, the
        flat ones first; may be left out where each board shows all.
    :raises InvalidValueError: If a pixel lies outside the picture.
    :raises CalibrationError: If no camera sees the points so.
    """
    for board in (*flat, *tilted):
        check_inside(board, image_size)
        check_spread(board)
    try:
        boards = [*flat, *tilted]
        if corners is None and len({len(board) for board in boards}) == 1:
            corners = [np.arange(len(board)) for board in boards]
        if known is not None:
            return _printed(PinholeProblem(flat, tilted, image_size, (), known), known, corners)
        lens = _start_lens(boards, image_size)
        exact = [_solved(PinholeProblem(flat, tilted, image_size, free), lens)
                 for free in CANDIDATES]
        squares = np.array([_prediction_square(fit) for fit in exact])
        # Beyond the boards, a coefficient that is not needed does harm.
        chosen = exact[int(np.argmax(squares < _SIMPLER * squares.min()))]
        best, richest = (_printed(one.problem, one.surface.lens, corners)
                         for one in (chosen, exact[-1]))
        return replace(best, richest=richest if chosen is not exact[-1] else None)
    except (cv2.error, np.linalg.LinAlgError, InvalidValueError) as error:
        raise CalibrationError(NO_CAMERA) from error


def _printed(
    problem: PinholeProblem, lens: LensModel, corners: Optional[Sequence[np.ndarray]]
) -> PinholeFit:
    """Fit where the corners truly are on the board, too, and how exact the print is."""
    fit = _solved(problem.with_corners(corners), lens)
    for _ in range(_PRINT_ROUNDS if corners is not None else 0):
        covariance = fit.equations.covariance(fit.equations.variance(fit.left_out))
        fit = _solved(problem.with_corners(
            corners, fit.problem.printed_cm(fit.numbers, covariance)), lens, fit.numbers)
    return fit


def _prediction_square(fit: PinholeFit) -> float:
    freedom = [part.freedom for part in fit.equations.parts]
    return float(np.average([one.rms_px ** 2 for one in fit.left_out], weights=freedom))


def _start_lens(boards: Sequence[MatchedPoints], image_size: ImageSize) -> LensModel:
    """Find a lens with one coefficient, and the picture's centre."""
    points = [_on_board(board).astype(np.float32) for board in boards]
    pixels = [board.pixels.astype(np.float32) for board in boards]
    flags = (cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_ASPECT_RATIO
             | cv2.CALIB_FIX_PRINCIPAL_POINT | cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K2
             | cv2.CALIB_FIX_K3)
    width, height = image_size
    found = []
    for share in _START_FOCAL:
        guess = np.array([[share * width, 0, (width - 1) / 2],
                          [0, share * width, (height - 1) / 2], [0, 0, 1]])
        try:
            found.append(cv2.calibrateCamera(
                points, pixels, tuple(image_size), guess, np.zeros(5), flags=flags)[:3])
        except cv2.error:
            continue
    found = [one for one in found if np.isfinite(one[0])]
    if not found:
        raise CalibrationError(NO_CAMERA)
    _, matrix, coefficients = min(found, key=lambda one: one[0])
    numbers = np.zeros(LENS_NUMBERS)
    numbers[:3] = np.log(matrix[0, 0]), *matrix[:2, 2]
    numbers[3] = np.clip(np.ravel(coefficients)[0], -1.0, 1.0)
    return lens_of(numbers, image_size)


def _solved(
    problem: PinholeProblem, start: LensModel, numbers: Optional[np.ndarray] = None
) -> PinholeFit:
    kept = np.ones(sum(map(len, problem.boards)), bool)
    if numbers is None:
        numbers = _start_numbers(problem, start)
    numbers = _least_squares(problem, numbers, kept, is_robust=True)
    for _ in range(_ROUNDS):
        errors = np.linalg.norm(problem.residuals(numbers).reshape(-1, 2), axis=1)
        limit = max(_BAD_DEVIATIONS * float(np.median(errors[kept])) / _MEDIAN_LENGTH,
                    _BAD_EXPECTED * expected_px(problem.image_size))
        previous, kept = kept, _single(errors > limit, problem)
        numbers = _least_squares(problem, numbers, kept)
        if np.array_equal(previous, kept):
            break
    return PinholeFit(problem, numbers, kept)


def _single(bad: np.ndarray, problem: PinholeProblem) -> np.ndarray:
    """Return which corners count: all but single bad ones; many make a picture a bad one."""
    kept = ~bad
    for rows in problem.rows:
        own = slice(rows.start // 2, rows.stop // 2)
        if bad[own].mean() > _MOST_BAD:
            kept[own] = True
    return kept


def _least_squares(
    problem: PinholeProblem, start: np.ndarray, kept: np.ndarray, is_robust: bool = False
) -> np.ndarray:
    # Imported here, so that other users of this module do not load scipy.
    from scipy.optimize import least_squares

    expected, deviations = problem.prior()
    unit = expected_px(problem.image_size)
    with_prior = np.flatnonzero(np.isfinite(deviations))
    rows = np.repeat(kept, 2)
    prior_rows = np.zeros((len(with_prior), problem.size))
    prior_rows[np.arange(len(with_prior)), with_prior] = unit / deviations[with_prior]

    def residuals(numbers: np.ndarray) -> np.ndarray:
        off = (numbers - expected)[with_prior] * unit / deviations[with_prior]
        return np.nan_to_num(
            np.concatenate([problem.residuals(numbers)[rows], off]), nan=1e6, posinf=1e6)

    def jacobian(numbers: np.ndarray) -> np.ndarray:
        return np.vstack([problem.jacobian(numbers)[rows], prior_rows])

    return least_squares(
        residuals, start, jac=jacobian, x_scale='jac', loss='soft_l1' if is_robust else 'linear',
        f_scale=_BAD_EXPECTED * unit, xtol=1e-10, ftol=1e-10, gtol=None, max_nfev=100).x


def _start_numbers(problem: PinholeProblem, lens: LensModel) -> np.ndarray:
    """Compute where the boards are for a lens that is about right."""
    boards = problem.boards
    flat, tilted = boards[:problem.flat_count], boards[problem.flat_count:]
    straight = np.concatenate([lens.undistort(board.pixels) for board in flat])
    if not np.isfinite(straight).all():
        raise CalibrationError(NO_CAMERA)
    owners = np.repeat(np.arange(len(flat)), [len(board) for board in flat])
    homography, motions = start_values(
        np.concatenate([board.points for board in flat]), straight,
        [owners == number for number in range(len(flat))])
    table = _pose_of_homography(np.linalg.solve(lens.matrix, homography))
    start = np.concatenate([
        table, np.zeros(problem.shared.stop - problem.camera.stop), *motions,
        *(_pose_of_board(board, lens) for board in tilted)])
    numbers = np.zeros(LENS_NUMBERS)
    numbers[:3] = np.log(lens.focal[0]), *lens.centre
    numbers[3:] = lens.coefficients if lens is not problem.known and lens.coefficients else 0.0
    return np.concatenate([numbers[problem.free_lens], start])


def _pose_of_homography(homography: np.ndarray) -> np.ndarray:
    scale = np.sqrt(np.linalg.norm(homography[:, 0]) * np.linalg.norm(homography[:, 1]))
    first, second, shift = (homography / (scale if homography[2, 2] > 0 else -scale)).T
    left, _, right = np.linalg.svd(np.column_stack([first, second, np.cross(first, second)]))
    return np.concatenate([cv2.Rodrigues(left @ right)[0].ravel(), shift])


def _pose_of_board(board: MatchedPoints, lens: LensModel) -> np.ndarray:
    straight = lens.undistort(board.pixels)
    if not np.isfinite(straight).all():
        raise CalibrationError(NO_CAMERA)
    view = _on_board(board), straight, lens.matrix, np.zeros(4)
    poses: List[Tuple[float, np.ndarray]] = []
    _, rotations, shifts, _ = cv2.solvePnPGeneric(*view, flags=cv2.SOLVEPNP_IPPE)
    _, *other = cv2.solvePnP(*view, flags=cv2.SOLVEPNP_ITERATIVE)
    for rotation, shift in (*zip(rotations, shifts), other):
        if not (np.isfinite(rotation).all() and np.isfinite(shift).all()):
            continue
        rotation, shift = cv2.solvePnPRefineLM(*view, rotation, shift)
        shown, _ = cv2.projectPoints(view[0], rotation, shift, *view[2:])
        error = float(np.linalg.norm(shown[:, 0] - straight))
        poses.append((error, np.concatenate([rotation.ravel(), shift.ravel()])))
    poses = [one for one in poses if np.isfinite(one[0])]
    if not poses:
        raise CalibrationError(NO_CAMERA)
    return min(poses, key=lambda one: one[0])[1]


def _on_board(board: MatchedPoints) -> np.ndarray:
    return np.column_stack([board.points, np.zeros(len(board))])
