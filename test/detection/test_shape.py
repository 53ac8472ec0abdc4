# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math

from camera_to_base.detection.detection import polygon_centroid, principal_axes
import numpy as np
import pytest

TRIANGLE = np.array([[1.0, 2.0], [7.0, 2.0], [1.0, 5.0]])


def spread_of_ellipse(length, width, angle):
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    return turn @ np.diag([length**2, width**2]) @ turn.T / 16


@pytest.mark.parametrize('angle', [-1.5, -0.7, 0.0, 0.4, 1.2, math.pi / 2])
def test_axes_of_an_ellipse_are_its_diameters_and_its_direction(angle):
    axes = principal_axes(spread_of_ellipse(5.0, 2.0, angle))
    assert axes == pytest.approx((angle, 5.0, 2.0))
    assert axes.elongation == pytest.approx(2.5)


def test_shape_narrower_than_a_pixel_has_a_finite_elongation():
    assert principal_axes(spread_of_ellipse(5.0, 0.5, 0.3)).elongation == pytest.approx(10.0)


@pytest.mark.parametrize('mixed', [0.0, -0.0])
def test_upright_shape_always_points_the_same_way(mixed):
    assert principal_axes(np.array([[1.0, mixed], [mixed, 4.0]])).angle == math.pi / 2


def test_line_is_infinitely_longer_than_wide():
    assert principal_axes(spread_of_ellipse(3.0, 0.0, 0.0)).elongation == math.inf


@pytest.mark.parametrize('corners', [TRIANGLE, TRIANGLE[::-1]])
def test_polygon_has_the_same_centroid_whichever_way_round(corners):
    assert polygon_centroid(corners) == pytest.approx([3.0, 3.0])


def test_centroid_of_a_polygon_without_an_area_is_that_of_its_corners():
    line = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 0.0]])
    assert polygon_centroid(line) == pytest.approx([2.0, 0.0])
