# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.


from camera_to_base.errors import InvalidValueError
from camera_to_base.surface.parameters import make_hull
from camera_to_base.surface.points import Hull
import numpy as np
import pytest

DIAMOND = [[100, 0], [200, 100], [100, 200], [0, 100]]


@pytest.mark.parametrize('pixel, inside', [
    ((100, 100), True), ((100, 0), True), ((50, 50), True), ((49, 49), False),
    ((300, 100), False)])
def test_hull_contains_what_lies_inside_or_on_its_edge(pixel, inside):
    assert Hull(DIAMOND).contains(pixel) == inside


def test_order_of_the_pixels_and_those_inside_make_no_difference():
    hull = Hull(np.array([*DIAMOND, [100, 90]])[[2, 4, 0, 3, 1]])
    assert hull.area == 20000
    assert sorted(hull.corners.tolist()) == sorted(DIAMOND)


@pytest.mark.parametrize('pixels', [
    np.empty((0, 2)), [[1, 1]], [[1, 1], [2, 2], [3, 3]], [[1, 1], [2, float('nan')], [3, 1]]])
def test_pixels_that_span_no_area_are_refused(pixels):
    with pytest.raises(InvalidValueError, match='hull'):
        Hull(pixels)


def test_hull_of_the_parameters_is_a_flat_list_or_none():
    assert make_hull({'surface.hull': []}) is None
    assert make_hull({'surface.hull': [0, 0, 10, 0, 10, 10]}).area == 50
    with pytest.raises(InvalidValueError, match='u and v, got 3 numbers'):
        make_hull({'surface.hull': [0, 0, 10]})


def test_hull_of_thousands_of_corners_is_refused_at_once():
    with pytest.raises(InvalidValueError, match='at most 1000 corners, got 50000'):
        make_hull({'surface.hull': [1.0, 2.0] * 50000})
