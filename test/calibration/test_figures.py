# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The figures of a calibration."""

from camera_to_base.calibration.figures import coverage, error_figures, tilt, tilt_of, warnings
from camera_to_base.calibration.homography_fit import fit_homography
from camera_to_base.surface.models import HomographySurface
from camera_to_base.surface.points import Hull, MatchedPoints
import numpy as np
import pytest
from rendered_board import IMAGE_SIZE, pixel_from_surface, project

GRID = np.array([[x, y] for y in np.linspace(0, 12.5, 6) for x in np.linspace(0, 20, 9)])


def test_errors_are_summed_up_in_millimetres():
    figures = error_figures([0.3, 0.0, 0.4], (2, 3, 4), [0.6, 0.6, 0.6])
    assert (figures.points, figures.worst_row) == (3, 4)
    assert figures.mean_mm == pytest.approx(7 / 3)
    assert figures.rms_mm == pytest.approx(np.sqrt(25 / 3))
    assert figures.max_mm == pytest.approx(4)
    assert figures.leave_one_out_rms_mm == pytest.approx(6)


def test_coverage_is_the_share_of_the_hull():
    assert coverage(Hull([[0, 0], [320, 0], [0, 480]]), IMAGE_SIZE) == pytest.approx(0.25)


@pytest.mark.parametrize('degrees', [5, 30, 60])
@pytest.mark.parametrize('yaw', [0, 40, 200])
def test_tilt_is_read_from_an_exact_homography(degrees, yaw):
    surface = HomographySurface(np.linalg.inv(pixel_from_surface(degrees, yaw)))
    assert tilt_of(surface) == pytest.approx(degrees, abs=1e-6)


@pytest.mark.parametrize('degrees, noise, told', [(40, 0.1, True), (2, 2.0, False)])
def test_tilt_is_told_only_where_all_points_agree(degrees, noise, told):
    pixels = project(pixel_from_surface(degrees), GRID[::3])
    pixels = pixels + np.random.default_rng(0).normal(0, noise, pixels.shape)
    fit = fit_homography(MatchedPoints(GRID[::3], pixels), IMAGE_SIZE)
    value = tilt(fit.surface, fit.without)
    assert value == pytest.approx(degrees, abs=2) if told else value is None


def test_a_leave_one_out_error_much_above_the_rms_is_a_warning():
    quiet = error_figures([0.01], (1,), [0.015])
    loud = error_figures([0.01], (1,), [0.05])
    assert warnings(quiet, 0.5) == []
    assert 'much more than' in warnings(loud, 0.5)[0]
    assert 'cover only 3 %' in warnings(quiet, 0.03)[0]
    assert 'too few points' in warnings(error_figures([0.01], (1,)), 0.5)[0]
