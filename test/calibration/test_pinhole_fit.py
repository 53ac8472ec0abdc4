# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The fit of a pinhole camera to flat and tilted boards, against truth and against OpenCV."""

from camera_to_base.calibration.pinhole_fit import fit_pinhole
from camera_to_base.surface import LensModel, MatchedPoints
import cv2
import numpy as np
from pinhole_cell import LENS, PinholeCell, SIZE
import pytest

PICTURE = np.stack(np.meshgrid(np.linspace(0, 1279, 9), np.linspace(0, 719, 7)), -1).reshape(-1, 2)


def position_of(fit):
    """Return the camera's position, and its covariance, shape (3,) and (3, 3), in cm."""
    start = fit.problem.pose_at
    pose = fit.numbers[start:start + 6]

    def position(numbers):
        return -cv2.Rodrigues(numbers[:3].copy())[0].T @ numbers[3:]

    slopes = np.column_stack([(position(pose + step) - position(pose - step)) / 2e-6
                              for step in 1e-6 * np.eye(6)])
    covariance = fit.equations.covariance(fit.equations.variance(fit.left_out))
    return position(pose), slopes @ covariance[start:start + 6, start:start + 6] @ slopes.T


@pytest.mark.parametrize('tilt_deg', [0, 10, 30])
def test_exact_corners_recover_lens_and_place(tilt_deg):
    cell = PinholeCell(tilt_deg)
    fit, truth = fit_pinhole(cell.flats(), cell.tilts(), SIZE), cell.true_surface()
    np.testing.assert_allclose(fit.surface.position_cm, truth.position_cm, atol=0.005)
    np.testing.assert_allclose(fit.surface.lens.focal, LENS.focal, rtol=1e-4)
    np.testing.assert_allclose(fit.surface.lens.centre, LENS.centre, atol=0.05)
    np.testing.assert_allclose(
        fit.surface.locate(PICTURE), truth.locate(PICTURE), atol=0.002)


def test_derivatives_are_those_of_the_residuals():
    cell = PinholeCell(10, noise=0.1)
    fit = fit_pinhole(cell.flats(), cell.tilts(), SIZE)
    problem, numbers = fit.problem, fit.numbers
    slopes = problem.jacobian(numbers)
    for index, size in enumerate(np.abs(numbers)):
        step = np.zeros(problem.size)
        step[index] = 1e-6 * max(size, 1e-2)
        found = (problem.residuals(numbers + step) - problem.residuals(numbers - step)) / (
            2 * step[index])
        np.testing.assert_allclose(
            slopes[:, index], found, atol=1e-5 * max(np.abs(found).max(), 1e-3))


@pytest.mark.parametrize('tilt_deg', [0, 30])
def test_opencv_gives_the_same_pose_within_the_uncertainty(tilt_deg):
    cell = PinholeCell(tilt_deg, noise=0.1, seed=3)
    flat, tilted = cell.flats(), cell.tilts()
    position, covariance = position_of(fit_pinhole(flat, tilted, SIZE))
    boards = [*flat, *tilted]
    points = [np.column_stack([board.points, np.zeros(len(board))]).astype(np.float32)
              for board in boards]
    guess = np.array([[1280.0, 0, 639.5], [0, 1280, 359.5], [0, 0, 1]])
    _, matrix, _, rotations, shifts = cv2.calibrateCamera(
        points, [board.pixels.astype(np.float32) for board in boards], SIZE, guess, np.zeros(5),
        flags=cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_ASPECT_RATIO | cv2.CALIB_FIX_K3)
    opencv = (-cv2.Rodrigues(rotations[0])[0].T @ shifts[0]).ravel()
    # OpenCV does not know that the flat placements lie in one plane: it is less exact.
    off = np.abs(opencv - position) / np.sqrt(np.diag(covariance))
    assert (off < 8).all()
    assert abs(opencv[2] - position[2]) < 0.01 * abs(position[2])
    assert np.linalg.norm(opencv[:2] - position[:2]) < 1.0


