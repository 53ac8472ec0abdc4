# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the sensor has cut off: a white table in less light, and the tops of pale boxes."""

import math

from camera_to_base.detection import PreciseDifferenceDetector
from camera_to_base.detection.precise.light import Gain
from camera_to_base.detection.precise.reference import Reference
import cv2
from lit_table import coded, covered, painted, shaded, SIZE
import numpy as np
import pytest

ALL = slice(None), slice(None)


def white_table(light):
    """Give a sheet that is cut off, on a grey table that tells the frame's light."""
    table = np.full((*SIZE, 3), 0.35, np.float32)
    return light * painted(table, covered((80, 40), (300, 40), (300, 220), (80, 220)), (1.5,) * 3)


@pytest.mark.parametrize('light', [0.75, 0.85, 1.0, 1.2])
def test_white_table_that_is_cut_off_has_not_changed_in_less_light(light):
    detector = PreciseDifferenceDetector(coded(white_table(1), 1, noise=0.7))
    box = covered((150, 90), (200, 90), (200, 140), (150, 140))
    frame = painted(white_table(light), box, (0.1, 0.1, 0.4))
    found, = detector.detect(coded(frame, 2, noise=0.7))
    assert found.centre == pytest.approx((174.5, 114.5), abs=0.3) and found.doubt < 1
    assert sum(one.area for one in detector.dropped) < 100


@pytest.mark.parametrize('gain', [(-30, -15, 0), (10, 10, 10)])
def test_cut_off_level_may_be_anything_from_its_own_in_less_light_to_the_lightest(gain):
    picture = np.full((40, 40, 3), 255, np.uint8)
    reference = Reference(picture, 13.0)
    reference.follow(picture)
    reference.limits.set_light(Gain(*gain), reference.noise[1].levels)
    least = Gain(*gain).lit(picture[:1, :1], darkest=True)[0, 0]
    assert Gain(*gain).lit(picture).min() == 255
    for levels, is_outside in ((least, False), ([255] * 3, False), (np.int32(least) - 20, True)):
        frame = np.full_like(picture, np.uint8(levels))
        assert reference.limits.strong(frame, ALL).any() == is_outside
    lit = Gain(*gain).lit(np.full((1, 1, 3), 200, np.uint8))[0, 0]
    assert np.sign(np.int32(lit) - 200).tolist() == np.sign(gain).tolist()


def pale_box(light, u, v):
    """Lay a box with yellow walls down: its top is brighter than the sensor tells."""
    walls = covered((u - 16, v - 16), (u + 18, v - 16), (u + 18, v + 18), (u - 16, v + 18))
    top = covered((u - 14, v - 14), (u + 14, v - 14), (u + 14, v + 14), (u - 14, v + 14))
    return painted(painted(light, walls, (0.05, 0.45, 0.5)), top, (1.1, 1.4, 1.4))


@pytest.mark.parametrize('seed', range(2, 6))
def test_pale_boxes_in_one_shade_are_no_highlights_on_it(seed):
    background = np.full((*SIZE, 3), 0.75, np.float32)
    places = (90, 110), (150, 120), (210, 100)
    shade = np.zeros(SIZE, np.float32)
    for u, v in places:
        shade = np.maximum(shade, cv2.GaussianBlur(covered(
            (u - 30, v - 30), (u + 42, v - 30), (u + 42, v + 42), (u - 30, v + 42))[..., 0],
            (0, 0), 9))
    light = shaded(background, shade, 0.3)
    for place in places:
        light = pale_box(light, *place)
    found = PreciseDifferenceDetector(coded(background, 1)).detect(coded(light, seed, 90))
    assert len(found) == 3
    for one in found:
        away = min(math.dist(one.centre, (u + 0.5, v + 0.5)) for u, v in places)
        assert away < max(2, 1.5 * one.doubt)
