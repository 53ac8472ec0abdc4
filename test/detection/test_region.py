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

from camera_to_base.detection.region import Region, row_bands, within


def region(top, bottom, left=0, right=9):
    return Region(slice(top, bottom), slice(left, right))


def test_regions_that_share_rows_become_one_band():
    regions = [region(50, 60, 5, 8), region(0, 10, 3, 6), region(8, 20, 7, 9)]
    assert row_bands(regions) == [region(0, 20, 3, 9), region(50, 60, 5, 8)]


def test_bands_have_a_row_between_them():
    assert row_bands([region(0, 10), region(10, 20)]) == [region(0, 20)]
    assert row_bands([region(0, 10), region(11, 20)]) == [region(0, 10), region(11, 20)]


def test_a_band_in_another_one_stays_within():
    assert row_bands([region(0, 50), region(10, 20), region(30, 60)]) == [region(0, 60)]


def test_place_in_a_piece_counts_from_the_corner_of_the_piece():
    assert within(region(12, 20, 5, 9), region(10, 40, 2, 30)) == region(2, 10, 3, 7)
