# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Light that changes smoothly, wherever it comes from: a lamp, a cloud, somebody's soft shadow."""

import math

from camera_to_base.detection import PreciseDifferenceDetector
from camera_to_base.detection.precise.other_light import without_smooth_light
import cv2
import numpy as np
import pytest

SIZE = 480, 640
TABLE = np.float32([0.28, 0.42, 0.55])  # light, B, G and R
COINS = [(320, 150), (360, 210), (250, 260), (420, 330), (90, 400)]
ROWS, COLUMNS = np.mgrid[:SIZE[0], :SIZE[1]].astype(np.float32)


def photograph(light, seed, quality=85, noise=2.5):
    grey = 255 * np.clip(light, 0, 1) ** (1 / 2.2)
    grey += np.random.default_rng(seed).normal(0, noise, light.shape)
    jpeg = cv2.imencode('.jpg', np.uint8(np.clip(np.rint(grey), 0, 255)), [
        cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return cv2.imdecode(jpeg, cv2.IMREAD_COLOR)


def table(texture):
    grain = cv2.GaussianBlur(np.random.default_rng(3).normal(0, 1, SIZE), (0, 0), 6, sigmaY=2)
    return TABLE * (1 + texture * grain / grain.std())[..., None].astype(np.float32)


def lobe(gain, deviation, u=330, v=230):
    distance = (COLUMNS - u) ** 2 + (ROWS - v) ** 2
    return 1 + (gain - 1) * np.exp(-distance / 2 / deviation ** 2)[..., None]


def disc(u, v, radius=14):
    distance = np.hypot(COLUMNS - u, ROWS - v)
    return np.clip(radius + 0.5 - distance, 0, 1)[..., None]


def with_coins(light, colour):
    for u, v in COINS:
        light = light * (1 - disc(u, v)) + disc(u, v) * np.float32(colour)
    return light


def assert_coins_alone(light, background):
    found = [one.centre for one in PreciseDifferenceDetector(photograph(background, 1)).detect(
        photograph(light, 2))]
    assert len(found) == len(COINS)
    for coin in COINS:
        assert min(math.dist(one, coin) for one in found) < 0.4


@pytest.mark.parametrize('gain', [0.7, 0.85, 1.15, 1.3])
@pytest.mark.parametrize('deviation', [30, 70, 150])
@pytest.mark.parametrize('texture', [0, 0.04])
def test_lobe_of_light_hides_no_coin_and_is_none(gain, deviation, texture):
    coins = with_coins(table(texture), (0.1, 0.3, 0.5))
    assert_coins_alone(coins * lobe(gain, deviation), table(texture))


@pytest.mark.parametrize('gain, kind', [(0.7, 'shade'), (1.3, 'light')])
def test_lobe_of_light_is_named(gain, kind):
    detector = PreciseDifferenceDetector(photograph(table(0), 1))
    assert detector.detect(photograph(table(0) * lobe(gain, 60), 2)) == []
    assert detector.dropped[0].kind == kind
    assert math.dist(detector.dropped[0].position, (330, 230)) < 5


def test_frame_without_smooth_light_looks_like_the_background():
    background = photograph(table(0.04), 1)
    even = without_smooth_light(photograph(table(0.04) * lobe(0.7, 60), 2), background).frame
    assert abs(cv2.blur(even, (9, 9)).astype(int) - cv2.blur(background, (9, 9))).max() <= 6


def test_large_thing_is_no_smooth_light():
    background = photograph(table(0), 1)
    light = table(0) * (1 - 0.5 * disc(330, 230, 120))
    assert without_smooth_light(photograph(light, 2), background) is None


def test_what_is_too_light_to_tell_its_light_stays():
    bright = 3 * table(0)
    background, frame = photograph(bright, 1), photograph(bright * lobe(1.3, 60), 2)
    assert PreciseDifferenceDetector(background).detect(frame) == []


@pytest.mark.parametrize('texture', [0, 0.1])
@pytest.mark.parametrize('quality', [85, 95])
@pytest.mark.parametrize('colour', [0.12, 0.2])
def test_thing_in_a_soft_shade_with_its_own_hard_shade_is_found(texture, quality, colour):
    shaded = table(texture) * lobe(0.5, 60) * (1 - 0.5 * disc(338, 238, 16))
    light = shaded * (1 - disc(330, 230, 16)) + disc(330, 230, 16) * colour
    detector = PreciseDifferenceDetector(photograph(table(texture), 1, quality))
    found, = detector.detect(photograph(light, 2, quality))
    assert math.dist(found.centre, (330, 230)) < 1


@pytest.mark.parametrize('texture', [0, 0.05])
@pytest.mark.parametrize('slope', [(0.6, 0), (0.4, -0.4), (0, 0.8)])
def test_lamp_at_one_side_hides_no_coin_and_is_none(texture, slope):
    light = 1 + (slope[0] * (COLUMNS / SIZE[1] - 0.5) + slope[1] * (ROWS / SIZE[0] - 0.5))
    coins = with_coins(table(texture), (0.1, 0.3, 0.5))
    assert_coins_alone(coins * light[..., None], table(texture))


@pytest.mark.parametrize('cut', [(1, 0), (0, 3), (2, 1)])
def test_size_of_a_picture_does_not_matter(cut):
    part = np.s_[cut[0]:, cut[1]:]
    detector = PreciseDifferenceDetector(photograph(table(0)[part], 1))
    assert detector.detect(photograph((table(0) * lobe(0.7, 60))[part], 2)) == []
