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

"""Tells a person who lays a board whether it is found in a picture, and why not."""

from typing import NamedTuple, Optional, Tuple

from camera_to_base.calibration.boards.board_search import (
    any_board, not_found_text, part_text)
from camera_to_base.calibration.boards.printed_board import PrintedBoard
from camera_to_base.errors import CameraToBaseError
import cv2
import numpy as np

# A picture of this width shows whether a board is there; finding none takes 0.05 s, not 0.5 s.
_WIDTH = 800
# Width in px of the edges of squares up to which corners are found best, and up to which they are
# found well. Simulated pictures have 2 px, OpenCV's 26 sample boards 2.6 to 3.3 px.
_SHARP_PX, _SOFT_PX = 3.5, 5.0
# Shares of the pixels that noise and shining spots may have.
_RIM = 5, 95
_STEEPEST = 98


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
