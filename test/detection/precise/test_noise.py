# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The noise of raw and of compressed pictures, whole and reduced; what is told in it."""

import math

from camera_to_base.detection import PreciseDifferenceDetector
from camera_to_base.detection.precise.noise import measure_noise
import cv2
from lit_table import painted
import numpy as np
import pytest

SIZE = 480, 640
CLOTH = np.float32([104, 104, 104])


def blotches(seed, deviation, edge=8):
    """Give noise that a block's pixels have alike, and that is no change of the level."""
    blocks = np.random.default_rng(seed).normal(
        0, deviation, (SIZE[0] // edge, SIZE[1] // edge, 1))
    blocks = np.float32(blocks * (1, -1, 1))
    return cv2.resize(blocks, SIZE[::-1], interpolation=cv2.INTER_LINEAR)


def raw(seed, deviation):
    return np.random.default_rng(seed).normal(0, deviation, (*SIZE, 3))


def picture(light, *noise):
    return np.uint8(np.clip(np.rint(light + sum(noise)), 0, 255))


def noise_of(*pair):
    return measure_noise(*(picture(CLOTH, *noise) for noise in pair), 104)


@pytest.mark.parametrize('deviation', [2, 5])
def test_noise_of_a_raw_picture_is_halved_with_its_size(deviation):
    noise = noise_of([raw(1, deviation)], [raw(2, deviation)])
    for scale, one in noise.items():
        assert one.at(104) == pytest.approx(math.hypot(deviation / scale, 0.3), rel=0.2)
        assert one.drift < 0.03 and one.compression < 0.1


@pytest.mark.parametrize('scale', [2, 4])
def test_noise_of_blocks_is_not_less_in_a_reduced_picture(scale):
    noise = noise_of([blotches(1, 6, 16), raw(3, 1)], [blotches(2, 6, 16), raw(4, 1)])
    assert noise[scale].at(104) > noise[1].at(104)


@pytest.mark.parametrize('deviation', [2, 4])
def test_chroma_that_blocks_have_alike_is_drift(deviation):
    drift = noise_of([blotches(1, deviation), raw(3, 2)], [blotches(2, deviation), raw(4, 2)])[
        1].drift
    assert 0.02 * deviation ** 2 < drift < 0.1 * deviation ** 2


def test_blocks_that_a_lamp_or_a_print_changes_are_no_drift():
    across = np.linspace(0.8, 1.2, SIZE[1])[None, :, None]
    stripes = np.where(np.indices(SIZE)[1] // 40 % 2, 1.0, 0.4)[..., None]
    background = picture(CLOTH * stripes, raw(1, 2))
    frame = picture(255 * (CLOTH * stripes * across / 255) ** 0.9, raw(2, 2))
    assert measure_noise(frame, background, 104)[1].drift < 0.1


def compressed(light, seed, quality, deviation):
    noisy = picture(light, raw(seed, deviation))
    return cv2.imdecode(cv2.imencode('.jpg', noisy, [cv2.IMWRITE_JPEG_QUALITY, quality])[1], 1)


@pytest.mark.parametrize('seed', range(4))
@pytest.mark.parametrize('quality, deviation', [(25, 10), (40, 6), (60, 6)])
def test_balls_that_one_soft_shade_joins_are_found_without_it_in_jpeg(quality, deviation, seed):
    cloth, places = np.float32([90, 120, 60]), [(200, 150), (330, 230), (440, 340)]
    light, shade = np.tile(cloth, (*SIZE, 1)), np.zeros(SIZE, np.float32)
    background = compressed(light, 100 + seed, quality, deviation)
    for u, v in places:
        cv2.circle(shade, (u - 18, v + 14), 60, 1, cv2.FILLED)
    light = light * (1 - 0.35 * cv2.GaussianBlur(shade, (0, 0), 18)[..., None])
    for place, colour in zip(places, [(40, 30, 190), (150, 50, 60), (40, 30, 190)]):
        ball = cv2.circle(np.zeros(SIZE, np.float32), place, 34, 1, cv2.FILLED, cv2.LINE_AA)
        light = painted(light, ball[..., None], colour)
    found = PreciseDifferenceDetector(background).detect(
        compressed(light, 200 + seed, quality, deviation))
    assert len(found) == 3
    for one, place in zip(sorted(found, key=lambda one: one.centre.u), places):
        assert one.centre == pytest.approx(place, abs=1) and one.doubt < 1
        assert one.area == pytest.approx(np.pi * 34 ** 2, rel=0.1)
