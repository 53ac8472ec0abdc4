# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Finds a chessboard's inner corners in a picture, in a reproducible order."""

from dataclasses import dataclass
import time
from typing import Sequence

from camera_to_base.calibration.boards.board_search import (
    count_beyond, other_counts, REASON_S, search, SEARCH_S, SMALLEST_SQUARE_PX, square_contrast,
    why_not_found)
from camera_to_base.checks import (
    check_frame, check_image_size, finite_number, finite_numbers, whole_number)
from camera_to_base.errors import CalibrationError, InvalidValueError
import cv2
import numpy as np

# Half the side of the window in which a corner is refined, as a share of the distance to its
# nearest neighbour. 0.25 to 0.3 measured best; at 0.4 the window contains neighbouring edges.
WINDOW_SHARE = 0.3

# For each corner that can be the origin: whether x and y start at the far end.
ORIGIN_CORNERS = {
    0: (False, False),
    1: (True, False),
    2: (True, True),
    3: (False, True),
}


@dataclass(frozen=True)
class Board:
    """
    The inner corners of a chessboard in a picture.

    :param corners: Shape (rows, columns, 2), u and v, in px. The first is the origin, x runs along
        the rows and y along the columns. See `canonical`.
    :param second_board: Whether the picture shows another, smaller board with the same counts.
    """

    corners: np.ndarray
    second_board: bool = False

    @property
    def pixels(self) -> np.ndarray:
        """Return the corners row by row, shape (rows * columns, 2), in px."""
        return self.corners.reshape(-1, 2)


def find_board(image: np.ndarray, columns: int, rows: int) -> Board:
    """
    Find a chessboard's inner corners to a fraction of a pixel; give up after about 10 s.

    :param image: Shape (h, w, 3), uint8, BGR.
    :param columns: Inner corners along a row.
    :param rows: Inner corners along a column.
    :raises InvalidValueError: If the counts are below 3, or the picture is none, too small for so
        many squares, or too large for a frame.
    :raises CalibrationError: If there is no board, one that is cut off, or one of other counts;
        the message says which.
    """
    check_frame(image, 'picture')
    columns = whole_number('the count of inner corners along a row', columns, 3, 1000)
    rows = whole_number('the count of inner corners along a column', rows, 3, 1000)
    _check_size(image, columns, rows)
    grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    begun = time.monotonic()
    corners = search(grey, columns, rows, until=begun + SEARCH_S)
    if corners is None:
        raise CalibrationError(why_not_found(grey, columns, rows, begun + REASON_S))
    more_columns, more_rows = count_beyond(grey, corners)
    if more_columns or more_rows:
        raise CalibrationError(
            other_counts(columns, rows, columns + more_columns, rows + more_rows))
    other = search(_without(grey, corners), columns, rows, thorough=False)
    if other is not None and _area(other) > _area(corners):
        corners = other
    return Board(canonical(grey, refine(grey, corners)), other is not None)


def canonical(grey: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """
    Order corners so that the same board gives the same order, however it is turned.

    1. The camera sees y a quarter turn clockwise from x, like v from u: z points into the
       surface.
    2. Where the counts differ by an odd number, the board has one end with dark corner squares:
       the origin is the corner at that end that 1. leaves.
    3. Otherwise turning the board by 180 degrees changes nothing that can be seen (or by 90, where
       the counts are equal): the origin is the one nearest to the picture's top-left pixel, of
       those at dark corner squares if only some of them are.

    :param grey: Shape (h, w), uint8.
    :param corners: Shape (rows, columns, 2), in px, in any order along rows and columns.
    :returns: Shape (rows, columns, 2), in px.
    """
    if _turns_left(corners):
        corners = corners[:, ::-1]
    turns = (0, 1, 2, 3) if corners.shape[0] == corners.shape[1] else (0, 2)
    candidates = [np.rot90(corners, turn) for turn in turns]
    dark = [square_contrast(grey, candidate) < 0 for candidate in candidates]
    if any(dark):
        candidates = [candidate for candidate, at_dark in zip(candidates, dark) if at_dark]
    return min(candidates, key=lambda candidate: np.linalg.norm(candidate[0, 0]))


def refine(grey: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """
    Move each corner to the crossing of the edges around it.

    :param grey: Shape (h, w), uint8.
    :param corners: Shape (rows, columns, 2), in px, a few px off.
    :returns: Shape (rows, columns, 2), in px.
    """
    windows = np.maximum(2, (WINDOW_SHARE * _spacing(corners)).astype(int))
    refined = np.array(corners, float)
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 100, 1e-4)
    for window in np.unique(windows):
        members = windows == window
        starts = refined[members].reshape(-1, 1, 2).astype(np.float32)
        side = (int(window), int(window))
        moved = cv2.cornerSubPix(grey, starts, side, (-1, -1), criteria)
        refined[members] = moved.reshape(-1, 2)
    return refined


def _spacing(corners):
    """Return each corner's distance to its nearest neighbour, shape (rows, columns), in px."""
    along_x = np.linalg.norm(np.diff(corners, axis=1), axis=2)
    along_y = np.linalg.norm(np.diff(corners, axis=0), axis=2)
    return np.min([np.pad(along_x, ((0, 0), (1, 0)), constant_values=np.inf),
                   np.pad(along_x, ((0, 0), (0, 1)), constant_values=np.inf),
                   np.pad(along_y, ((1, 0), (0, 0)), constant_values=np.inf),
                   np.pad(along_y, ((0, 1), (0, 0)), constant_values=np.inf)], axis=0)


def _outline(corners):
    return np.array([corners[0, 0], corners[0, -1], corners[-1, -1], corners[-1, 0]])


def _area(corners):
    return cv2.contourArea(_outline(corners).astype(np.float32))


def _turns_left(corners):
    return cv2.contourArea(_outline(corners).astype(np.float32), oriented=True) < 0


def _without(grey, corners):
    """Return the picture with the board painted over, its outer squares included."""
    centre = corners.mean(axis=(0, 1))
    grown = centre + (_outline(corners) - centre) * (1 + 2 / (min(corners.shape[:2]) - 1))
    return cv2.fillConvexPoly(grey.copy(), grown.round().astype(np.int32), int(grey.mean()))


def _check_size(image, columns, rows):
    height, width = image.shape[:2]
    try:
        check_image_size((width, height))
    except InvalidValueError as error:
        raise InvalidValueError(
            f'the picture of {width} x {height} px is larger than a frame can be, make it '
            f'smaller: {error}') from error
    long, short = max(columns, rows) + 1, min(columns, rows) + 1
    if (max(width, height) < SMALLEST_SQUARE_PX * long
            or min(width, height) < SMALLEST_SQUARE_PX * short):
        raise InvalidValueError(
            f'the picture of {width} x {height} px is too small to show {columns + 1} x '
            f'{rows + 1} squares: use a larger one')


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
