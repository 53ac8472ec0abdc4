# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

from camera_to_base.detection.detection import Pixel
from camera_to_base.trust.jump_filter import JumpFilter
import pytest


def accepted(jumps, *pixels):
    return [bool(jumps.believed([Pixel(*pixel)])) for pixel in pixels]


def test_first_position_needs_a_second_one():
    assert accepted(JumpFilter(8), (100, 100), (101, 100), (100, 102)) == [False, True, True]


def test_position_that_no_other_frame_confirms_is_held_back():
    jumps = JumpFilter(8)
    accepted(jumps, (100, 100), (100, 100))
    assert accepted(jumps, (300, 50), (100, 100), (20, 400), (101, 100)) == [
        False, True, False, True]


def test_object_that_was_put_elsewhere_is_followed_from_the_second_frame_on():
    jumps = JumpFilter(8)
    accepted(jumps, (100, 100), (100, 100))
    assert accepted(jumps, (300, 50), (301, 50), (300, 50)) == [False, True, True]


@pytest.mark.parametrize('speed', [5, 20, 150])
def test_moving_object_is_followed_at_any_speed(speed):
    result = accepted(JumpFilter(8), *((100 + speed * k, 50 + speed * k // 2) for k in range(10)))
    assert all(result[2:])


def test_radius_of_zero_accepts_everything():
    assert accepted(JumpFilter(0), (0, 0), (500, 500), (3, 400)) == [True] * 3


def test_each_of_several_objects_is_judged_by_itself():
    jumps = JumpFilter(8)
    jumps.believed([Pixel(100, 100), Pixel(300, 300)])
    assert jumps.believed([Pixel(101, 100), Pixel(500, 300)]) == [Pixel(101, 100)]
    assert jumps.believed([Pixel(101, 100), Pixel(500, 300)]) == [
        Pixel(101, 100), Pixel(500, 300)]


def test_empty_surface_needs_a_second_frame_too():
    jumps = JumpFilter(8)
    empty = []
    for pixels in ([], [], [Pixel(1, 1)], [], []):
        jumps.believed(pixels)
        empty.append(jumps.believes_empty())
    assert empty == [False, True, False, False, True]
