# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Paper on the simulated table: a chessboard to calibrate with, and four markers."""

from typing import Dict, NamedTuple, Tuple

from camera_to_base.checks import DEFAULT_IMAGE_SIZE, finite_number, ImageSize, whole_number
from camera_to_base.coordinate_transform import TUTORIAL_WIDTH_CM
from camera_to_base.markers import CELLS, marker_cells
from camera_to_base.simulation.view import BoardView
from camera_to_base.sources import SIMULATED
import cv2
import numpy as np

_PAPER_COLOUR = np.array([225.0, 225.0, 225.0])
_INK_COLOUR = np.array([35.0, 35.0, 35.0])
# Towards which side of the picture the board lies, and its turn in degrees: the middle, the
# corners, and turned ones.
_PLACEMENTS = (((0, 0), 0.0), ((-1, -1), 0.0), ((1, 1), 0.0), ((-1, 1), 0.0), ((1, -1), 0.0),
               ((-1, 0), 8.0), ((1, 0), -8.0), ((0, -1), 4.0))

MARKER_CM = 4.0
_PAPER_LEVEL, _INK_LEVEL = 225.0, 35.0
# Where the middles are, as shares of the picture's width and height.
_PLACES = ((0.14, 0.17), (0.86, 0.17), (0.86, 0.83), (0.14, 0.83))
# A cell of white paper around the black border.
_CELLS_WITH_PAPER = CELLS + 2
_PAPER_CM = MARKER_CM * _CELLS_WITH_PAPER / CELLS
_CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
# Each pixel is the mean of this many points along each edge, so that edges are smooth.
_FINE = 4

_TABLE_COLOUR = np.array([196.0, 202.0, 208.0])
_NOISE = 2.0
_BLUR_PX = 0.7


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
        darkness = np.where(inked, 0.5 + 0.5 * _stripes(x) * _stripes(y), 0.0)
        # No lens is sharper: without, corners are found off by up to 0.1 px.
        darkness = cv2.GaussianBlur(darkness, (0, 0), _BLUR_PX)[:, :, None]
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


class HeldBoard(NamedTuple):
    """
    A chessboard that is held above the table.

    :param board: With its own plane as the table; its middle is the origin.
    :param surface_from_board: Shape (3, 3): where the table shows a point of the board, x w, y w
        and w, of a point x, y, 1 of the board, in cm.
    """

    board: RenderedBoard
    surface_from_board: np.ndarray

    def paint(self, picture: np.ndarray, view: BoardView) -> np.ndarray:
        """Show the board, see :meth:`RenderedBoard.paint`."""
        return self.board.paint(picture, view.of_plane(self.surface_from_board))


# Towards which side the raised edge points, x and y, one after the other.
_RAISED = ((-1, 0), (1, 0), (0, -1), (0, 1))
# Tilts in degrees, and the middle's height as a share of the camera's: the first that is all seen.
_HELD = ((30.0, 0.2), (30.0, 0.12), (25.0, 0.1), (20.0, 0.08), (15.0, 0.06))


def held_board(
    columns: int, rows: int, square_cm: float, view: BoardView, number: int
) -> HeldBoard:
    """
    Hold a board over the middle of the picture at a tilt, clear of the table.

    :param view: The camera's.
    :param number: From 1: which edge is raised: the left, the right, the top, the bottom one.
    """
    board = RenderedBoard(columns, rows, square_cm, (0.0, 0.0))
    raised = np.array(_RAISED[(number - 1) % len(_RAISED)], float)
    size = np.array([view.width, view.height])
    for tilt_deg, share in _HELD:
        held = HeldBoard(board, _seen_on_table(view, raised, np.radians(tilt_deg), share))
        corners = view.of_plane(held.surface_from_board).pixels(board.inked_corners(margin=0.4))
        if (corners > 0).all() and (corners < size - 1).all():
            return held
    return held


def _seen_on_table(
    view: BoardView, raised: np.ndarray, tilt: float, share: float
) -> np.ndarray:
    """Return where the table shows the points of a held board, see :class:`HeldBoard`."""
    # The third axis points to the camera.
    along, across = np.array([*raised, 0.0]), np.array([-raised[1], raised[0], 0.0])
    risen = np.cos(tilt) * along + np.array([0.0, 0.0, np.sin(tilt)])
    (foot_x, foot_y), height = view.pinhole.camera_place
    middle = np.array([*view.point([view.width / 2, view.height / 2]), 0.0])
    camera = np.array([foot_x, foot_y, height])
    points = np.column_stack([np.outer(risen, raised) + np.outer(across, across[:2]),
                              middle + share * (camera - middle)])
    # A ray from the camera through a point at height z meets the table at
    # foot + (point - foot) height / (height - z).
    depth = np.array([0.0, 0.0, height]) - points[2]
    last = np.array([0.0, 0.0, 1.0])
    return np.array([height * (points[axis] - foot * last) + foot * depth
                     for axis, foot in enumerate((foot_x, foot_y))] + [depth])


def _stripes(position: np.ndarray) -> np.ndarray:
    # 1 from 0 to 1, -1 from 1 to 2, and so on; over an edge it changes along one pixel's width.
    sign = np.where(np.floor(position) % 2 == 0, 1.0, -1.0)
    to_edge = 0.5 - np.abs(position % 1 - 0.5)
    slope = np.hypot(*np.gradient(position)) if min(position.shape) > 1 else 1.0
    return sign * np.clip(2 * to_edge / np.maximum(slope, 1e-9), 0, 1)


