# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A board with markers, of which only a part is seen."""

from camera_to_base.calibration.boards.charuco import find_charuco, marker_squares
from camera_to_base.calibration.boards.sheets import sheet_content
from camera_to_base.errors import CalibrationError, InvalidValueError
import cv2
import numpy as np
import pytest

SHEET = cv2.imdecode(np.frombuffer(sheet_content(
    'A4', 9, 6, 25.0, 'png', with_markers=True), np.uint8), cv2.IMREAD_COLOR)
# The first inner corner on the sheet, and a square, in px at 300 dpi.
MM = 300 / 25.4
FIRST = np.array([(297 - 250) / 2 + 25, 12.0 + 25]) * MM - 0.5
SQUARE = 25 * MM


def shown(shift=(0, 0), scale=0.17, tilt=1e-4, noise=2.0):
    """Show the sheet to a camera; give the picture, and the true pixels of all corners."""
    homography = np.array([[scale, 0.02, 30.0 + shift[0]], [-0.015, scale, 40.0 + shift[1]],
                           [tilt * scale, tilt * scale / 2, 1.0]])
    # At twice the size first: the sheet has much more detail than the picture.
    larger = cv2.warpPerspective(SHEET, np.diag([4.0, 4.0, 1.0]) @ homography, (2560, 1920),
                                 flags=cv2.INTER_AREA, borderValue=(190, 190, 190))
    picture = cv2.resize(larger, (640, 480), interpolation=cv2.INTER_AREA)
    # A pixel of the smaller picture is the mean of 4 x 4: its centre moves by 1.5.
    noisy = picture + np.random.default_rng(1).normal(0, noise, picture.shape)
    grid = np.stack(np.meshgrid(np.arange(9), np.arange(6)), axis=-1).reshape(-1, 2)
    true = cv2.perspectiveTransform((FIRST + SQUARE * grid)[None], homography)[0]
    return np.clip(noisy, 0, 255).astype(np.uint8), (4 * true + 0.5) / 4 - 0.5


def test_whole_board_is_found_with_all_corners():
    picture, true = shown()
    found = find_charuco(picture, 9, 6)
    assert found.numbers.tolist() == list(range(54))
    assert np.linalg.norm(found.pixels - true, axis=1).max() < 0.4


@pytest.mark.parametrize('shift', [(-250, 0), (200, 100), (0, -180)])
def test_board_that_is_cut_off_gives_the_corners_that_are_seen(shift):
    picture, true = shown(shift)
    found = find_charuco(picture, 9, 6)
    assert 8 <= len(found.numbers) < 54
    assert np.linalg.norm(found.pixels - true[found.numbers], axis=1).max() < 0.4


def test_covered_corners_are_left_out():
    picture, true = shown()
    cv2.circle(picture, (int(true[22][0]), int(true[22][1])), 70, (120, 150, 190), -1)
    found = find_charuco(picture, 9, 6)
    assert 20 < len(found.numbers) < 50 and 22 not in found.numbers
    assert np.linalg.norm(found.pixels - true[found.numbers], axis=1).max() < 0.4


def test_picture_without_the_board_says_what_is_needed():
    with pytest.raises(CalibrationError, match='0 of 54 inner corners of a ChArUco board found'):
        find_charuco(np.full((480, 640, 3), 128, np.uint8), 9, 6)


def test_board_with_too_many_squares_is_refused():
    assert len(marker_squares(9, 6)) == 35
    with pytest.raises(InvalidValueError, match='needs 450 markers, there are 240'):
        marker_squares(29, 29)


def test_without_the_module_a_sentence_says_what_to_install(monkeypatch):
    monkeypatch.delattr(cv2, 'aruco')
    with pytest.raises(CalibrationError, match='was built without markers: install'):
        find_charuco(np.full((480, 640, 3), 128, np.uint8), 9, 6)
