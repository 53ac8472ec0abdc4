# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What lies still is looked at once, and whatever changes is looked at again."""

import math

from camera_to_base.detection import Box, PreciseDifferenceDetector
from camera_to_base.detection.precise import search
from camera_to_base.detection.precise.regions import Region
from camera_to_base.detection.precise.still import Still
import cv2
import numpy as np
import pytest

SIZE = 240, 320
RED, GREY = (40, 45, 170), (96, 100, 104)


def table():
    grain = cv2.GaussianBlur(np.random.default_rng(3).normal(0, 1, SIZE), (0, 0), 2)
    return np.float32([130, 150, 165]) + np.float32(12 * grain / grain.std())[..., None]


def disc(centre, radius):
    v, u = np.mgrid[:SIZE[0], :SIZE[1]]
    away = np.hypot(u - centre[0], v - centre[1])
    return np.clip(radius + 0.5 - away, 0, 1).astype(np.float32)[..., None]


def shade(picture, centre, radius=26, depth=0.45):
    soft = cv2.GaussianBlur(disc(centre, radius)[..., 0], (0, 0), 3)[..., None]
    return picture * (1 - depth * soft)


def with_disc(picture, centre, colour=RED, radius=20):
    share = disc(centre, radius)
    return picture * (1 - share) + share * np.float32(colour)


def shaded_disc(picture, centre, colour=RED):
    return with_disc(shade(picture, (centre[0] + 9, centre[1] + 6)), centre, colour)


def seen(picture, seed):
    noise = np.random.default_rng(seed).normal(0, 1.5, picture.shape)
    return np.clip(np.rint(picture + noise), 0, 255).astype(np.uint8)


@pytest.fixture
def detector():
    return PreciseDifferenceDetector(seen(table(), 0))


@pytest.fixture
def looks(monkeypatch):
    """Count the regions that are looked at closely."""
    regions = []
    things_in = search.things_in

    def counting(frame, region, *others):
        regions.append(region)
        return things_in(frame, region, *others)

    monkeypatch.setattr(search, 'things_in', counting)
    return regions


def test_what_lies_still_is_looked_at_three_times_and_now_and_then_again(detector, looks):
    picture = shaded_disc(shaded_disc(table(), (90, 80)), (220, 150))
    for seed in range(1, 8):
        assert len(detector.detect(seen(picture, seed))) == 2
    assert len(looks) == 6
    for seed in range(8, 40):
        assert len(detector.detect(seen(picture, seed))) == 2
    assert 8 <= len(looks) <= 12


def test_what_lies_still_in_a_lobe_of_light_is_told_once_and_so_is_the_light(detector, looks):
    v, u = np.mgrid[:SIZE[0], :SIZE[1]]
    lobe = 1 - 0.15 * np.exp(-((u - 150) ** 2 + (v - 110) ** 2) / 2 / 60 ** 2)[..., None]
    picture = lobe * shaded_disc(table(), (150, 110))
    for seed in range(1, 10):
        assert len(detector.detect(seen(picture, seed))) == 1
        assert sum(one.area > 5000 for one in detector.dropped) == 1
    assert len(looks) <= 5


def test_what_noise_turns_over_does_not_last(detector, monkeypatch):
    picture = with_disc(shade(table(), (145, 130), 40), (120, 120), RED)
    picture = with_disc(picture, (170, 120), RED)
    things_in, count = search.things_in, []

    def mistaken(frame, region, *others):
        count.append(region)
        things = things_in(frame, region, *others)
        return [region._replace(is_thing=True)] if len(count) in (1, 7, 8, 20) else things

    monkeypatch.setattr(search, 'things_in', mistaken)
    found = [len(detector.detect(seen(picture, seed))) for seed in range(1, 120)]
    assert 1 <= found.count(1) <= 4
    assert found.count(1) + found.count(2) == len(found)
    assert len(count) < 50


def test_place_is_that_of_a_detector_that_has_seen_no_other_frame(detector):
    picture = shaded_disc(table(), (150.3, 119.6))
    for seed in range(1, 12):
        found, = detector.detect(seen(picture, seed))
        new, = PreciseDifferenceDetector(seen(table(), 0)).detect(seen(picture, seed))
        assert math.dist(found.centre, new.centre) < 0.05
        assert found.area == pytest.approx(new.area, rel=0.01)


@pytest.mark.parametrize('step', [0.05, 0.2, 0.7, 3.0])
def test_place_follows_an_object_that_moves_slowly(detector, step):
    for number in range(25):
        centre = 100 + step * number, 120
        found, = detector.detect(seen(shaded_disc(table(), centre), number + 1))
        assert math.dist(found.centre, centre) < 0.25


