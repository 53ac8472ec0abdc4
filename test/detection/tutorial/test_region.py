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

from camera_to_base.detection.tutorial.region import apart, around, Region, within


def region(top, bottom, left=0, right=9):
    return Region(slice(top, bottom), slice(left, right))


def test_regions_closer_than_the_gap_become_one():
    regions = [region(0, 10, 0, 10), region(12, 20, 8, 30), region(50, 60)]
    assert apart(regions, 3) == [region(0, 20, 0, 30), region(50, 60)]
    assert apart(regions, 2) == regions


def test_regions_that_are_far_in_one_direction_stay_apart():
    regions = [region(0, 10, 0, 10), region(0, 10, 13, 20), region(13, 20, 0, 20)]
    assert apart(regions, 3) == regions


def test_a_region_that_joins_two_joins_what_comes_near_by_it():
    regions = [region(0, 10, 0, 10), region(0, 10, 30, 40), region(18, 25, 20, 24),
               region(0, 15, 12, 28)]
    assert apart(regions, 5) == [region(0, 25, 0, 40)]


def test_what_is_around_regions_ends_where_they_end():
    assert around([region(5, 8, 3, 6), region(1, 6, 4, 9)]) == region(1, 8, 3, 9)


def test_a_regions_shape_tells_its_pixels():
    assert region(2, 7, 1, 4).shape == (5, 3) and region(2, 7, 1, 4).px == 15


def test_place_in_a_piece_counts_from_the_corner_of_the_piece():
    assert within(region(12, 20, 5, 9), region(10, 40, 2, 30)) == region(2, 10, 3, 7)
