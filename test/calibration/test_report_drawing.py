# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The report picture."""

from camera_to_base.calibration.boards.board import board_points, find_board
from camera_to_base.calibration.homography_fit import fit_homography
from camera_to_base.calibration.result import ARROW, report_panels, report_picture, round_step
from camera_to_base.surface.points import MatchedPoints, surface_extent, top_view
import numpy as np
import pytest
from rendered_board import IMAGE_SIZE, pixel_from_surface, project, render


def fitted(corner=0):
    image = render(pixel_from_surface(35))
    matched = MatchedPoints(board_points(9, 6, 25, origin_corner=corner),
                            find_board(image, 9, 6).pixels)
    return image, matched, fit_homography(matched, IMAGE_SIZE).surface


@pytest.mark.slow
@pytest.mark.parametrize('corner', [0, 1, 2, 3])
def test_squares_are_square_and_not_mirrored_from_above(corner):
    image, matched, surface = fitted(corner)
    above, project_above = top_view(image, surface, matched, surface_extent(matched.points, 2.5),
                                    600)
    expected = project_above(matched.points).reshape(6, 9, 2)
    found = find_board(above, 9, 6).corners
    np.testing.assert_allclose(found, expected, atol=0.7)
    sides = [np.linalg.norm(np.diff(found, axis=axis), axis=2) for axis in (0, 1)]
    np.testing.assert_allclose(sides[0].mean(), sides[1].mean(), rtol=0.005)


@pytest.mark.slow
def test_a_bad_fit_looks_bad():
    image, matched, surface = fitted()
    lattice = matched.points.reshape(6, 9, 2)
    shifted = MatchedPoints(matched.points + np.array([[0.2, 0.0]]), matched.pixels)
    red = [(report_picture(report_panels(
        surface, points, IMAGE_SIZE, image=image, lattice=lattice))
            == ARROW).all(axis=2).sum() for points in (matched, shifted)]
    assert red[1] > 3 * red[0]


def test_a_table_is_drawn_on_an_empty_picture():
    points = np.array([[0, 0], [20, 0], [0, 12], [20, 12], [7, 5]], float)
    matched = MatchedPoints(points, project(pixel_from_surface(60), points))
    surface = fit_homography(matched, IMAGE_SIZE).surface
    picture = report_picture(report_panels(surface, matched, IMAGE_SIZE), ('one', 'two'))
    assert picture.dtype == np.uint8 and picture.shape[0] == 640 + 3 * 34


@pytest.mark.parametrize('length, step', [(0.9, 1), (1.0, 1), (2.4, 5), (0.013, 0.02), (70, 100)])
def test_steps_are_round(length, step):
    assert round_step(length) == pytest.approx(step)
