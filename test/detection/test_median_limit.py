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

from camera_to_base.detection.median_limit import MedianLimit
from camera_to_base.detection.region import Region
import cv2
import numpy as np
import pytest


def everywhere(picture):
    return Region(*(slice(0, length) for length in picture.shape))


def random_limits(rng, shape):
    level, spread = rng.integers(0, 256), rng.choice([0, 1, 8, 60])
    return np.clip(rng.normal(level, spread, shape), 0, 255).astype(np.uint8)


def random_closed(rng, limits, size):
    steps = rng.normal(0, rng.choice([1, 10, 80]), limits.shape)
    noisy = np.clip(limits + steps, 0, 255).astype(np.uint8)
    return cv2.morphologyEx(noisy, cv2.MORPH_CLOSE, np.ones((size, size), np.uint8))


@pytest.mark.parametrize('median_size', [1, 3, 5, 15, 17, 99])
def test_limit_is_compared_with_the_median_on_every_pixel(median_size):
    rng, different, seen = np.random.default_rng(median_size), [], 0
    for case in range(150):
        limits = random_limits(rng, rng.integers(1, 100, 2))
        picture = random_closed(rng, limits, int(rng.integers(1, 9)))
        expected = cv2.medianBlur(picture, median_size) < limits
        below = MedianLimit(limits, median_size).below(picture, everywhere(picture))
        if below is None:
            below = np.zeros_like(picture)
        if not np.array_equal(below, expected):
            different.append(case)
        seen += 0 < expected.sum() < expected.size
    assert different == [] and seen > 15


def test_a_picture_that_is_nowhere_below_gives_none():
    limits = np.full((20, 30), 100, np.uint8)
    assert MedianLimit(limits, 5).below(limits, everywhere(limits)) is None


def test_limits_of_a_piece_are_those_of_its_place():
    limits = np.zeros((40, 60), np.uint8)
    limits[20:, 30:] = 100
    limit, piece = MedianLimit(limits, 1), np.full((20, 30), 50, np.uint8)
    assert limit.below(piece, Region(slice(20, 40), slice(30, 60))).all()
    assert limit.below(piece, Region(slice(0, 20), slice(0, 30))) is None
