# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A placement of a printed board: its corners in one picture, and which parts are covered."""

from typing import List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.calibration.boards.board import board_points, find_board
from camera_to_base.calibration.boards.board_search import any_board, not_found_text, part_text
from camera_to_base.calibration.boards.charuco import find_charuco
from camera_to_base.checks import ImageSize
from camera_to_base.errors import CalibrationError, CameraToBaseError
from camera_to_base.surface import Hull, MatchedPoints
import cv2
import numpy as np

NINTHS = ('top left', 'top', 'top right', 'left', 'middle', 'right', 'bottom left', 'bottom',
          'bottom right')
# Shares of a ninth from which on it counts as covered, and as covered in part.
_COVERED, _PARTLY = 0.5, 0.1

# Mean distance of the corners of two placements below which the board was not moved.
_LEAST_MOVE_PX = 5.0

# A picture of this width shows whether a board is there; finding none takes 0.05 s, not 0.5 s.
_WIDTH = 800
# Width in px of the edges of squares up to which corners are found best, and up to which they are
# found well. Simulated pictures have 2 px, OpenCV's 26 sample boards 2.6 to 3.3 px.
_SHARP_PX, _SOFT_PX = 3.5, 5.0
# Shares of the pixels that noise and shining spots may have.
_RIM = 5, 95
_STEEPEST = 98


def covered_shares(outlines: Sequence[np.ndarray], image_size: ImageSize) -> np.ndarray:
    """
    Measure how much of each ninth of the picture is covered.

    :param outlines: The convex outlines of what was measured, each of shape (n, 2), in px.
    :param image_size: Width and height, in px.
    :returns: Shape (3, 3), 0 to 1, the top row first.
    """
    # At a reduced size, which is accurate enough.
    scale = 300 / np.array(image_size)
    mask = np.zeros((300, 300), np.uint8)
    for outline in outlines:
        cv2.fillConvexPoly(mask, np.round(outline * scale).astype(np.int32), 1)
    return mask.reshape(3, 100, 3, 100).mean(axis=(1, 3))


def map_lines(shares: np.ndarray) -> List[str]:
    """
    Draw the map: '#' for covered, '+' for in part, '.' for not.

    :param shares: Shape (3, 3), see :func:`covered_shares`.
    """
    return [' '.join(_mark(share) for share in row) for row in shares]


def uncovered(shares: np.ndarray) -> List[str]:
    """Name the ninths that are not covered, those of which least is covered first."""
    order = np.argsort(shares.ravel(), kind='stable')
    return [NINTHS[index] for index in order if shares.ravel()[index] < _COVERED]


def _mark(share: float) -> str:
    return '#' if share >= _COVERED else '+' if share >= _PARTLY else '.'


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


class Placement(NamedTuple):
    """
    A picture of the board, and what it shows.

    :param numbers: Shape (n,), which of the board's corners the points are.
    :param outline: The hull of the points, shape (m, 2), in px.
    :param doubts: Sentences about what is doubtful.
    """

    image: np.ndarray
    name: str
    matched: MatchedPoints
    numbers: np.ndarray
    outline: np.ndarray
    doubts: List[str]


def make_placement(
    board: PrintedBoard, image: np.ndarray, name: str, number: int, says_name: bool = True
) -> Placement:
    """
    Find the board in a picture.

    :param image: Shape (h, w, 3), uint8, BGR.
    :param number: Counts the placements from 0: the first one defines the camera frame.
    :param says_name: Whether an error names the picture.
    :raises CalibrationError: If the picture shows no such board; the message says why.
    """
    try:
        numbers, pixels, doubts = board.find(image)
    except CalibrationError as error:
        if not says_name:
            raise
        raise CalibrationError(f'{name}: {error}') from error
    return Placement(image, name, _matched(board, numbers, pixels, number), numbers,
                     Hull(pixels).corners, doubts)


def renumbered(board: PrintedBoard, placement: Placement, number: int) -> Placement:
    """Give a placement another number, after one before it was removed."""
    matched = _matched(board, placement.numbers, placement.matched.pixels, number)
    return placement._replace(matched=matched, name=f'placement {number + 1}')


def _matched(
    board: PrintedBoard, numbers: np.ndarray, pixels: np.ndarray, number: int
) -> MatchedPoints:
    points = board.first_points() if number == 0 else board.further_points()
    return MatchedPoints(points[numbers], pixels)


