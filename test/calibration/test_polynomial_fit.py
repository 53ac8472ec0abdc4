# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The tutorial's tilted camera, from a table."""

from camera_to_base.calibration.figures import left_out_errors
from camera_to_base.calibration.polynomial_fit import fit_polynomial
from camera_to_base.errors import CalibrationError
from camera_to_base.surface.models import PolynomialSurface
from camera_to_base.surface.points import MatchedPoints
import numpy as np
import pytest
from rendered_board import IMAGE_SIZE

TUTORIAL = PolynomialSurface()
GRID = np.array([[x, y] for y in (2.0, 5.0, 8.0, 11.0, 13.0) for x in (-6.0, 0.0, 6.0)])


def test_the_tutorials_table_gives_the_tutorials_equations():
    fit = fit_polynomial(MatchedPoints(GRID, TUTORIAL.pixels(GRID)), IMAGE_SIZE)
    np.testing.assert_allclose(fit.surface.y_of_v, TUTORIAL.y_of_v, rtol=1e-9)
    np.testing.assert_allclose(fit.surface.px_per_cm_of_y, TUTORIAL.px_per_cm_of_y, rtol=1e-9)
    assert fit.surface.centre_u == pytest.approx(292, abs=1e-9)
    assert fit.y_r_squared == pytest.approx(1) and fit.px_per_cm_r_squared == pytest.approx(1)
    assert fit.equations == ('y = 6e-05 v^2 - 0.0833 v + 25.848',
                             'px_per_cm = 0.0625 y^2 - 1.6393 y + 29.071')
    np.testing.assert_allclose(fit.surface.locate([[417, 265]]), [[6.26, 7.99]], atol=0.01)


def test_a_centre_line_with_one_more_point_in_each_row_is_enough():
    points = np.array([[x, y] for y in (2.0, 6.0, 10.0) for x in (0.0, 5.0)])
    fit = fit_polynomial(MatchedPoints(points, TUTORIAL.pixels(points)), IMAGE_SIZE)
    np.testing.assert_allclose(fit.surface.y_of_v, TUTORIAL.y_of_v, rtol=1e-9)
    assert left_out_errors(fit.without, MatchedPoints(points, TUTORIAL.pixels(points))) is None


def test_r_squared_falls_with_noise():
    pixels = TUTORIAL.pixels(GRID) + np.random.default_rng(0).normal(0, 3, GRID.shape)
    fit = fit_polynomial(MatchedPoints(GRID, pixels), IMAGE_SIZE)
    assert 0.9 < fit.y_r_squared < 1 and 0.9 < fit.px_per_cm_r_squared < 1
    assert len(left_out_errors(fit.without, MatchedPoints(GRID, pixels))) == 15


def test_points_that_form_no_rows_are_refused():
    points = np.array([[0.0, 1.0], [1.0, 2.0], [2.0, 4.0], [0.0, 9.0]])
    with pytest.raises(CalibrationError, match='at least three values of y_cm'):
        fit_polynomial(MatchedPoints(points, TUTORIAL.pixels(points)), IMAGE_SIZE)


def test_order_of_the_points_does_not_matter():
    pixels = TUTORIAL.pixels(GRID) + np.random.default_rng(0).normal(0, 0.5, GRID.shape)
    order = np.random.default_rng(1).permutation(len(GRID))
    one, other = (fit_polynomial(MatchedPoints(GRID[rows], pixels[rows]), IMAGE_SIZE).surface
                  for rows in (np.arange(len(GRID)), order))
    np.testing.assert_allclose(other.locate(pixels), one.locate(pixels), atol=1e-9)
