# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.detection.background import changed_blocks, mean_blocks
import numpy as np


def test_block_is_the_mean_of_16_by_16_pixels():
    frame = np.zeros((48, 64, 3), np.uint8)
    frame[16:32, 16:24] = 100
    blocks = mean_blocks(frame)
    assert blocks.shape == (3, 4, 3)
    assert (blocks[1, 1] == 50).all() and blocks.sum() == 3 * 50


def test_block_has_changed_where_one_channel_differs_by_more_than_12_levels():
    before = np.full((2, 2, 3), 100, np.uint8)
    after = before.copy()
    after[0, 0, 1] = 112
    after[0, 1, 1] = 113
    after[1, 1, 2] = 87
    assert changed_blocks(before, after).tolist() == [[False, True], [False, True]]
