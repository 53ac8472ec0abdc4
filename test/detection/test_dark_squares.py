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

from camera_to_base.detection.dark_squares import DarkSquares
import numpy as np
import pytest

LIMITS = np.full((480, 640), 100, np.uint8)


def frame_with(*squares, size=(480, 640), edge=20):
    frame = np.full((*size, 3), 200, np.uint8)
    for x, y in squares:
        frame[max(y, 0):y + edge, max(x, 0):x + edge] = 20
    return frame


def contains(box, x, y, edge=20):
    return (box.rows.start <= max(y, 0) and box.rows.stop >= min(y + edge, 480)
            and box.columns.start <= max(x, 0) and box.columns.stop >= min(x + edge, 640))


def test_a_square_is_found_at_every_place():
    squares = DarkSquares(LIMITS, 20, 2)
    missed = []
    for x, y in [*((x, 100) for x in range(-10, 631)), *((100, y) for y in range(-10, 471))]:
        box, = squares.boxes(frame_with((x, y)))
        if not contains(box, x, y):
            missed.append((x, y))
    assert missed == []


def test_far_squares_have_a_box_each_and_near_ones_share_one():
    squares = DarkSquares(LIMITS, 20, 2)
    boxes = squares.boxes(frame_with((20, 30), (590, 40), (300, 420)))
    assert len(boxes) == 3
    boxes = squares.boxes(frame_with((20, 30), (590, 420), (42, 52)))
    assert len(boxes) == 2
    assert any(contains(box, 20, 30) and contains(box, 42, 52) for box in boxes)


@pytest.mark.parametrize('edge', [1, 2, 5, 9])
def test_dirt_and_lines_that_the_closing_removes_have_no_box(edge):
    frame = frame_with(*((x, y) for x in range(0, 620, 37) for y in range(0, 460, 41)), edge=edge)
    frame[:, 312:312 + edge] = 20
    assert DarkSquares(LIMITS, 20, 2).boxes(frame) == []


def test_only_the_given_rows_are_searched():
    squares, frame = DarkSquares(LIMITS, 20, 2), frame_with((20, 30), (300, 400))
    box, = squares.boxes(frame, slice(380, 450))
    assert contains(box, 300, 400) and box.rows.start > 300
    assert squares.boxes(frame, slice(201, 209)) == []


def test_the_limit_is_that_of_the_surroundings():
    limits = LIMITS.copy()
    limits[:, 320:] = 0
    squares = DarkSquares(limits, 20, 2)
    assert squares.boxes(frame_with((500, 100))) == []
    assert len(squares.boxes(frame_with((300, 100)))) == 1


@pytest.mark.parametrize('closing_size', [1, 2, 3])
def test_a_small_kernel_finds_small_squares_wherever_they_lie(closing_size):
    rng, squares = np.random.default_rng(5), DarkSquares(LIMITS, closing_size, 0)
    missed = []
    for case in range(100):
        edge = int(rng.integers(3, 5))
        places = [(int(x), int(y)) for x, y in rng.integers(0, (600, 440), (4, 2))]
        boxes = squares.boxes(frame_with(*places, edge=edge))
        if not all(any(contains(box, x, y, edge) for box in boxes) for x, y in places):
            missed.append(case)
    assert missed == []