@pytest.mark.parametrize('colour', [RED, (98, 124, 142)])
@pytest.mark.parametrize('place', [(150, 120), (191, 130)])
def test_what_is_laid_on_or_beside_what_lies_still_is_seen_at_once(detector, colour, place):
    picture = shaded_disc(table(), (145, 120), (40, 150, 60))
    for seed in range(1, 6):
        detector.detect(seen(picture, seed))
    before, = detector.detect(seen(picture, 6))
    after = detector.detect(seen(with_disc(picture, place, colour, 9), 7))
    if place == (191, 130):
        assert sorted(math.dist(one.centre, place) < 1.5 for one in after) == [False, True]
    else:
        assert [one.centre for one in after] != [before.centre]


def test_what_is_taken_away_is_gone_at_once(detector):
    for seed in range(1, 6):
        assert len(detector.detect(seen(shaded_disc(table(), (150, 120)), seed))) == 1
    assert detector.detect(seen(table(), 6)) == []
    assert detector.dropped == []


def test_shade_that_lies_still_stays_none_and_is_named(detector, looks):
    picture = shade(table(), (150, 120), 40, 0.35)
    kinds = []
    for seed in range(1, 7):
        assert detector.detect(seen(picture, seed)) == []
        kinds.append([one.kind for one in detector.dropped if one.area > 1000])
    assert len(looks) == 3
    assert kinds == [['shade']] * 6


def test_object_in_shade_that_lies_still_is_found_at_once(detector):
    picture = shade(table(), (150, 120), 40, 0.35)
    for seed in range(1, 6):
        assert detector.detect(seen(picture, seed)) == []
    found, = detector.detect(seen(with_disc(picture, (150, 120), RED, 12), 6))
    assert math.dist(found.centre, (150, 120)) < 0.5


def test_lamp_that_is_dimmed_makes_all_be_looked_at_again(detector, looks):
    picture = shaded_disc(table(), (150, 120))
    for seed in range(1, 6):
        detector.detect(seen(picture, seed))
    assert len(looks) == 3
    found, = detector.detect(seen(0.75 * picture, 6))
    assert math.dist(found.centre, (150, 120)) < 0.3
    assert len(looks) == 4


def test_what_reaches_in_covers_what_lies_still(detector):
    picture = shaded_disc(table(), (150, 120))
    for seed in range(1, 6):
        detector.detect(seen(picture, seed))
    picture[:, 140:175] = GREY
    found = detector.detect(seen(picture, 6))
    assert all(one.cut_off for one in found)


def test_what_lies_still_is_found_beside_an_arm_that_moves(detector, looks):
    picture = shaded_disc(table(), (100, 120))
    for number in range(10):
        frame = picture.copy()
        frame[:, 190 + 4 * number:225 + 4 * number] = GREY
        found = [one for one in detector.detect(seen(frame, number + 1)) if not one.cut_off]
        assert [math.dist(one.centre, (100, 120)) < 0.3 for one in found] == [True]
    assert sum(region.box.x < 150 for region in looks) <= 5


def test_what_lies_still_in_compressed_pictures_is_told_once(looks):
    def coded(picture, seed):
        data = cv2.imencode('.jpg', seen(picture, seed), [cv2.IMWRITE_JPEG_QUALITY, 75])[1]
        return cv2.imdecode(data, cv2.IMREAD_COLOR)

    picture = shaded_disc(shaded_disc(table(), (90, 80)), (220, 150))
    detector = PreciseDifferenceDetector(coded(table(), 0))
    for seed in range(1, 40):
        assert len(detector.detect(coded(picture, seed))) == 2
    assert len(looks) <= 14


def test_part_of_what_lies_still_is_told_anew():
    def region(left, top, length):
        box = Box(left, top, length, length)
        corners = np.int32([(0, 0), (0, length), (length, length), (length, 0)]) + (left, top)
        return Region(corners[:, None], box, length ** 2, box)

    picture = np.zeros((100, 100, 3), np.uint8)
    still = Still(Box(0, 0, 100, 100), picture, picture, None, region(20, 20, 60), [], [], [])
    assert still.is_at(region(30, 40, 15)) and not still.is_as_large_as(region(30, 40, 15))
    assert still.is_at(region(18, 20, 62)) and still.is_as_large_as(region(18, 20, 62))
    assert not still.is_at(region(75, 75, 20)) and not still.is_at(region(85, 20, 10))
