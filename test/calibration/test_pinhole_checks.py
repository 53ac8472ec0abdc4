# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Pictures that do not belong together: each is named, or the uncertainty says it."""

from camera_to_base.calibration.board_tilt import all_to_one_side, held_tilt, rough_surface
from camera_to_base.calibration.camera_error import camera_error
from camera_to_base.calibration.pinhole_checks import check_boards
from camera_to_base.calibration.pinhole_fit import fit_pinhole
from camera_to_base.errors import CalibrationError
from camera_to_base.surface import LensModel, MatchedPoints
import numpy as np
from pinhole_cell import COLUMNS, LENS, PinholeCell, ROWS, SIZE, TILTED
import pytest

NAMES = [f'flat {number}' for number in range(4)] + [f'tilted {number}' for number in range(4)]
ZOOMED = LensModel(SIZE, (1212.0, 1212.0), LENS.centre, LENS.coefficients)


@pytest.fixture
def cell():
    return PinholeCell(10, noise=0.08)


def fitted(flat, tilted):
    fit = fit_pinhole(flat, tilted, SIZE)
    return fit, check_boards(fit, NAMES)


def pixels_of(board, other):
    """Give a board's points with the pixels of another picture."""
    return MatchedPoints(board.points, other.pixels)


def mirrored(board):
    pixels = board.pixels.copy()
    pixels[:, 0] = SIZE[0] - 1 - pixels[:, 0]
    # Its corners are found in the usual order again.
    return MatchedPoints(board.points, pixels.reshape(ROWS, COLUMNS, 2)[:, ::-1].reshape(-1, 2))


def is_within(fit, cell, factor=1.0):
    """Tell whether height and foot point are as right as is said."""
    report, truth = camera_error(fit).report(fit.surface), cell.true_surface().camera_place
    off = np.linalg.norm(np.subtract(report['foot_cm'], truth.foot_cm))
    return (abs(report['height_cm'] - truth.height_cm) < factor * report['height_cm_95']
            and off < factor * report['foot_cm_95'])


def test_good_pictures_cause_no_doubt(cell):
    fit, doubts = fitted(cell.flats(), cell.tilts())
    assert doubts == [] and is_within(fit, cell, 1.5)


def test_board_that_is_bent_by_two_millimetres_is_named(cell):
    flat, tilted = cell.flats(), cell.tilts(bend_cm=0.2)
    with pytest.raises(CalibrationError, match='bent, by about .* mm .*glue'):
        fitted(flat, tilted)


def test_tilted_picture_that_moved_is_named(cell):
    flat, tilted = cell.flats(), cell.tilts()
    pixels = tilted[1].pixels.copy()
    # A rolling shutter shears what moves.
    pixels[:, 0] += 0.03 * (pixels[:, 1] - pixels[:, 1].mean())
    tilted[1] = MatchedPoints(tilted[1].points, pixels)
    with pytest.raises(CalibrationError, match='again'):
        fitted(flat, tilted)


def test_tilted_board_of_another_size_does_no_harm(cell):
    flat, tilted = cell.flats(), cell.tilts()
    tilted[1] = pixels_of(tilted[1], cell.tilted(TILTED[1], square_cm=2.0))
    fit, _ = fitted(flat, tilted)
    assert is_within(fit, cell, 1.5)


def test_flat_board_of_another_size_is_named(cell):
    flat, tilted = cell.flats(), cell.tilts()
    flat[1] = pixels_of(flat[1], cell.flat((0.55, 0.45, 8.0), square_cm=2.0))
    with pytest.raises(CalibrationError, match='flat 1 .*another board'):
        fitted(flat, tilted)


def test_mirrored_tilted_picture_is_named(cell):
    flat, tilted = cell.flats(), cell.tilts()
    tilted[2] = mirrored(tilted[2])
    with pytest.raises(CalibrationError, match='tilted 2 .*mirrored'):
        fitted(flat, tilted)


def test_all_tilted_to_one_side_is_said_and_less_exact(cell):
    flat = cell.flats()
    tilted = [cell.tilted((u, v, 4.0 * number, 30.0))
              for number, (u, v, _, _) in enumerate(TILTED)]
    fit, _ = fitted(flat, tilted)
    usual, _ = fitted(cell.flats(), cell.tilts())
    assert (camera_error(fit).report(fit.surface)['height_cm_95']
            > 1.2 * camera_error(usual).report(usual.surface)['height_cm_95'])
    surface = rough_surface(flat, SIZE)
    assert 'raise another side' in all_to_one_side(
        [held_tilt(board, surface) for board in tilted])[0]


def test_picture_at_another_zoom_is_named(cell):
    flat, tilted = cell.flats(), cell.tilts()
    tilted[1] = pixels_of(tilted[1], cell.tilted(TILTED[1], lens=ZOOMED))
    with pytest.raises(CalibrationError, match='tilted 1 .*zoom'):
        fitted(flat, tilted)


def test_zoom_between_flat_and_tilted_pictures_is_named(cell):
    with pytest.raises(CalibrationError, match='the tilted pictures have another lens'):
        fitted(cell.flats(), cell.tilts(lens=ZOOMED))


def test_intrinsics_of_another_lens_are_named_with_numbers(cell):
    wrong = LensModel(SIZE, (1100.0, 1100.0), LENS.centre, LENS.coefficients)
    tilted_camera = PinholeCell(30, noise=0.08)
    fit = fit_pinhole(tilted_camera.flats(), [], SIZE, known=wrong)
    assert 'contradict the board, by' in check_boards(fit, NAMES[:4])[0]


def test_sides_of_tilted_boards_are_told(cell):
    surface = rough_surface(cell.flats(), SIZE)
    sides = [held_tilt(board, surface).side for board in cell.tilts()]
    assert sorted(sides) == ['bottom', 'left', 'right', 'top']
