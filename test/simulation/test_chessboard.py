# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.


from camera_to_base.calibration.boards.board import board_points, find_board
from camera_to_base.errors import InvalidValueError
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.simulation.printed import SimulatedChessboard
import numpy as np
import pytest


@pytest.mark.parametrize('tilt_deg', [0, 30, 55])
@pytest.mark.parametrize('columns, rows', [(9, 6), (7, 5)])
def test_corners_are_where_the_simulated_boards_camera_sees_them(tilt_deg, columns, rows):
    chessboard = SimulatedChessboard(columns, rows, 2.5, tilt_deg=tilt_deg)
    pixels = find_board(chessboard.read(), columns, rows).pixels
    points = board_points(columns, rows, 25) + chessboard.first_corner
    projected = np.column_stack([points, np.ones(len(points))]) @ SimulatedBoard(
        tilt_deg=tilt_deg).pixel_from_surface.T
    np.testing.assert_allclose(pixels, projected[:, :2] / projected[:, 2:], atol=0.2)


def test_frames_differ_by_noise_and_the_seed_makes_it():
    one, other = (SimulatedChessboard(9, 6, 2.5, seed=7) for _ in range(2))
    first, second = one.read(), one.read()
    assert 1 < np.std(first.astype(float) - second) < 4
    np.testing.assert_array_equal(first, other.read())


def test_board_without_squares_is_refused():
    with pytest.raises(InvalidValueError, match='square_cm'):
        SimulatedChessboard(9, 6, 0)
