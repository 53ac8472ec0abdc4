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

"""A printed board: which corners a picture shows, and where they are in the camera frame."""

from typing import List, NamedTuple, Tuple

from camera_to_base.calibration.boards.board import find_board
from camera_to_base.calibration.boards.board_frame import board_points
from camera_to_base.calibration.boards.charuco import find_charuco
import numpy as np


class FoundCorners(NamedTuple):
    """
    The corners that a picture shows.

    :param numbers: Shape (n,), which of the board's corners they are.
    :param pixels: Shape (n, 2), u and v, in px.
    :param doubts: Sentences about what is doubtful.
    """

    numbers: np.ndarray
    pixels: np.ndarray
    doubts: List[str]


class PrintedBoard(NamedTuple):
    """
    A board, and where the camera frame lies on its first placement.

    :param corners: Inner corners along a row and along a column.
    :param square_mm: A square's edge.
    :param has_markers: Whether it is a ChArUco board.
    :param origin_corner: See :func:`board_points`; `origin_mm` and `yaw_deg`, too.
    """

    corners: Tuple[int, int] = (9, 6)
    square_mm: float = 25.0
    has_markers: bool = False
    origin_corner: int = 0
    origin_mm: Tuple[float, float] = (0.0, 0.0)
    yaw_deg: float = 0.0

    @property
    def text(self) -> str:
        """Describe the board, for a report."""
        kind = 'a ChArUco board' if self.has_markers else 'a chessboard'
        columns, rows = self.corners
        return f'{kind} of {columns} x {rows} inner corners, {self.square_mm:g} mm apart'

    def find(self, image: np.ndarray) -> FoundCorners:
        """
        Find the board's corners.

        :param image: Shape (h, w, 3), uint8, BGR.
        :raises CalibrationError: If there is no board; the message says why.
        """
        if self.has_markers:
            return FoundCorners(*find_charuco(image, *self.corners), [])
        board = find_board(image, *self.corners)
        doubts = ['another such board is in the picture: this is the larger one'
                  ] if board.second_board else []
        return FoundCorners(np.arange(len(board.pixels)), board.pixels, doubts)

    def first_points(self) -> np.ndarray:
        """Return all corners in cm where the first placement, which defines the frame, is."""
        return board_points(
            *self.corners, self.square_mm, origin_corner=self.origin_corner,
            origin_mm=self.origin_mm, yaw_deg=self.yaw_deg)

    def further_points(self) -> np.ndarray:
        """Return all corners in cm for any further placement, up to a shift and a turn."""
        # The origin's corner tells on which side of the surface z is.
        return board_points(*self.corners, self.square_mm, origin_corner=self.origin_corner)
