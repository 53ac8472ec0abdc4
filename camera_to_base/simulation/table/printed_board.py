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

"""A chessboard on paper that lies on the simulated table."""

from typing import NamedTuple, Tuple

from camera_to_base.simulation.view import BoardView
import numpy as np

_PAPER_COLOUR = np.array([225.0, 225.0, 225.0])
_INK_COLOUR = np.array([35.0, 35.0, 35.0])
# Towards which side of the picture the board lies, and its turn in degrees: the middle, the
# corners, and turned ones.
_PLACEMENTS = (((0, 0), 0.0), ((-1, -1), 0.0), ((1, 1), 0.0), ((-1, 1), 0.0), ((1, -1), 0.0),
               ((-1, 0), 8.0), ((1, 0), -8.0), ((0, -1), 4.0))


class RenderedBoard(NamedTuple):
    """
    A chessboard; its dark end is on the left, so that its first corner is the top left one.

    :param columns: Inner corners along a row.
    :param rows: Inner corners along a column.
    :param square_cm: Edge of a square, in cm.
    :param middle: Where its middle is, x and y, in cm.
    :param yaw: Its turn from x towards y, in rad.
    """

    columns: int
    rows: int
    square_cm: float
    middle: Tuple[float, float]
    yaw: float = 0.0

    @property
    def half_cm(self) -> np.ndarray:
        """Half of the distances between the outermost inner corners, along both edges, in cm."""
        return self.square_cm * np.array([self.columns - 1, self.rows - 1]) / 2

    def paint(self, picture: np.ndarray, view: BoardView) -> np.ndarray:
        """
        Lay the board into a picture of the table.

        :param picture: Shape (h, w, 3) or (3,).
        :returns: Shape (h, w, 3), BGR.
        """
        points = view.points(slice(0, view.height), slice(0, view.width)) - self.middle
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        x, y = np.moveaxis(
            (points @ [[cos, -sin], [sin, cos]] + self.half_cm) / self.square_cm, 2, 0)
        paper = (x > -2) & (x < self.columns + 1) & (y > -2) & (y < self.rows + 1)
        inked = (x > -1) & (x < self.columns) & (y > -1) & (y < self.rows)
        darkness = np.where(inked, 0.5 + 0.5 * _stripes(x) * _stripes(y), 0.0)[:, :, None]
        board = _PAPER_COLOUR + darkness * (_INK_COLOUR - _PAPER_COLOUR)
        return np.where(paper[:, :, None], board, picture)

    def inked_corners(self, margin: float) -> np.ndarray:
        """
        Return the corners of the printed squares, and of a margin around them.

        :param margin: In squares.
        :returns: Shape (4, 2), x and y, in cm.
        """
        half = self.half_cm + self.square_cm * (1 + margin)
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        corners = half * [[-1, -1], [1, -1], [1, 1], [-1, 1]]
        return corners @ [[cos, sin], [-sin, cos]] + self.middle


def placed_board(
    columns: int, rows: int, square_cm: float, view: BoardView, placement: int
) -> RenderedBoard:
    """
    Lay a board as far towards a side of the picture as the whole of it is seen.

    :param view: The camera's; the board stays where it is if the camera is moved later.
    :param placement: From 1, see `simulated.placement`.
    """
    side, yaw_deg = _PLACEMENTS[placement - 1]
    size = np.array([view.width, view.height])
    for share in np.arange(1.0, 0.0, -0.02):
        middle = view.point(size / 2 * (1 + share * np.array(side)))
        board = RenderedBoard(columns, rows, square_cm, middle, np.radians(yaw_deg))
        corners = view.pixels(board.inked_corners(margin=0.4))
        if (corners > 0).all() and (corners < size - 1).all():
            return board
    return board


def _stripes(position: np.ndarray) -> np.ndarray:
    # 1 from 0 to 1, -1 from 1 to 2, and so on; over an edge it changes along one pixel's width.
    sign = np.where(np.floor(position) % 2 == 0, 1.0, -1.0)
    to_edge = 0.5 - np.abs(position % 1 - 0.5)
    slope = np.hypot(*np.gradient(position)) if min(position.shape) > 1 else 1.0
    return sign * np.clip(2 * to_edge / np.maximum(slope, 1e-9), 0, 1)
