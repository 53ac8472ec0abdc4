# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Chessboards that the tests render themselves."""

import time

from camera_to_base.calibration.boards.board import board_points, find_board
from camera_to_base.calibration.boards.board_search import search, why_not_found
from camera_to_base.errors import CalibrationError, InvalidValueError
import cv2
import numpy as np
import pytest
from rendered_board import pixel_from_surface, project, render

CORNERS = board_points(9, 6, 25)


@pytest.mark.parametrize('tilt, coefficient, noise, blur, tolerance', [
    (0, 0, 0, 0, 0.1), (40, -0.2, 2, 0, 0.15), (30, -0.2, 6, 1.5, 0.4), (55, 0, 2, 0.7, 0.4),
])
def test_corners_are_found_to_a_fraction_of_a_pixel(tilt, coefficient, noise, blur, tolerance):
    homography = pixel_from_surface(tilt)
    image = render(homography, coefficient=coefficient, noise=noise, blur=blur)
    found = find_board(image, 9, 6).pixels
    truth = project(homography, CORNERS, coefficient)
    assert np.linalg.norm(found - truth, axis=1).max() < tolerance


@pytest.mark.parametrize('yaw', range(0, 360, 45))
def test_the_origin_stays_on_the_board_however_it_lies(yaw):
    homography = pixel_from_surface(20, yaw)
    found = find_board(render(homography), 9, 6)
    np.testing.assert_allclose(found.pixels, project(homography, CORNERS), atol=0.3)


@pytest.mark.parametrize('columns, rows', [(7, 5), (8, 6), (6, 6), (5, 5)])
@pytest.mark.parametrize('yaw', [10, 100, 190, 280])
def test_a_board_that_turns_into_itself_starts_nearest_to_the_top_left(columns, rows, yaw):
    middle = (1.25 * (columns - 1), 1.25 * (rows - 1))
    image = render(pixel_from_surface(10, yaw, middle=middle), columns=columns, rows=rows)
    corners = find_board(image, columns, rows).corners
    ends = np.array([corners[0, 0], corners[-1, -1]])
    assert np.argmin(np.linalg.norm(ends, axis=1)) == 0
    x, y = corners[0, -1] - corners[0, 0], corners[-1, 0] - corners[0, 0]
    assert x[0] * y[1] - x[1] * y[0] > 0


def test_rows_and_columns_can_change_places():
    image = render(pixel_from_surface())
    assert find_board(image, 6, 9).corners.shape == (9, 6, 2)


def test_the_larger_of_two_boards_is_taken():
    large = render(pixel_from_surface(10, 0, away_cm=70, middle=(24, 6)))
    small = render(pixel_from_surface(10, 0, away_cm=110, middle=(-12, 6)))
    both = np.hstack([large[:, :340], small[:, 340:]])
    found = find_board(both, 9, 6)
    assert found.second_board and found.pixels[:, 0].max() < 340
    assert not find_board(large, 9, 6).second_board


@pytest.mark.parametrize('columns, rows', [(8, 6), (9, 5), (10, 6), (8, 5), (7, 6)])
def test_other_counts_are_refused_with_the_right_ones(columns, rows):
    with pytest.raises(CalibrationError, match='(9 x 6|6 x 9) inner corners, not'):
        find_board(render(pixel_from_surface()), columns, rows)


@pytest.mark.slow
def test_a_picture_without_a_board_is_refused_with_advice():
    noise = np.random.default_rng(0).integers(0, 255, (240, 320, 3), np.uint8)
    for image in (np.full((240, 320, 3), 128, np.uint8), noise):
        with pytest.raises(CalibrationError, match='no chessboard with 9 x 6 .* evenly lit'):
            find_board(image, 9, 6)


@pytest.mark.parametrize('middle, edge', [
    ((-6, 6.25), 'right'), ((26, 6.25), 'left'), ((10, -8), 'bottom'), ((10, 21), 'top')])
def test_board_that_the_picture_cuts_off_is_refused_with_the_edge(middle, edge):
    with pytest.raises(CalibrationError, match=f'the board is cut off by the {edge} edge'):
        find_board(render(pixel_from_surface(10, 0, middle=middle)), 9, 6)


@pytest.mark.parametrize('width, height, message', [
    (1, 1, '1 x 1 px is too small to show 10 x 7 squares'), (640, 20, '640 x 20 px is too small'),
    (12000, 9, 'picture of 12000 x 9 px is larger than a frame can be, .* 1..10000')])
def test_picture_of_a_size_that_shows_no_board_is_refused(width, height, message):
    with pytest.raises(InvalidValueError, match=message):
        find_board(np.zeros((height, width, 3), np.uint8), 9, 6)


def test_board_is_found_in_a_large_picture():
    image = cv2.resize(render(pixel_from_surface()), (4480, 3360))
    found = find_board(image, 9, 6).pixels
    np.testing.assert_allclose((found + 0.5) / 7 - 0.5,
                               project(pixel_from_surface(), CORNERS), atol=0.3)


def test_what_is_no_picture_or_no_board_is_refused():
    with pytest.raises(InvalidValueError, match='inner corners along a column must be 3'):
        find_board(np.zeros((9, 9, 3), np.uint8), 9, 2)
    with pytest.raises(InvalidValueError, match='uint8'):
        find_board(np.zeros((9, 9, 3)), 9, 6)


@pytest.mark.parametrize('corner, first, last', [
    (0, (0, 0), (20, 12.5)), (1, (20, 0), (0, 12.5)), (2, (20, 12.5), (0, 0)),
    (3, (0, 12.5), (20, 0)),
])
def test_each_corner_can_be_the_origin(corner, first, last):
    points = board_points(9, 6, 25, origin_corner=corner)
    np.testing.assert_allclose(points[[0, -1]], [first, last])


def test_the_frame_can_lie_elsewhere():
    points = board_points(9, 6, 25, origin_mm=(25, 0), yaw_deg=90)
    # Seen from 25 mm along x and turned towards y, the first corner lies to the side, at +y.
    np.testing.assert_allclose(points[:2], [[0, 2.5], [0, 0]], atol=1e-12)


@pytest.mark.parametrize('options', [{'square_mm': 0}, {'square_mm': 25, 'origin_corner': 4},
                                     {'square_mm': 25, 'yaw_deg': np.nan},
                                     {'square_mm': 25, 'origin_mm': (1,)}])
def test_a_frame_that_makes_no_sense_is_refused(options):
    with pytest.raises(InvalidValueError, match='must be'):
        board_points(9, 6, **options)


@pytest.mark.slow
def test_noise_of_an_empty_table_is_no_board():
    noise = np.random.default_rng(0).normal(128, 4, (480, 640, 3)).clip(0, 255).astype(np.uint8)
    with pytest.raises(CalibrationError, match='no chessboard with 9 x 6'):
        find_board(noise, 9, 6)


@pytest.mark.slow
def test_search_begins_nothing_after_its_time():
    begun, large = time.monotonic(), np.full((3000, 4000), 128, np.uint8)
    assert search(large, 9, 6, until=begun) is None
    full = time.monotonic() - begun
    assert why_not_found(large[:480, :640], 9, 6, until=begun).startswith('no chessboard')
    assert full < 10
