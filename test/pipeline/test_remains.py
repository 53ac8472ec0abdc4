# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What is seen of an object's old place in one frame is believed no less in the next one."""

from camera_to_base.detection import Box, Detection, Pixel
from camera_to_base.pipeline.arms import Remains
import numpy as np
import pytest


def at(x, y, size):
    return Detection(Box(x, y, size, size), Pixel(x + size / 2, y + size / 2), float(size ** 2),
                     np.empty((0, 2), np.int32), False)


def remains():
    told = Remains()
    told.note([at(100, 100, 20)], 5.0)
    return told


@pytest.mark.parametrize('place, is_part', [
    (at(110, 110, 10), True),  # a smaller part
    (at(125, 110, 10), False),  # beside it
    (at(95, 95, 40), False)])  # a larger object that was laid there
def test_part_of_an_old_place_is_left_out(place, is_part):
    assert remains().may_be_part(place) is is_part


@pytest.mark.parametrize('later_s, is_part', [(0.1, True), (0.9, True), (1.1, False)])
def test_old_place_is_remembered_for_a_second(later_s, is_part):
    told = remains()
    told.note([], 5.0 + later_s)
    assert told.may_be_part(at(110, 110, 10)) is is_part
