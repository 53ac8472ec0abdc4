# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What a person who lays a board is told about the newest picture."""

from camera_to_base.calibration.boards.board import find_board
from camera_to_base.calibration.boards.placement import look_for, PrintedBoard
import cv2
import numpy as np
import pytest
from rendered_board import pixel_from_surface, render

BOARD = PrintedBoard((9, 6), 25.0)


@pytest.mark.parametrize('tilt, yaw, noise', [(0, 0, 0), (40, 20, 2), (20, 130, 5), (50, 0, 2)])
def test_a_board_is_found_with_all_its_corners(tilt, yaw, noise):
    picture = render(pixel_from_surface(tilt, yaw), noise=noise)
    look = look_for(BOARD, picture)
    assert look.is_found and look.sentence == '54 of 54 corners found'
    assert look.sharpness == 'sharp'
    exact = find_board(picture, 9, 6).pixels
    away = np.linalg.norm(look.corners[:, None] - exact[None], axis=2)
    assert away.min(axis=0).max() < 2 and away.min(axis=1).max() < 2


@pytest.mark.parametrize('blur, word', [(0, 'sharp'), (1.5, 'soft'), (3, 'blurred')])
def test_sharpness_is_told_in_a_word(blur, word):
    picture = render(pixel_from_surface(10), noise=2)
    assert look_for(BOARD, cv2.GaussianBlur(picture, (0, 0), blur) if blur else picture
                    ).sharpness == word


def test_a_large_picture_gives_corners_in_its_own_pixels():
    picture = render(pixel_from_surface(20))
    large = cv2.resize(picture, None, fx=3, fy=3)
    small_corners, corners = look_for(BOARD, picture).corners, look_for(BOARD, large).corners
    away = np.linalg.norm(corners[:, None] / 3 - small_corners[None], axis=2)
    assert away.min(axis=0).max() < 1.5


@pytest.mark.parametrize('picture, said', [
    (render(pixel_from_surface(), columns=8, rows=6), '8 x 6 inner corners, not 9 x 6'),
    (render(pixel_from_surface(), columns=7, rows=5), '7 x 5 inner corners, not 9 x 6'),
    (render(pixel_from_surface(10))[:, 200:], 'the board is cut off by the left edge'),
    (np.full((480, 640, 3), 200, np.uint8), 'no chessboard with 9 x 6 inner corners found'),
])
def test_why_no_board_is_found_is_said_as_the_command_says_it(picture, said):
    look = look_for(BOARD, picture)
    assert not look.is_found and len(look.corners) == 0 and said in look.sentence
    assert look.sharpness is None
    with pytest.raises(Exception, match=said):
        find_board(picture, 9, 6)


def test_a_board_with_markers_says_how_many_corners_it_shows():
    marked = PrintedBoard((9, 6), 25.0, has_markers=True)
    look = look_for(marked, render(pixel_from_surface(), noise=2))
    assert not look.is_found and 'corners of a ChArUco board found' in look.sentence
