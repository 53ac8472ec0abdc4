# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Each term grows with what it comes from, and says what is not known."""

import math

from camera_to_base.coordinate_transform import CameraPlace
from camera_to_base.errors import InvalidValueError
from camera_to_base.surface.models import HomographySurface, ParallelSurface
from camera_to_base.uncertainty import (
    base_error, centre_covariance, error_ellipse, FrameState, likely_place,
    PositionUncertainty, radius_for, Shape, ShiftMean, Spread, surface_covariance, symmetric,
    triangle_of, UNKNOWN_ANGLE)
import numpy as np
import pytest

SIZE = 640, 480
STILL = FrameState(SIZE, 2.0)
COIN = Shape((320.0, 240.0), 1256.0, Spread(100.0, 0.0, 100.0), contrast=100.0)
EXACT = np.zeros((14, 14))


def deviation(shape, noise=2.0, floor_px=0.0):
    return math.sqrt(centre_covariance(shape, noise, floor_px).uu)


def test_centre_is_less_certain_where_contrast_is_low_or_the_object_small():
    small = COIN._replace(area=78.5, spread=Spread(6.25, 0.0, 6.25))
    assert deviation(COIN) == pytest.approx(0.003, abs=0.001)
    assert deviation(COIN._replace(contrast=25.0)) == pytest.approx(4 * deviation(COIN))
    assert deviation(small) > 1.9 * deviation(COIN)
    assert deviation(COIN._replace(edge_width=4.0)) == pytest.approx(2 * deviation(COIN))
    assert deviation(COIN, noise=8.0) == pytest.approx(4 * deviation(COIN))
    assert deviation(COIN, floor_px=0.2) == pytest.approx(0.2, abs=0.001)


def test_object_that_is_cut_off_may_have_a_part_as_large_as_itself_missing():
    assert deviation(COIN._replace(is_cut_off=True)) == pytest.approx(20, rel=0.01)


def test_direction_is_known_better_for_a_long_object():
    parts = PositionUncertainty(ParallelSurface(36.0, 640), EXACT, centre_floor_px=0.2)
    bar = Shape((320.0, 240.0), 800.0, Spread(533.0, 0.0, 8.3), 100.0, has_yaw=True)
    stub = bar._replace(spread=Spread(40.0, 0.0, 25.0))
    assert parts.covariance(COIN, STILL).yaw == UNKNOWN_ANGLE
    assert 0 < parts.covariance(bar, STILL).yaw < parts.covariance(stub, STILL).yaw < 0.1


def test_error_in_the_picture_becomes_one_on_the_surface():
    parts = PositionUncertainty(ParallelSurface(32.0, 640), EXACT, centre_floor_px=2.0)
    covariance = parts.covariance(COIN, STILL)
    assert math.sqrt(covariance.xx) == pytest.approx(0.1, rel=0.01)
    assert covariance.zz == pytest.approx(0.01)


def test_height_counts_by_the_tangent_of_the_viewing_angle():
    parts = PositionUncertainty(
        ParallelSurface(32.0, 640), EXACT, CameraPlace((16.0, 12.0), 50.0),
        height_tolerance_cm=1.0)
    below = parts.at_pixels(np.array([[320.0, 240.0]]), SIZE)[0]
    aside = parts.at_pixels(np.array([[620.0, 240.0]]), SIZE)[0]
    assert below == pytest.approx(np.zeros((2, 2)))
    assert math.sqrt(aside[0, 0]) == pytest.approx(15.0 / 50.0)
    assert aside[1, 1] == pytest.approx(0)


def test_camera_is_estimated_where_it_was_not_measured():
    place = likely_place(ParallelSurface(36.0, 640).locate, SIZE)
    assert place.height_cm == pytest.approx(36.0, rel=1e-3)
    assert place.foot_cm == pytest.approx((17.97, 13.47), abs=0.01)


def test_shift_of_the_view_counts_by_its_mean_square_and_is_forgotten():
    mean = ShiftMean()
    assert mean.deviation_px == 0
    for _ in range(100):
        mean.add(1.0)
    assert mean.deviation_px == pytest.approx(math.sqrt(0.5))
    for _ in range(300):
        mean.add(0.0)
    assert mean.deviation_px < 0.01


def test_calibration_without_covariance_counts_as_uncertain():
    parts = PositionUncertainty(ParallelSurface(36.0, 640), surface_covariance([]))
    pixels = np.array([[320.0, 240.0], [635.0, 475.0]])
    middle, corner = np.sqrt(parts.at_pixels(pixels, SIZE)[:, [0, 1], [0, 1]].max(axis=1))
    assert 0.3 < middle < 0.7 and 1.0 < corner < 2.0


def test_place_beyond_the_horizon_is_not_known_but_finite():
    tilted = HomographySurface(np.array([[0.05, 0, 0], [0, 0.05, 0], [0, 0.004, -0.3]]))
    found = PositionUncertainty(tilted, EXACT).covariance(
        COIN._replace(pixel=(320.0, 20.0)), STILL)
    assert all(map(math.isfinite, found)) and found.xx == 1e6


@pytest.mark.parametrize('numbers', [
    [-1.0] + 104 * [0.0], [1.0, 5.0] + 103 * [0.0]])
def test_numbers_that_are_no_covariance_are_refused(numbers):
    with pytest.raises(InvalidValueError, match='surface.covariance must be the upper triangle'):
        surface_covariance(numbers)


def test_triangle_comes_back_as_the_matrix_that_it_was_made_of():
    matrix = np.array([[2.0, 0.5], [0.5, 1.0]])
    assert triangle_of(matrix) == [2.0, 0.5, 1.0]
    assert symmetric(triangle_of(matrix), 2).tolist() == matrix.tolist()


def test_base_is_less_certain_where_pairs_are_few_or_near_each_other():
    random = np.random.default_rng(3)
    near = np.pad(random.uniform(-5, 5, (6, 2)), ((0, 0), (0, 1)))
    left_out = np.pad(random.normal(0, 0.1, (6, 2)), ((0, 0), (0, 1)))
    by_near, by_far = (base_error(scale * near, left_out, True) for scale in (1, 4))
    assert by_near[5, 5] == pytest.approx(16 * by_far[5, 5], rel=1e-6)
    rough = base_error(near, 5 * left_out, True)
    assert rough[5, 5] > 4 * base_error(near, left_out, True)[5, 5]
    # Without residuals a touch counts with 1 mm, in each of two pairs' 20 cm apart.
    ends = np.array([[-10.0, 0.0, 0.0], [10.0, 0.0, 0.0]])
    assert base_error(ends, None, True)[5, 5] == pytest.approx(0.1 ** 2 / 200)


def test_ellipse_of_a_share_contains_it():
    covariance = np.array([[4.0, 1.5], [1.5, 1.0]])
    errors = np.random.default_rng(5).multivariate_normal([0, 0], covariance, 20000)
    ellipse = error_ellipse(covariance, 0.9)
    turn = np.array([[math.cos(ellipse.angle), math.sin(ellipse.angle)],
                     [-math.sin(ellipse.angle), math.cos(ellipse.angle)]])
    inside = np.sum((errors @ turn.T / [ellipse.long, ellipse.short]) ** 2, axis=1) < 1
    assert inside.mean() == pytest.approx(0.9, abs=0.01)
    assert radius_for(0.95) == pytest.approx(2.4477, abs=1e-4)