def test_uncertainty_of_the_place_holds():
    squares = []
    for seed in range(12):
        cell = PinholeCell(10, noise=0.15, seed=seed)
        position, covariance = position_of(fit_pinhole(cell.flats(), cell.tilts(), SIZE))
        error = position - cell.true_surface().position_cm
        squares.append(error @ np.linalg.solve(covariance, error))
    # The mean of a chi-squared variable of three degrees of freedom is 3, of twelve 1.7 to 4.6.
    assert 1.0 < np.mean(squares) < 6.0


def test_errors_that_are_alike_are_not_taken_for_many_independent_ones():
    squares = []
    for seed in range(8):
        cell, rng = PinholeCell(10, noise=0.05, seed=seed), np.random.default_rng(seed)

        def disturbed(board):
            # As by local errors of a lens: smooth over a board.
            x, y = ((board.points - board.points.mean(axis=0)) / np.ptp(board.points, axis=0)).T
            shapes = np.column_stack([x * x, x * y, y * y, x ** 3, y ** 3])
            return MatchedPoints(board.points, board.pixels + shapes @ rng.normal(0, 0.5, (5, 2)))

        position, covariance = position_of(fit_pinhole(
            [disturbed(board) for board in cell.flats()],
            [disturbed(board) for board in cell.tilts()], SIZE))
        error = position - cell.true_surface().position_cm
        squares.append(error @ np.linalg.solve(covariance, error))
    # Three degrees of freedom. As independent errors they are 83: what is like a move of a board
    # cannot be told.
    assert np.mean(squares) < 25.0


@pytest.mark.parametrize('seed', [1, 2])
def test_board_whose_print_is_not_exact_does_little_harm(seed):
    cell, off = PinholeCell(0, noise=0.03, seed=seed), np.random.default_rng(seed).normal(
        0, 0.01, (54, 2))
    flat, tilted = ([MatchedPoints(board.points + off, board.pixels) for board in boards]
                    for boards in (cell.flats(), cell.tilts()))
    fit = fit_pinhole(flat, tilted, SIZE)
    # With the corners held where they should be, it is 0.15 and 0.31 cm.
    error = fit.surface.position_cm - cell.true_surface().position_cm
    assert np.linalg.norm(error) < 0.09
    assert np.sqrt(fit.equations.variance(fit.left_out)) < 0.05


def test_flat_placements_are_enough_with_a_known_lens():
    cell = PinholeCell(0, noise=0.1)
    fit = fit_pinhole(cell.flats(), [], SIZE, known=LENS)
    np.testing.assert_allclose(
        fit.surface.position_cm, cell.true_surface().position_cm, atol=0.15)


def test_known_fisheye_lens_is_used_as_it_is():
    fisheye = LensModel(SIZE, (500.0, 505.0), (645.0, 355.0), (0.02, -0.01, 0.0, 0.0),
                        'equidistant')
    cell = PinholeCell(20, lens=fisheye)
    fit = fit_pinhole(cell.flats(), [], SIZE, known=fisheye)
    np.testing.assert_allclose(
        fit.surface.position_cm, cell.true_surface().position_cm, atol=1e-3)


def test_single_bad_corner_does_not_count():
    cell = PinholeCell(10, noise=0.1)
    flat, tilted = cell.flats(), cell.tilts()
    pixels = tilted[1].pixels.copy()
    pixels[20] += 4.0, -3.0
    tilted[1] = MatchedPoints(tilted[1].points, pixels)
    fit = fit_pinhole(flat, tilted, SIZE)
    assert np.flatnonzero(~fit.kept_of(5)).tolist() == [20]
    np.testing.assert_allclose(
        fit.surface.position_cm, cell.true_surface().position_cm, atol=0.6)


def test_lens_without_distortion_needs_no_coefficients():
    cell = PinholeCell(10, lens=LensModel(SIZE, (1010.0, 1010.0), (651.0, 352.0)), noise=0.1)
    fit = fit_pinhole(cell.flats(), cell.tilts(), SIZE)
    assert np.abs(fit.surface.lens.coefficients or (0.0,)).max() < 0.02
