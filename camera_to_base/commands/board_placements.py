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

"""A placement of a board: one picture, and the corners that it shows."""

import argparse
from typing import List, NamedTuple, Tuple

from camera_to_base.calibration import board_points, covered_shares, find_board, find_charuco
from camera_to_base.errors import CalibrationError
from camera_to_base.surface import Hull, MatchedPoints
import numpy as np

# Mean distance of the corners of two placements below which the board was not moved.
_LEAST_MOVE_PX = 5.0


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
    options: argparse.Namespace, image: np.ndarray, name: str, number: int
) -> Placement:
    """Find the board in a picture; `number` counts the placements from 0."""
    try:
        numbers, pixels, doubts = _corners(options, image)
    except CalibrationError as error:
        if number == 0 and len(options.pictures) < 2:
            raise
        raise CalibrationError(f'{name}: {error}') from error
    points = first_points(options) if number == 0 else _further_points(options)
    return Placement(image, name, MatchedPoints(points[numbers], pixels), numbers,
                     Hull(pixels).corners, doubts)


def first_points(options: argparse.Namespace) -> np.ndarray:
    """Return the board's points where the first placement, which defines the frame, has them."""
    return board_points(
        *options.corners, options.square_mm, origin_corner=options.origin_corner,
        origin_mm=options.origin_mm, yaw_deg=options.yaw_deg)


def _further_points(options: argparse.Namespace) -> np.ndarray:
    # Where it lies does not matter; the origin's corner tells on which side of the surface z is.
    return board_points(
        *options.corners, options.square_mm, origin_corner=options.origin_corner)


def _corners(
    options: argparse.Namespace, image: np.ndarray
) -> Tuple[np.ndarray, np.ndarray, List[str]]:
    """Find the board's corners: their numbers, their pixels, and what is doubtful."""
    columns, rows = options.corners
    if options.charuco:
        return *find_charuco(image, columns, rows), []
    board = find_board(image, columns, rows)
    doubts = ['another such board is in the picture: this is the larger one'
              ] if board.second_board else []
    return np.arange(columns * rows), board.pixels, doubts


def refuse_unlike(placements: List[Placement]) -> None:
    """Refuse pictures of another size, and placements that are the same."""
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


def _distance(one: Placement, other: Placement) -> float:
    """Return how far apart two placements are, in px; infinite without a common corner."""
    _, here, there = np.intersect1d(one.numbers, other.numbers, return_indices=True)
    moves = one.matched.pixels[here] - other.matched.pixels[there]
    return float(np.linalg.norm(moves, axis=1).mean()) if len(moves) else np.inf


def shares_of(placements: List[Placement]) -> np.ndarray:
    """Measure how much of each ninth of the picture the placements cover, shape (3, 3)."""
    height, width = placements[0].image.shape[:2]
    return covered_shares([placement.outline for placement in placements], (width, height))


def outer_edge(placement: Placement) -> np.ndarray:
    """Return about where the board's white margin ends, shape (n, 2), in px."""
    centre = placement.outline.mean(axis=0)
    return centre + 1.6 * (placement.outline - centre)
