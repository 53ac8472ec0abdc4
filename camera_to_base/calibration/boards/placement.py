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

from typing import List, NamedTuple, Sequence

from camera_to_base.calibration.boards.printed_board import PrintedBoard
from camera_to_base.calibration.coverage_map import covered_shares
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
