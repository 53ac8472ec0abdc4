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

"""Places the camera frame on a chessboard."""

from typing import Sequence

from camera_to_base.checks import finite_number, finite_numbers, whole_number
import numpy as np

# For each corner that can be the origin: whether x and y start at the far end.
ORIGIN_CORNERS = {
    0: (False, False),
    1: (True, False),
    2: (True, True),
    3: (False, True),
}


def board_points(columns: int, rows: int, square_mm: float, *, origin_corner: int = 0,
                 origin_mm: Sequence[float] = (0.0, 0.0), yaw_deg: float = 0.0) -> np.ndarray:
    """
    Return the positions of a `Board`'s corners in the camera frame.

    x runs along the board's rows and y along its columns, from the corner that is the origin into
    the board. From corners 0 and 2 the camera sees y a quarter turn clockwise from x, and z points
    into the surface, as with the parallel camera; from 1 and 3 it points towards the camera.

    :param origin_corner: 0 for the board's first corner, then 1 to 3 clockwise as the camera sees
        them: the other end of the first row, the opposite corner, the other end of the first
        column.
    :param origin_mm: x and y of the camera frame's origin, measured from that corner along the
        board, in mm.
    :param yaw_deg: The angle from the board's x to the camera frame's, towards the board's y.
    :returns: Shape (rows * columns, 2), columns x and y, in cm, in the order of `Board.pixels`.
    :raises InvalidValueError: If a value is not finite, the square is not positive, or there is no
        such corner.
    """
    square_mm = finite_number('square_mm', square_mm, 0.01, 1e5)
    origin_mm = finite_numbers('origin_mm', origin_mm, 2)
    yaw = np.radians(finite_number('yaw_deg', yaw_deg, -360, 360))
    row, column = np.mgrid[:rows, :columns].astype(float)
    from_far_x, from_far_y = ORIGIN_CORNERS[whole_number('origin_corner', origin_corner, 0, 3)]
    x = columns - 1 - column if from_far_x else column
    y = rows - 1 - row if from_far_y else row
    board_mm = square_mm * np.stack([x.ravel(), y.ravel()], axis=1) - origin_mm
    frame_from_board = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    return board_mm @ frame_from_board.T / 10
