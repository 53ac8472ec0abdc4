# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Coloured things: faint ones, what the sensor has cut off, their glow, and their sharp shade."""

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise import search
from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.detection.precise.evidence import evidence
from camera_to_base.detection.precise.noise import Noise
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import Region
from camera_to_base.detection.precise.shade import Shade
import cv2
from lit_table import coded, covered, painted, SIZE
import numpy as np
import pytest

PALE = 168.0, 179.0, 183.0


def pale_disc(change, seed):
    picture = np.full((240, 320, 3), PALE, np.float32)
    cv2.circle(picture, (150, 120), 15, np.add(PALE, change).tolist(), -1, cv2.LINE_AA)
    picture += np.random.default_rng(seed).normal(0, 1.45, picture.shape)
    return np.uint8(np.rint(picture))


def on_a_pale_table(change, seed):
    frame = cv2.imencode('.jpg', pale_disc(change, seed), [cv2.IMWRITE_JPEG_QUALITY, 92])[1]
    return PreciseDifferenceDetector(pale_disc((0, 0, 0), 1)).detect(cv2.imdecode(frame, 1))


@pytest.mark.parametrize('seed', range(2, 8))
def test_thing_of_a_colour_that_differs_by_the_least_in_the_mean_is_found(seed):
    # By 10 deviations of the noise, which a pixel must differ by, few of its pixels do.
    found, = on_a_pale_table((15, 0, -4), seed)
    assert found.centre == pytest.approx((150, 120), abs=0.6) and found.doubt < 1


@pytest.mark.parametrize('change', [(14.5, 14.5, 14.5), (8, 0, -6)])
@pytest.mark.parametrize('seed', range(2, 5))
def test_what_is_faint_and_has_no_colour_or_less_than_the_least_is_left_out(change, seed):
    assert on_a_pale_table(change, seed) == []


@pytest.mark.parametrize('seen, usual', [((255, 239, 150), (61, 128, 37)),
                                         ((165, 255, 255), (93, 154, 74))])
def test_bright_thing_of_a_colour_is_none_of_the_light_on_a_coloured_table(seen, usual):
    noise = Noise(np.full((256, 3), 0.9, np.float32), 1.5)
    found, white, grey = (np.full((40, 40, 3), levels, np.uint8) for levels in (seen, 255, 128))
    table = np.full((40, 40, 3), usual, np.uint8)
    assert evidence(found, table, noise, Shade()).nats[20, 20] > 20
    assert evidence(white, grey, noise, Shade()).nats[20, 20] < 0


@pytest.mark.parametrize('seed', range(2, 7))
def test_glow_around_a_bright_thing_is_no_highlight_on_it(seed):
    background = np.full((*SIZE, 3), (0.05, 0.2, 0.05), np.float32)
    light = painted(background, covered((120, 90), (185, 100), (180, 140), (115, 130)),
                    np.float32((0.3, 0.5, 0.8)))
    light = light + np.float32((0.03, 0.06, 0.03)) * covered(
        (112, 80), (195, 90), (190, 150), (105, 140), blur=3)
    found, = PreciseDifferenceDetector(coded(background, 1)).detect(coded(light, seed, 90))
    assert found.area < 2900 and found.centre == pytest.approx((150, 115), abs=1)


@pytest.mark.parametrize('seed', [0, 5, 7, 13, 18])
def test_shade_of_a_harder_lamp_may_be_a_grey_part_of_a_coloured_thing(seed):
    rng = np.random.default_rng(seed)
    background = np.full((*SIZE, 3), (0.45, 0.5, 0.52), np.float32)
    top, light = np.array([[130, 90], [175, 90], [175, 135], [130, 135]]), background
    for _ in range(2):
        turn = rng.uniform(0, 2 * np.pi)
        way = rng.uniform(20, 45) * np.array([np.cos(turn), np.sin(turn)])
        light = light * (1 - rng.uniform(0.2, 0.45) * covered(
            *cv2.convexHull(np.float32([*top, *top + way]))[:, 0], blur=rng.uniform(0.8, 2.5)))
    light = painted(light, covered(*top), np.float32((0.03, 0.25, 0.8)))
    for one in PreciseDifferenceDetector(coded(background, 1)).detect(coded(light, seed, 90)):
        assert np.hypot(*np.subtract(one.centre, (152.5, 112.5))) < 2.5 * one.doubt


