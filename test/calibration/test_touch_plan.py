# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Where objects are to be put, and what a person types for the robot's position."""

from itertools import islice

from camera_to_base.calibration.base import read_typed_position, suggested_places
from camera_to_base.errors import InvalidValueError
from camera_to_base.surface.models import ParallelSurface
from camera_to_base.surface.points import Hull
import pytest

SURFACE = ParallelSurface(36.0, 640)


def test_first_five_places_are_the_corners_and_the_middle_of_the_calibrated_area():
    hull = Hull([[100, 100], [500, 100], [500, 300], [100, 300]])
    places = list(islice(suggested_places(SURFACE, hull, (640, 480)), 5))
    assert [place.name for place in places] == [
        'top left', 'top right', 'bottom right', 'bottom left', 'middle']
    assert all(hull.contains(place.pixel) for place in places)
    assert places[4].point == pytest.approx((300 * 36 / 640, 200 * 36 / 640))


def test_without_an_area_the_whole_picture_is_used():
    place = next(suggested_places(SURFACE, None, (640, 480)))
    assert place.pixel == pytest.approx((96, 72))


@pytest.mark.parametrize('text, found', [
    ('12.5 -3', (12.5, -3)), ('12,5 -3,4', (12.5, -3.4)), ('12,5; -3', (12.5, -3)),
    ('12.5, -3.4', (12.5, -3.4)), ('12.5,-3.4', (12.5, -3.4)), (' 125  -30 mm', (12.5, -3)),
    ('0.125 -0.03 m', (12.5, -3)), ('1 2cm', (1, 2)), ('1e1 2', (10, 2)),
    ('\u22127.37 15.46', (-7.37, 15.46)), ('x -8.68, y 16.69 cm', (-8.68, 16.69)),
    ('x \u22128,68, y 16,69 cm', (-8.68, 16.69)), ('X=-86.8 mm Y=166.9 mm', (-8.68, 16.69)),
    ('(\u20128.68, 16.69) cm', (-8.68, 16.69))])
def test_positions_are_read_as_people_type_them(text, found):
    assert read_typed_position(text) == pytest.approx(found)


@pytest.mark.parametrize('text', ['', '12', 'a b', '1 2 3', '12,5', '1 2 inch', 'nan 2', '1;2;3',
                                  'y 1 x 2', 'x 1', 'x 1 mm, y 2 cm'])
def test_what_is_no_position_is_refused_with_an_example(text):
    with pytest.raises(InvalidValueError, match='as in 12.5 -3.4, got'):
        read_typed_position(text)


def test_a_position_beyond_all_tables_is_refused_with_the_unit():
    with pytest.raises(InvalidValueError, match='is the unit right'):
        read_typed_position('1e9 0')
