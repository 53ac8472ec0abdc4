# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Searches a picture for a chessboard, measures its squares, and says what is there instead."""

import math
import time
from typing import Callable, Dict, Optional, Sequence, Tuple

import cv2
import numpy as np

# Real boards have a contrast of 0.79 or more at squares, 0.30 or less beside the board, and an
# irregularity of 0.07 or less. Most false boards of the finders have 0.25 or more.
LEAST_CONTRAST = 0.55
LARGEST_IRREGULARITY = 0.2

# Finders need a few pixels for a square.
SMALLEST_SQUARE_PX = 4

# Of a board that is cut off so many parts are searched, to say so.
MOST_PARTS = 12

# Pictures are searched at this width first: fast, and the finder copes better with few pixels.
SEARCH_WIDTH = 1000

# A picture without a board is given up after 10 s: so long it is searched, and so long with the
# search for the reason. A try that has begun cannot be ended, and takes 1 s or 2 s.
SEARCH_S, REASON_S = 6.0, 8.0
# Pictures up to this width are searched whole in any case: it takes 2 s.
_ALWAYS_PX = 2000
# A finder's time grows by this power of a picture's width.
_GROWTH = 2.5
# From so many outlines on the classical finder, which compares them in pairs, takes seconds: it
# gets the picture without its noise, or not at all. The noise of a plain table has 5400 in
# 640 x 480 px, photographs of boards have 150 to 200, a rendered one with a noise of 12 3200.
_MOST_OUTLINES = 4000
_LEAST_OUTLINE_PX = 25

_Finder = Callable[[np.ndarray, int, int], Optional[np.ndarray]]


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


