# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.detection.detection import Pixel
from camera_to_base.pipeline.gate import JumpFilter
import pytest


class Camera:
    """A filter that is shown a frame every so many seconds."""

    def __init__(self, radius_px=8, period_s=0.05):
        self.jumps = JumpFilter(radius_px)
        self.period_s, self.now = period_s, 100.0

    def see(self, *pixels):
        """Tell which positions of the next frame are believed."""
        self.now += self.period_s
        return self.jumps.believed([Pixel(*pixel) for pixel in pixels], self.now)


def accepted(camera, *pixels):
    return [bool(camera.see(pixel)) for pixel in pixels]


def test_first_position_needs_a_second_one():
    assert accepted(Camera(8), (100, 100), (101, 100), (100, 102)) == [False, True, True]


def test_position_that_no_other_frame_confirms_is_held_back():
    camera = Camera(8)
    accepted(camera, (100, 100), (100, 100))
    assert accepted(camera, (300, 50), (100, 100), (20, 400), (101, 100)) == [
        False, True, False, True]


def test_object_that_was_put_elsewhere_is_followed_from_the_second_frame_on():
    camera = Camera(8)
    accepted(camera, (100, 100), (100, 100))
    assert accepted(camera, (300, 50), (301, 50), (300, 50)) == [False, True, True]


@pytest.mark.parametrize('speed', [5, 20, 150])
def test_moving_object_is_followed_at_any_speed(speed):
    result = accepted(Camera(8), *((100 + speed * k, 50 + speed * k // 2) for k in range(10)))
    assert all(result[2:])


def test_radius_of_zero_accepts_everything():
    assert accepted(Camera(0), (0, 0), (500, 500), (3, 400)) == [True] * 3


def test_each_of_several_objects_is_judged_by_itself():
    camera = Camera(8)
    camera.see((100, 100), (300, 300))
    assert camera.see((101, 100), (500, 300)) == [Pixel(101, 100)]
    assert camera.see((101, 100), (500, 300)) == [
        Pixel(101, 100), Pixel(500, 300)]


def test_empty_surface_needs_a_second_frame_too():
    camera = Camera(8)
    empty = []
    for pixels in ([], [], [(1, 1)], [], []):
        camera.see(*pixels)
        empty.append(camera.jumps.believes_empty())
    assert empty == [False, True, False, False, True]


@pytest.mark.parametrize('period_s, count', [(0.05, 100000), (0.05, 25), (2.0, 2), (30.0, 2)])
def test_flash_where_an_object_was_a_while_ago_is_held_back(period_s, count):
    camera = Camera(period_s=period_s)
    assert accepted(camera, (100, 100), (100, 100)) == [False, True]
    for _ in range(count):
        camera.see()
    assert accepted(camera, (100, 100)) == [False]
    camera.see()
    assert accepted(camera, (100, 100), (100, 100)) == [False, True]


def test_object_that_was_hidden_for_half_a_second_is_believed_at_once():
    camera = Camera()
    accepted(camera, (100, 100), (100, 100))
    for _ in range(10):
        camera.see()
    assert accepted(camera, (100, 100)) == [True]


@pytest.mark.parametrize('period_s', [0.01, 0.5, 5.0, 30.0])
def test_object_at_rest_is_believed_at_any_frame_rate(period_s):
    assert accepted(Camera(period_s=period_s), *[(100, 100)] * 5) == [False] + [True] * 4
