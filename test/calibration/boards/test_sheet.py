# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The chessboard to print."""

import re

from camera_to_base.calibration.boards.board import find_board
from camera_to_base.calibration.boards.sheets import has_one_origin, PAPERS, sheet_content
from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np
import pytest

DOTS_PER_MM = 300 / 25.4


@pytest.mark.slow
@pytest.mark.parametrize('paper, columns, rows, square_mm', [
    ('A4', 9, 6, 25),
    pytest.param('Letter', 9, 6, 25, marks=pytest.mark.slow),
    pytest.param('A4', 6, 9, 20, marks=pytest.mark.slow),
    pytest.param('A3', 8, 5, 40, marks=pytest.mark.slow)])
def test_printed_board_is_found_with_its_size_and_its_origin(paper, columns, rows, square_mm):
    content = sheet_content(paper, columns, rows, square_mm, 'png')
    picture = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR)
    assert sorted(np.array(picture.shape[:2]) / DOTS_PER_MM) == pytest.approx(
        sorted(PAPERS[paper]), abs=0.1)
    for turn in range(4):
        turned = np.ascontiguousarray(np.rot90(picture, turn))
        corners = find_board(turned, columns, rows).corners / DOTS_PER_MM
        steps = np.linalg.norm(corners[0, -1] - corners[0, 0]) / (columns - 1)
        assert steps == pytest.approx(square_mm, abs=0.01)
        if turn == 0:
            # As the arrows show: at the top left, x to the right.
            origin, along_x = corners[0, 0], corners[0, 1] - corners[0, 0]
            assert origin[0] < corners[..., 0].mean() and origin[1] < corners[..., 1].mean()
            np.testing.assert_allclose(along_x, [square_mm, 0], atol=0.05)


@pytest.mark.parametrize('paper, columns, size_mm', [('A4', 9, (297, 210)), ('A4', 5, (210, 297)),
                                                     ('Letter', 9, (279.4, 215.9))])
def test_page_has_the_papers_size(paper, columns, size_mm):
    points = [72 * length / 25.4 for length in size_mm]
    page = re.search(rb'/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]',
                     sheet_content(paper, columns, 6, 20, 'pdf'))
    assert [float(length) for length in page.groups()] == pytest.approx(points, abs=0.01)
    drawing = re.search(rb'width="([\d.]+)pt" height="([\d.]+)pt"',
                        sheet_content(paper, columns, 6, 20, 'svg'))
    assert [float(length) for length in drawing.groups()] == pytest.approx(points, abs=0.01)


def test_board_that_does_not_fit_is_refused_with_the_square_that_does():
    with pytest.raises(InvalidValueError, match='10 x 7 squares of 26 mm does not fit on A4: '
                                                'squares of 25 mm do'):
        sheet_content('A4', 9, 6, 26)


def test_board_of_one_even_and_one_odd_count_has_one_origin():
    assert has_one_origin(9, 6) and not has_one_origin(8, 6) and not has_one_origin(7, 5)