class PrintedMarkers:
    """
    The markers 0 to 3, near the corners of the picture.

    :param view: The camera's; the markers stay where they are if the camera is moved later.
    """

    def __init__(self, view: BoardView) -> None:
        size = np.array([view.width, view.height])
        self._middles = [np.array(view.point(size * place)) for place in _PLACES]

    @property
    def corners(self) -> Dict[int, np.ndarray]:
        """By the marker's number its corners, as printed, from the top left clockwise, in cm."""
        return {number: middle + MARKER_CM / 2 * _CORNERS
                for number, middle in enumerate(self._middles)}

    def paint(self, picture: np.ndarray, view: BoardView) -> None:
        """
        Lay the markers into a picture of the table.

        :param picture: Shape (h, w, 3), float32, BGR; it is changed.
        """
        for number, middle in enumerate(self._middles):
            rows, columns = view.box(view.pixels(middle + _PAPER_CM / 2 * _CORNERS))
            window = picture[rows, columns]
            if window.size > 0:
                points = view.points(_finely(rows), _finely(columns)) - middle
                inside, level = _marker_at(points, number)
                window *= 1 - _means(inside)[..., None]
                window += _means(level)[..., None]


def _marker_at(points: np.ndarray, number: int) -> Tuple[np.ndarray, np.ndarray]:
    # Whether points, from the marker's middle, lie on its paper, and the grey level there, else 0.
    cells = np.floor((points + _PAPER_CM / 2) * (CELLS / MARKER_CM)).astype(int)
    inside = ((cells >= 0) & (cells < _CELLS_WITH_PAPER)).all(axis=2)
    x, y = np.moveaxis(np.clip(cells, 0, _CELLS_WITH_PAPER - 1), 2, 0)
    ink = np.pad(marker_cells(number), 1)
    return inside, inside * np.where(ink[y, x], _INK_LEVEL, _PAPER_LEVEL)


def _finely(pixels: slice) -> slice:
    # Points of a pixel, evenly spread about its middle.
    first = 0.5 / _FINE - 0.5
    return slice(pixels.start + first, pixels.stop + first, 1 / _FINE)


def _means(fine: np.ndarray) -> np.ndarray:
    height, width = (length // _FINE for length in fine.shape)
    return fine.reshape(height, _FINE, width, _FINE).mean(axis=(1, 3)).astype(np.float32)


class SimulatedChessboard:
    """
    Frames of a chessboard in the middle of the surface, seen as the simulated board is.

    Its dark end is on the left, so that its first corner is the top left one.

    :param columns: Inner corners along a row.
    :param rows: Inner corners along a column.
    :param square_cm: Edge of a square, in cm.
    :param image_size: Width and height, in px.
    :param tilt_deg: The camera's, see :class:`BoardView`.
    :param seed: Makes the noise; the same seed gives the same frames.
    :raises InvalidValueError: If a value cannot be used.
    """

    kind = SIMULATED._replace(frame_rate=10.0)

    def __init__(
        self,
        columns: int,
        rows: int,
        square_cm: float,
        *,
        image_size: ImageSize = DEFAULT_IMAGE_SIZE,
        tilt_deg: float = 0.0,
        seed: int = 0,
    ) -> None:
        self.view = BoardView(image_size, TUTORIAL_WIDTH_CM, tilt_deg)
        self._board = RenderedBoard(
            whole_number('columns', columns, 1, 1000), whole_number('rows', rows, 1, 1000),
            finite_number('square_cm', square_cm, 0.001, 1e4), tuple(self.view.size_cm / 2))
        self._first_corner = self._board.middle - self._board.half_cm
        self._random = np.random.default_rng(seed)
        self._picture = self._board.paint(_TABLE_COLOUR, self.view)

    def lay(self, pixel: Tuple[float, float], yaw_deg: float) -> None:
        """
        Lay the board elsewhere.

        :param pixel: What shows the board's middle, u and v, in px.
        :param yaw_deg: Its turn from x towards y.
        """
        self._board = self._board._replace(
            middle=self.view.point(pixel), yaw=np.radians(yaw_deg))
        self._picture = self._board.paint(_TABLE_COLOUR, self.view)

    def hold(self, number: int) -> None:
        """
        Hold the board above the middle of the surface, at a tilt.

        :param number: From 1: to which side, see :func:`held_board`.
        """
        self._picture = held_board(
            self._board.columns, self._board.rows, self._board.square_cm, self.view, number
        ).paint(_TABLE_COLOUR, self.view)

    def free_place(self, number: int) -> Tuple[Tuple[float, float], float]:
        """
        Return where the whole board still lies in the picture: one corner after the other.

        :param number: 1 for the first place after the middle.
        :returns: The pixel of its middle, and its turn, see :meth:`lay`.
        """
        size = np.array([self.view.width, self.view.height])
        paper_cm = 2 * self._board.half_cm + 4 * self._board.square_cm
        board_px = paper_cm / self.view.cm_per_px
        free = np.maximum(size - board_px, 0) / 2
        side = np.array([(-1, -1), (1, 1), (-1, 1), (1, -1)][(number - 1) % 4])
        return tuple((size / 2 + side * free * 0.9).tolist()), 0.0

    @property
    def first_corner(self) -> np.ndarray:
        """Where the first inner corner is at the start, x and y, in cm, in the camera frame."""
        return self._first_corner.copy()

    def read(self) -> np.ndarray:
        """
        Render the next frame.

        :returns: Shape (h, w, 3), uint8, BGR.
        """
        noise = self._random.normal(0.0, _NOISE, self._picture.shape)
        return np.clip(np.rint(self._picture + noise), 0, 255).astype(np.uint8)

    def release(self) -> None:
        """Do nothing: there is no device to give back."""
