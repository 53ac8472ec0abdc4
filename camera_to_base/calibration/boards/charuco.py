# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
A chessboard with markers in its white squares: its corners are known where only a part is seen.

The layout is this package's own, the same with all versions of OpenCV: the first square is black,
and the white squares have the markers from FIRST_MARKER on, row by row.
"""

from typing import Dict, List, NamedTuple, Tuple

from camera_to_base.checks import check_frame, whole_number
from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.markers import find_markers, MARKER_COUNT
import cv2
import numpy as np

# Those below are for other uses on the same table.
FIRST_MARKER = 10
# Edge of a marker as a share of the square's.
MARKER_SHARE = 0.7
# Corners that a placement needs at least.
_LEAST_CORNERS = 8
# Half the side of the window of a corner's refinement: it ends before the markers begin.
_WINDOW_SHARE = 0.5 * (1 - MARKER_SHARE)
# The markers tell a corner's place to this, in px and as a share of a square. A corner that
# something covers in part is refined to another place, or its squares do not alternate.
_MOVE_PX, _MOVE_SHARE = 0.3, 0.015
_LEAST_CONTRAST = 0.4


class CharucoCorners(NamedTuple):
    """
    The inner corners that a picture shows.

    :param numbers: Shape (n,), row by row from 0.
    :param pixels: Shape (n, 2), u and v, in px.
    """

    numbers: np.ndarray
    pixels: np.ndarray


def marker_squares(columns: int, rows: int) -> Dict[int, Tuple[int, int]]:
    """
    Return the column and the row of each marker's square, by the marker's number.

    :param columns: Inner corners along a row.
    :param rows: Inner corners along a column.
    :raises InvalidValueError: If there are not so many markers.
    """
    columns = whole_number('the count of inner corners along a row', columns, 3, 1000)
    rows = whole_number('the count of inner corners along a column', rows, 3, 1000)
    white = [(column, row) for row in range(rows + 1) for column in range(columns + 1)
             if (column + row) % 2]
    if FIRST_MARKER + len(white) > MARKER_COUNT:
        raise InvalidValueError(
            f'a board of {columns} x {rows} inner corners needs {len(white)} markers, there are '
            f'{MARKER_COUNT - FIRST_MARKER}: use fewer and larger squares')
    return dict(enumerate(white, FIRST_MARKER))


def find_charuco(image: np.ndarray, columns: int, rows: int) -> CharucoCorners:
    """
    Find the corners of a board of which a part may be cut off or covered.

    :param image: Shape (h, w, 3), uint8, BGR.
    :raises CalibrationError: If too few corners are seen, or OpenCV knows no markers.
    """
    check_frame(image, 'picture')
    squares = marker_squares(columns, rows)
    grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    seen = {number: corners for number, corners in find_markers(grey).items()
            if number in squares}
    found = [corner for corner in _near_markers(seen, squares, columns, rows)
             if _is_inside(corner[1], corner[2], grey.shape)]
    kept = [(number, pixel) for number, start, square_px in found
            for pixel in [_refined(grey, start, square_px)]
            if np.linalg.norm(pixel - start) < _MOVE_PX + _MOVE_SHARE * square_px
            and _alternates(grey, pixel, number, columns, seen, squares)]
    if len(kept) < _LEAST_CORNERS:
        raise CalibrationError(
            f'{len(kept)} of {columns * rows} inner corners of a ChArUco board found, at least '
            f'{_LEAST_CORNERS} are needed: show more of it, larger and sharper; was it printed by '
            f'calibrate sheet --charuco --corners {columns}x{rows}?')
    return CharucoCorners(np.array([number for number, _ in kept]),
                          np.array([pixel for _, pixel in kept]))


def _marker_points(square: Tuple[int, int]) -> np.ndarray:
    """Return a marker's corners in squares, from the first inner corner, shape (4, 2)."""
    gap = (1 - MARKER_SHARE) / 2
    inner = np.array([[gap, gap], [1 - gap, gap], [1 - gap, 1 - gap], [gap, 1 - gap]])
    return inner + square - 1


def _near_markers(
    seen: Dict[int, np.ndarray], squares: Dict[int, Tuple[int, int]], columns: int, rows: int
) -> List[Tuple[int, np.ndarray, float]]:
    """Return number, expected pixel and size of a square of each corner beside a seen marker."""
    found = []
    for number in range(columns * rows):
        corner = np.array([number % columns, number // columns], float)
        # The centre of a marker is half a square from its corners in both directions.
        away = {marker: np.abs(np.array(squares[marker]) - 0.5 - corner).max() for marker in seen}
        near = [marker for marker, distance in away.items() if distance < 1.6]
        if len(near) < 2 or min(away[marker] for marker in near) > 0.6:
            continue
        points = np.concatenate([_marker_points(squares[marker]) for marker in near])
        pixels = np.concatenate([seen[marker] for marker in near])
        homography, _ = cv2.findHomography(points, pixels)
        if homography is None:
            continue
        around = corner + [[0, 0], [0.5, 0], [-0.5, 0], [0, 0.5], [0, -0.5]]
        shown = cv2.perspectiveTransform(around[None], homography)[0]
        size = min(np.linalg.norm(shown[1] - shown[2]), np.linalg.norm(shown[3] - shown[4]))
        found.append((number, shown[0], float(size)))
    return found


def _is_inside(pixel: np.ndarray, square_px: float, shape: Tuple[int, int]) -> bool:
    margin = _window(square_px) + 2
    return bool((pixel > margin).all() and (pixel < np.array(shape[::-1]) - 1 - margin).all())


def _window(square_px: float) -> int:
    return max(2, int(_WINDOW_SHARE * square_px))


def _refined(grey: np.ndarray, pixel: np.ndarray, square_px: float) -> np.ndarray:
    window = _window(square_px)
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 100, 1e-4)
    start = pixel.reshape(1, 1, 2).astype(np.float32)
    return cv2.cornerSubPix(grey, start, (window, window), (-1, -1), criteria).reshape(2)


def _alternates(
    grey: np.ndarray, pixel: np.ndarray, number: int, columns: int,
    seen: Dict[int, np.ndarray], squares: Dict[int, Tuple[int, int]],
) -> bool:
    """Return whether the four squares around a corner are dark and bright in turn."""
    corner = np.array([number % columns, number // columns], float)
    nearest = min(seen, key=lambda marker: np.abs(
        np.array(squares[marker]) - 0.5 - corner).max())
    homography, _ = cv2.findHomography(_marker_points(squares[nearest]), seen[nearest])
    beside = corner + 0.5 * (1 - MARKER_SHARE) * 0.6 * np.array(
        [[-1, -1], [1, -1], [1, 1], [-1, 1]])
    shown = cv2.perspectiveTransform(np.vstack([corner, beside])[None], homography)[0]
    places = np.round(pixel + shown[1:] - shown[0]).astype(int)
    smooth = cv2.blur(grey, (3, 3))
    values = smooth[np.clip(places[:, 1], 0, grey.shape[0] - 1),
                    np.clip(places[:, 0], 0, grey.shape[1] - 1)].astype(float)
    # The square before the first inner corner is black.
    dark_first = 1 if corner.sum() % 2 == 0 else -1
    contrast = dark_first * (values[1] + values[3] - values[0] - values[2]) / 2
    return bool(contrast > _LEAST_CONTRAST * max(np.ptp(grey), 1))
