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

from camera_to_base.detection.tutorial.median import Median
import cv2
import numpy as np
import pytest


@pytest.mark.parametrize('size', [1, 3, 5, 7, 15, 99])
def test_every_pixel_is_opencvs_at_every_shape(size):
    rng, different = np.random.default_rng(size), []
    for case in range(200):
        shape = rng.integers(1, (120, 200) if case % 4 else (30, 1400))
        picture = rng.integers(0, 256, shape, dtype=np.uint8)
        expected = cv2.medianBlur(picture, size)
        if not np.array_equal(Median(size).blur(picture), expected):
            different.append(tuple(shape))
    assert different == []


def test_a_piece_of_a_picture_has_a_rim_of_its_own():
    rng = np.random.default_rng(3)
    picture = rng.integers(0, 256, (90, 80), dtype=np.uint8)
    median, before = Median(5), picture.copy()
    for piece in np.s_[10:70, 5:60], np.s_[40:90, :], np.s_[:, 70:]:
        expected = cv2.medianBlur(before[piece].copy(), 5)
        np.testing.assert_array_equal(median.blur(picture[piece]), expected)
        picture[:] = before