def region(*corners):
    outline = np.int32(corners)[:, None]
    box = Box(*cv2.boundingRect(outline))
    return Region(outline, box, int(cv2.contourArea(outline)), box, is_thing=True)


def test_part_of_a_large_region_is_looked_at_alone():
    frame = np.zeros((*SIZE, 3), np.uint8)
    two = [region((60, 60), (160, 60), (160, 85), (95, 85)),
           region((60, 90), (85, 90), (85, 160), (60, 160))]
    light = region((170, 170), (190, 170), (190, 190), (170, 190))
    whole = region((0, 40), (300, 40), (300, 200), (0, 200))
    part = region((60, 60), (160, 60), (160, 90), (90, 90), (90, 160), (60, 160)).outline

    def look(near):
        assert near.box.is_inside(Box(40, 40, 141, 141))
        return [*two, light]

    assert search._alone(part, whole, frame, look) == two
    assert search._alone(part, whole, frame, lambda near: []) == []
    assert search._alone(part - (55, 0), whole, frame, look) is None


def test_part_is_looked_at_farther_where_a_thing_goes_on_beyond_what_was_looked_at():
    whole = region((0, 40), (300, 40), (300, 200), (0, 200))
    disc = region((100, 100), (140, 100), (140, 140), (100, 140))
    boxes = []

    def look(near):
        boxes.append(near.box)
        return [whole._replace(outline=near.outline, box=near.box) if len(boxes) == 1 else disc]

    core = region((115, 115), (125, 115), (125, 125), (115, 125)).outline
    assert search._alone(core, whole, np.zeros((*SIZE, 3), np.uint8), look) == [disc]
    assert len(boxes) == 2 and boxes[0].is_inside(boxes[1])


def test_part_in_an_arms_shade_is_no_thing_unless_it_is_one_alone(monkeypatch):
    frame = np.zeros((*SIZE, 3), np.uint8)
    arm = region((0, 40), (300, 40), (300, 200), (0, 200))._replace(is_thing=False)
    part = region((60, 60), (160, 60), (160, 90), (60, 90))
    for alone in [], [part]:
        monkeypatch.setattr(search, 'things_in', lambda frame, at, *_: (
            [arm, part] if at is arm else alone))
        found = search._things_of(
            frame, arm, Reference(frame, 13.0), Shade(), 100.0, np.zeros(SIZE, np.uint8))
        assert found == [arm._replace(is_thing=True), *alone]


def test_ragged_region_that_hardly_differs_strongly_may_be_light():
    ragged = region((60, 60), (160, 60), (160, 70), (70, 70), (70, 160), (60, 160))
    convex = region((60, 60), (160, 60), (160, 90), (60, 90))
    for one, least in ((ragged, 0.5), (convex, 0.0)):
        area = cv2.contourArea(one.outline)
        assert one._replace(strong_area=round((least + 0.05) * area)).is_clear
        assert one._replace(strong_area=round((least - 0.05) * area)).is_clear == (one is convex)


@pytest.mark.parametrize('strong, is_faint', [(0.15, True), (0.35, True), (0.65, False)])
def test_ragged_thing_is_faint_where_too_little_of_it_differs_strongly(strong, is_faint):
    table = np.full((*SIZE, 3), 120, np.uint8)
    detector, frame = PreciseDifferenceDetector(table), table.copy()
    detector.detect(table)
    ragged = region((60, 60), (160, 60), (160, 70), (70, 70), (70, 160), (60, 160))
    cv2.drawContours(frame, [ragged.outline], 0, (112,) * 3, cv2.FILLED)
    cv2.rectangle(frame, (60, 60), (round(60 + 200 * strong), 70), (60,) * 3, cv2.FILLED)
    assert detector._is_faint(ragged.outline, ragged.box, frame, is_thing=True) == is_faint


@pytest.mark.parametrize('level, count', [(40, 1), (85, 0)])
def test_what_is_darker_than_the_shade_that_it_lies_in_is_looked_at_alone(level, count):
    table = np.full((*SIZE, 3), 120, np.uint8)
    frame, corners = table.copy(), ((0, 0), (290, 0), (290, 200), (0, 200))
    cv2.fillPoly(frame, [np.int32(corners)], (100, 100, 100))
    cv2.circle(frame, (150, 110), 16, (level,) * 3, cv2.FILLED)
    found = search._darker(frame, region(*corners), Reference(table, 13.0))
    assert len(found) == count
    assert all(Box(*cv2.boundingRect(one)).is_inside(Box(130, 90, 41, 41)) for one in found)
