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

from camera_to_base.detection.light_blocks import LightBlocks
import numpy as np
import pytest

EVERYWHERE = slice(0, 100)


@pytest.mark.parametrize('row', [0, 29, 30, 89, 90, 99])
@pytest.mark.parametrize('level, is_light', [(200, False), (201, True)])
def test_one_pixel_above_the_limit_is_seen_in_every_row(row, level, is_light):
    blocks = LightBlocks(np.full((100, 70), 200, np.uint8), 22)
    frame = np.full((100, 70, 3), 150, np.uint8)
    frame[row, 35] = level
    assert blocks.has_light(frame, EVERYWHERE) == is_light


def test_one_bright_colour_makes_no_light_pixel():
    frame = np.full((100, 70, 3), (255, 150, 150), np.uint8)
    assert not LightBlocks(np.full((100, 70), 200, np.uint8), 22).has_light(frame, EVERYWHERE)


@pytest.mark.parametrize('column, is_light', [(30, True), (50, True), (51, False)])
def test_the_lowest_limit_within_reach_counts(column, is_light):
    limits = np.full((100, 70), 200, np.uint8)
    limits[:, :31] = 100
    frame = np.full((100, 70, 3), 90, np.uint8)
    frame[50, column] = 150
    assert LightBlocks(limits, 20).has_light(frame, EVERYWHERE) == is_light


def test_other_rows_are_not_asked():
    frame = np.full((100, 70, 3), 90, np.uint8)
    frame[5] = 250
    blocks = LightBlocks(np.full((100, 70), 200, np.uint8), 0)
    assert not blocks.has_light(frame, slice(60, 100))
    assert blocks.has_light(frame, slice(0, 40))
