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

"""Measures the squares between and around a chessboard's corners."""

import cv2
import numpy as np

# Real boards have a contrast of 0.79 or more at squares, 0.30 or less beside the board, and an
# irregularity of 0.07 or less. Most false boards of the finders have 0.25 or more.
LEAST_CONTRAST = 0.55
LARGEST_IRREGULARITY = 0.2


def square_contrast(grey: np.ndarray, corners: np.ndarray) -> float:
    """
    Compare the squares coloured like the first with the others.

    :param grey: Shape (h, w), uint8.
    :param corners: Shape (rows, columns, 2), in px.
    :returns: -1 where the first square (and so the board's outer corner square next to it) is dark
        and all squares are even, +1 where it is bright, about 0 if squares do not alternate.
    """
    values = _values_at(grey, _square_centres(corners))
    return _alternation(values) / max(float(np.ptp(values)), 1.0)


def is_board(grey: np.ndarray, corners: np.ndarray) -> bool:
    """
    Return whether corners are those of a chessboard: finders also return false ones.

    They must be regular, and the squares between and around them must alternate.

    :param grey: Shape (h, w), uint8.
    :param corners: Shape (rows, columns, 2), in px.
    """
    return (is_pattern(grey, corners)
            and all(_has_squares_beyond(grey, np.rot90(corners, turn), 0) for turn in range(4)))


def is_pattern(grey: np.ndarray, corners: np.ndarray) -> bool:
    """
    Return whether corners are those of a chessboard or of a part of one.

    :param grey: Shape (h, w), uint8.
    :param corners: Shape (rows, columns, 2), in px.
    """
    return (_irregularity(corners) < LARGEST_IRREGULARITY
            and abs(square_contrast(grey, corners)) > LEAST_CONTRAST)


def count_beyond(grey: np.ndarray, corners: np.ndarray) -> tuple[int, int]:
    """
    Count the corners that a board has beyond those found.

    Finders accept a part of a board: when asked for 8 x 6 corners, OpenCV 4.6 and 5.0 find them
    in 24 and 25 of 26 pictures of a 9 x 6 board. A board ends one square beyond its outermost
    corners; if a second square follows, there is another corner between.

    :param grey: Shape (h, w), uint8.
    :param corners: Shape (rows, columns, 2), in px.
    :returns: Further columns and further rows.
    """
    sides = [_count_beyond_last_row(grey, np.rot90(corners, turn)) for turn in range(4)]
    return sides[1] + sides[3], sides[0] + sides[2]


def edges_reached(grey: np.ndarray, corners: np.ndarray) -> list[str]:
    """
    Name the picture's edges at which a board ends because the picture does.

    :param grey: Shape (h, w), uint8.
    :param corners: Shape (rows, columns, 2), in px: of the board, or of a part of it.
    :returns: Some of 'left', 'right', 'top' and 'bottom'.
    """
    edges = set()
    for turn in range(4):
        turned, skip = np.rot90(corners, turn), 0
        while skip < 20 and _has_squares_beyond(grey, turned, skip):
            skip += 1
        edges |= _edges_passed(grey, _places_beyond(turned, skip))
    return [edge for edge in ('left', 'right', 'top', 'bottom') if edge in edges]


def _edges_passed(grey, pixels):
    """Name the edges that pixels (n, 2) lie beyond."""
    (height, width), (u, v) = grey.shape, pixels.T
    passed = {'left': u < 0, 'right': u >= width, 'top': v < 0, 'bottom': v >= height}
    return {edge for edge, beyond in passed.items() if beyond.any()}


def _count_beyond_last_row(grey, corners):
    more = 0
    while more < 20 and _has_squares_beyond(grey, corners, more + 1):
        more += 1
    return more


def _has_squares_beyond(grey, corners, skip):
    """Return whether the pattern continues that many squares after the last row of corners."""
    rows, pixels = corners.shape[0], _places_beyond(corners, skip)
    if not _inside(grey, pixels):
        return False
    contrast = _alternation(_values_at(grey, _square_centres(corners)))
    beyond = _alternation(_values_at(grey, pixels[None])) * (-1) ** (rows - 1 + skip)
    return beyond / contrast > LEAST_CONTRAST


def _places_beyond(corners, skip):
    """Return a pixel of each square, that many squares after the last row of corners, (n, 2)."""
    rows, columns = corners.shape[:2]
    # A quarter into the squares: many prints cut the outermost in half.
    places = np.stack([np.arange(columns - 1) + 0.5,
                       np.full(columns - 1, rows - 1 + skip + 0.25)], axis=1)
    return cv2.perspectiveTransform(places[None], _pixel_from_square(corners))[0]


def _pixel_from_square(corners):
    """Return the homography from counts of squares to pixels at the last three rows."""
    rows, columns = corners.shape[:2]
    y, x = np.mgrid[rows - 3:rows, :columns].astype(float)
    return cv2.findHomography(np.stack([x, y], axis=-1).reshape(-1, 2),
                              corners[-3:].reshape(-1, 2))[0]


def _square_centres(corners):
    return (corners[1:, 1:] + corners[1:, :-1] + corners[:-1, 1:] + corners[:-1, :-1]) / 4


def _alternation(values):
    """Return how much brighter the squares coloured like the first are."""
    like_first = np.indices(values.shape).sum(axis=0) % 2 == 0
    return float(values[like_first].mean() - values[~like_first].mean())


def _values_at(grey, pixels):
    """Return the brightness at pixels (rows, columns, 2), as a mean over 3 x 3 px."""
    smooth = cv2.blur(grey, (3, 3)).astype(float)
    u, v = np.round(pixels).astype(int).reshape(-1, 2).T
    height, width = grey.shape
    return smooth[np.clip(v, 0, height - 1), np.clip(u, 0, width - 1)].reshape(pixels.shape[:-1])


def _inside(grey, pixels):
    height, width = grey.shape
    return bool(((pixels >= 0) & (pixels < [width, height])).all())


def _irregularity(corners):
    """Return how far a corner is from the middle of its neighbours, as a share of their gap."""
    worst = 0.0
    for lines in (corners, corners.swapaxes(0, 1)):
        bend = np.linalg.norm(lines[:, 2:] - 2 * lines[:, 1:-1] + lines[:, :-2], axis=2)
        span = np.linalg.norm(lines[:, 2:] - lines[:, :-2], axis=2)
        worst = max(worst, float((bend / np.maximum(span, 1e-9)).max()))
    return worst