def search(grey: np.ndarray, columns: int, rows: int, *, thorough: bool = True,
           until: float = math.inf) -> Optional[np.ndarray]:
    """
    Find corners to a pixel: first in a reduced picture if it is large, then in the full one.

    :param grey: Shape (h, w), uint8.
    :param thorough: False looks at the reduced picture only, which takes a tenth of the time.
    :param until: A time of time.monotonic(): no try begins that would end later.
    :returns: Shape (rows, columns, 2), in px, or None.
    """
    scale = min(1.0, SEARCH_WIDTH / max(grey.shape))
    took: Dict[_Finder, float] = {}
    before = scale
    for factor in sorted({scale, min(1.0, 2 * scale), 1.0}) if thorough else [scale]:
        reduced = cv2.resize(grey, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
        # The one that measured better, then the one for blurred pictures.
        for finder in (_classical, _by_sectors):
            begun = time.monotonic()
            if factor * max(grey.shape) > _ALWAYS_PX and begun + took.get(finder, 0.0) * (
                    factor / before) ** _GROWTH > until:
                continue
            corners = finder(reduced, columns, rows)
            took[finder] = time.monotonic() - begun
            if corners is not None and is_board(reduced, corners):
                return (corners + 0.5) / factor - 0.5
        before = factor
    return None


def _classical(grey: np.ndarray, columns: int, rows: int) -> Optional[np.ndarray]:
    quiet = _quiet(grey)
    return None if quiet is None else _classical_once(quiet, columns, rows)


def _classical_once(quiet: np.ndarray, columns: int, rows: int) -> Optional[np.ndarray]:
    flags = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE
    found, corners = cv2.findChessboardCorners(quiet, (columns, rows), flags=flags)
    return corners.reshape(rows, columns, 2).astype(float) if found else None


def _by_sectors(grey: np.ndarray, columns: int, rows: int) -> Optional[np.ndarray]:
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_ACCURACY
    found, corners = cv2.findChessboardCornersSB(grey, (columns, rows), flags=flags)
    return corners.reshape(rows, columns, 2).astype(float) if found else None


def _quiet(grey: np.ndarray) -> Optional[np.ndarray]:
    """Return a picture for the classical finder, without noise where needed; None for none."""
    if _outlines(grey) <= _MOST_OUTLINES:
        return grey
    quiet = cv2.medianBlur(grey, 5)
    return quiet if _outlines(quiet) <= _MOST_OUTLINES else None


def _outlines(grey: np.ndarray) -> int:
    """Count the outlines that the classical finder has to compare."""
    block = max(3, min(grey.shape) // 12 | 1)
    black_white = cv2.adaptiveThreshold(
        cv2.equalizeHist(grey), 255, cv2.ADAPTIVE_THRESH_MEAN_C, cv2.THRESH_BINARY, block, 5)
    # Spots of both colours: to trace their outlines would take a second.
    stats = np.concatenate([cv2.connectedComponentsWithStats(spots, connectivity=4)[2]
                            for spots in (black_white, 255 - black_white)])
    boxes = stats[:, cv2.CC_STAT_WIDTH] * stats[:, cv2.CC_STAT_HEIGHT]
    return int((boxes >= _LEAST_OUTLINE_PX).sum())


def why_not_found(
    grey: np.ndarray, columns: int, rows: int, until: float = math.inf
) -> str:
    """
    Look for a board of nearly these counts, or a part of one, and describe it.

    :param grey: Shape (h, w), uint8: a picture in which no board of these counts was found.
    :param until: A time of time.monotonic() after which no try begins.
    """
    scale = min(1.0, SEARCH_WIDTH / max(grey.shape))
    grey = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    # One call that finds most boards; the others take some seconds.
    part = any_board(grey)
    if part is not None and sorted(part.shape[:2]) != sorted((columns, rows)):
        return part_text(grey, part, columns, rows)
    quiet = _quiet(grey)
    for other in _nearby_counts(columns, rows) if quiet is not None else ():
        if time.monotonic() > until:
            break
        corners = _classical_once(quiet, *other)
        if corners is not None and is_board(grey, corners):
            more_columns, more_rows = count_beyond(grey, corners)
            return other_counts(columns, rows, other[0] + more_columns, other[1] + more_rows,
                                edges_reached(grey, corners))
    edges = _cut_off_at(grey, columns, rows, until)
    return _whole_board_text(edges) if edges else not_found_text(columns, rows)


def not_found_text(columns: int, rows: int) -> str:
    """Say that a picture shows no board, where nothing tells why."""
    return (
        f'no chessboard with {columns} x {rows} inner corners found: the whole board must be in '
        'the picture with a white margin, evenly lit and sharp, and its inner corners counted '
        'where four squares meet (one less than the squares in each direction)')


def any_board(grey: np.ndarray) -> Optional[np.ndarray]:
    """
    Find the chessboard that a picture shows, whatever its counts, or the part that it shows.

    :param grey: Shape (h, w), uint8.
    :returns: Shape (rows, columns, 2), in px; None if there is none.
    """
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_LARGER
    found, corners, cells = cv2.findChessboardCornersSBWithMeta(grey, (3, 3), flags=flags)
    if not found:
        return None
    corners = corners.reshape(*cells.shape, 2).astype(float)
    return corners if is_pattern(grey, corners) else None


def part_text(
    grey: np.ndarray, part: np.ndarray, columns: int, rows: int
) -> str:
    """
    Say why a board that a picture shows is not the one that is looked for.

    :param part: Shape (rows, columns, 2), see :func:`any_board`.
    """
    edges = edges_reached(grey, part)
    more_columns, more_rows = count_beyond(grey, part)
    found = part.shape[1] + more_columns, part.shape[0] + more_rows
    # It cannot be told which way the board lies: as near to what is looked for as it can be.
    found = min(found, found[::-1], key=lambda counts: abs(counts[0] - columns)
                + abs(counts[1] - rows))
    if edges and found[0] <= columns and found[1] <= rows:
        return _whole_board_text(edges)
    return other_counts(columns, rows, *found, edges)


def _cut_off_at(
    grey: np.ndarray, columns: int, rows: int, until: float
) -> Sequence[str]:
    """Name the picture's edges that cut a board off, as far as a part of it can be found."""
    parts = [*((fewer, rows) for fewer in range(columns - 1, 2, -1)),
             *((columns, fewer) for fewer in range(rows - 1, 2, -1))]
    for counts in parts[:MOST_PARTS]:
        if time.monotonic() > until:
            break
        found, corners = cv2.findChessboardCornersSB(
            grey, counts, flags=cv2.CALIB_CB_NORMALIZE_IMAGE)
        if found:
            part = corners.reshape(counts[1], counts[0], 2).astype(float)
            edges = edges_reached(grey, part) if is_pattern(grey, part) else []
            if edges:
                return edges
    return []


def _nearby_counts(columns: int, rows: int) -> Sequence[Tuple[int, int]]:
    near = [(columns + x, rows + y) for x in range(-2, 3) for y in range(-2, 3) if x or y]
    near = [counts for counts in near if min(counts) >= 3]
    return sorted(near, key=lambda counts: abs(counts[0] - columns) + abs(counts[1] - rows))


def other_counts(
    columns: int, rows: int, found_columns: int, found_rows: int, edges: Sequence[str] = ()
) -> str:
    """
    Say that a board has other counts than those that were asked for.

    :param edges: Names of the picture's edges that cut the board off.
    """
    cut_off = f'{_cut_off_text(edges)}, or ' if edges else ''
    return (
        f'the board in the picture has {found_columns} x {found_rows} inner corners, not '
        f'{columns} x {rows}: {cut_off}give --corners {found_columns}x{found_rows}')


def _whole_board_text(edges):
    return f'{_cut_off_text(edges)}: the whole board must be in it, with a white margin'


def _cut_off_text(edges):
    return f'the board is cut off by the {" and the ".join(edges)} edge of the picture'
