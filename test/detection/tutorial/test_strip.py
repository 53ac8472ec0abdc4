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

from camera_to_base.detection.tutorial.region import Region
from camera_to_base.detection.tutorial.strip import Strip
import numpy as np

PLACES = [Region(slice(30, 50), slice(5, 25)), Region(slice(2, 12), slice(60, 90))]


def test_pieces_stand_side_by_side_with_nothing_below_the_lower_ones():
    picture = np.random.default_rng(1).integers(1, 256, (60, 100), dtype=np.uint8)
    pieces = Strip(PLACES).cut(picture)
    assert pieces.shape == Strip(PLACES).shape == (20, 50)
    np.testing.assert_array_equal(pieces[:, :20], picture[30:50, 5:25])
    np.testing.assert_array_equal(pieces[:10, 20:], picture[2:12, 60:90])
    assert not pieces[10:, 20:].any()


def test_a_single_piece_is_not_copied():
    picture = np.zeros((60, 100), np.uint8)
    assert np.shares_memory(Strip(PLACES[:1]).cut(picture), picture)


def test_outlines_lie_where_their_piece_lies_in_the_picture():
    mask = np.zeros((60, 100), np.uint8)
    mask[33:36, 7:11] = mask[4:6, 70:75] = 1
    strip = Strip(PLACES)
    corners = sorted((outline[:, 0].min(axis=0).tolist(), outline[:, 0].max(axis=0).tolist())
                     for outline in strip.outlines(strip.cut(mask)))
    assert corners == [([7, 33], [10, 35]), ([70, 4], [74, 5])]