def refuse_unlike(placements: Sequence[Placement]) -> None:
    """
    Refuse pictures of another size, and placements that are the same.

    :raises CalibrationError: Naming the two pictures.
    """
    *before, last = placements
    for one in before:
        if one.image.shape != last.image.shape:
            raise CalibrationError(
                '{1} x {0} px in {2}, but {4} x {3} px in {5}: use pictures of one size, from one '
                'camera'.format(*one.image.shape[:2], one.name, *last.image.shape[:2], last.name))
        if _distance(one, last) < _LEAST_MOVE_PX:
            raise CalibrationError(
                f'the board lies in the same place twice, in {one.name} and in {last.name}: lay '
                'it elsewhere')
    if len(before) > 1:
        refuse_unlike(before)


def shares_of(placements: Sequence[Placement]) -> np.ndarray:
    """Measure how much of each ninth of the picture the placements cover, shape (3, 3)."""
    height, width = placements[0].image.shape[:2]
    return covered_shares([placement.outline for placement in placements], (width, height))


def outer_edge(placement: Placement) -> np.ndarray:
    """Return about where the board's white margin ends, shape (n, 2), in px."""
    centre = placement.outline.mean(axis=0)
    return centre + 1.6 * (placement.outline - centre)


def _distance(one: Placement, other: Placement) -> float:
    """Return how far apart two placements are, in px; infinite without a common corner."""
    _, here, there = np.intersect1d(one.numbers, other.numbers, return_indices=True)
    moves = one.matched.pixels[here] - other.matched.pixels[there]
    return float(np.linalg.norm(moves, axis=1).mean()) if len(moves) else np.inf


class BoardLook(NamedTuple):
    """
    What a picture shows of a board.

    :param sentence: How many corners are found, or why there is no board.
    :param corners: Shape (n, 2), u and v, in px, to about a pixel; n is 0 without a board.
    :param edge_px: Width of the edges of the squares; None without a board.
    """

    is_found: bool
    sentence: str
    corners: np.ndarray
    edge_px: Optional[float] = None

    @property
    def sharpness(self) -> Optional[str]:
        """How sharp the board is: 'sharp', 'soft' or 'blurred'; None without a board."""
        if self.edge_px is None:
            return None
        limits = ((_SHARP_PX, 'sharp'), (_SOFT_PX, 'soft'), (np.inf, 'blurred'))
        return next(word for limit, word in limits if self.edge_px <= limit)


def look_for(board: PrintedBoard, image: np.ndarray) -> BoardLook:
    """
    Look for a board, quickly.

    :param image: Shape (h, w, 3), uint8, BGR.
    :raises InvalidValueError: If there is no board of these counts.
    """
    corners, reason = (_marked_corners if board.has_markers else _plain_corners)(board, image)
    if reason:
        return BoardLook(False, reason, np.empty((0, 2)))
    columns, rows = board.corners
    return BoardLook(True, f'{len(corners)} of {columns * rows} corners found', corners,
                     _edge_width(image, corners))


def _marked_corners(board: PrintedBoard, image: np.ndarray) -> Tuple[np.ndarray, str]:
    try:
        return board.find(image).pixels, ''
    except CameraToBaseError as error:
        return np.empty((0, 2)), str(error)


def _plain_corners(board: PrintedBoard, image: np.ndarray) -> Tuple[np.ndarray, str]:
    scale = min(1.0, _WIDTH / image.shape[1])
    grey = cv2.resize(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None, fx=scale, fy=scale,
                      interpolation=cv2.INTER_AREA)
    columns, rows = board.corners
    part = any_board(grey)
    if part is None:
        part = _classical(grey, columns, rows)
    if part is None:
        return np.empty((0, 2)), not_found_text(columns, rows)
    if sorted(part.shape[:2]) != sorted((columns, rows)):
        return np.empty((0, 2)), part_text(grey, part, columns, rows)
    return ((part + 0.5) / scale - 0.5).reshape(-1, 2), ''


def _classical(grey: np.ndarray, columns: int, rows: int) -> Optional[np.ndarray]:
    """Search with the other finder, which takes half a second unless the check ends it."""
    flags = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_FAST_CHECK
    found, corners = cv2.findChessboardCorners(grey, (columns, rows), flags=flags)
    return corners.reshape(rows, columns, 2).astype(float) if found else None


def _edge_width(image: np.ndarray, corners: np.ndarray) -> float:
    """Return over how many px the squares change from dark to bright."""
    low, high = np.floor(corners.min(axis=0)), np.ceil(corners.max(axis=0)) + 1
    (left, top), (right, bottom) = np.maximum(low, 0).astype(int), high.astype(int)
    grey = cv2.cvtColor(image[top:bottom, left:right], cv2.COLOR_BGR2GRAY)
    along_u, along_v = (cv2.Sobel(grey, cv2.CV_32F, *axis, scale=1 / 8)
                        for axis in ((1, 0), (0, 1)))
    steepest = np.percentile(cv2.magnitude(along_u, along_v), _STEEPEST)
    return float(np.ptp(np.percentile(grey, _RIM)) / max(steepest, 1e-3))
