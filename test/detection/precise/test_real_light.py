# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the precise detector promises in real light, on photometric pictures."""

import math
from pathlib import Path
import sys

from camera_to_base.detection import PreciseDifferenceDetector
from camera_to_base.detection.precise import search
from camera_to_base.detection.settings import DetectorSettings
import cv2
import numpy as np
import pytest

sys.path.append(str(Path(__file__).parents[3] / 'benchmarks'))
from photometric import Conditions, Lamp, Photographer  # noqa: E402, I100, I202

SMALL = 320, 240


def errors(conditions, frames=6, seed=11):
    camera = Photographer(conditions, seed, SMALL)
    detector = PreciseDifferenceDetector(camera.background())
    for _ in range(frames):
        frame, truth = camera.frame()
        found, = detector.detect(frame)
        yield math.dist(found.centre, truth)


@pytest.mark.parametrize('conditions, most_px', [
    (Conditions(), 0.1), (Conditions(electrons=900), 0.1), (Conditions(quality=50), 0.15),
    (Conditions(blur=2.0), 0.2), (Conditions(flicker=0.15), 0.1),
    (Conditions(colour=(0.06, 0.38, 0.75)), 0.3), (Conditions(colour=(0.34, 0.37, 0.4)), 0.5),
    (Conditions(second_colour=(0.6,)), 0.7), (Conditions(gloss=1.5), 0.2),
    (Conditions(gloss=3, colour=(0.2,)), 0.5),
    (Conditions(radius=5), 0.2), (Conditions(shape='bar', radius=12), 0.3),
    (Conditions(shape='ring'), 0.1), (Conditions(pattern='grain'), 0.3),
    (Conditions(thickness=12, lamp=Lamp(radius=5)), 0.7),
    (Conditions(colour=(0.8,), thickness=12, lamp=Lamp(radius=20)), 0.5),
    (Conditions(colour=(0.06, 0.38, 0.75), thickness=12, lamp=Lamp(radius=5)), 0.7),
    (Conditions(gloss=1.5, thickness=12, lamp=Lamp(radius=5)), 1.0),
    (Conditions(shape='ring', thickness=12, lamp=Lamp(radius=5)), 1.0),
    (Conditions(radius=8, thickness=8, lamp=Lamp(radius=5)), 1.5),
    (Conditions(pattern='grain', tremble=1), 0.3),
    (Conditions(pattern='board', colour=(0.05, 0.1, 0.6), tremble=1), 0.5)])
def test_object_is_found_once_and_placed(conditions, most_px):
    assert max(errors(conditions)) < most_px


def test_thing_that_is_only_darker_than_its_hard_shade_may_be_a_part_of_what_is_seen():
    camera = Photographer(Conditions(thickness=12, lamp=Lamp(radius=5)), 11, SMALL)
    detector = PreciseDifferenceDetector(camera.background())
    found, = detector.detect(camera.frame()[0])
    assert 0.5 < found.doubt < 3


@pytest.mark.parametrize('conditions', [
    Conditions(shade=0.5), Conditions(shade=0.1), Conditions(flicker=0.2),
    Conditions(pattern='grain', tremble=1)])
def test_light_and_tremble_are_no_objects(conditions):
    camera = Photographer(conditions, 5)
    detector = PreciseDifferenceDetector(camera.background())
    for _ in range(6):
        frame, truth = camera.frame()
        found = [one for one in detector.detect(frame) if not one.cut_off]
        assert len(found) == 1 and math.dist(found[0].centre, truth) < 1.5


@pytest.mark.parametrize('light', [0.68, 0.8])
def test_object_in_the_deep_shade_of_something_outside_is_placed_as_in_the_light(light):
    camera = Photographer(Conditions(), 7)
    detector = PreciseDifferenceDetector(camera.background())
    for _ in range(6):
        frame, truth = camera.frame()
        frame[:, :round(truth[0]) + 60] = np.rint(light * frame[:, :round(truth[0]) + 60])
        found, = [one for one in detector.detect(frame) if not one.cut_off]
        assert math.dist(found.centre, truth) < 0.1


@pytest.mark.parametrize('strength', [0.04, 0.1])
def test_bands_of_a_flickering_lamp_are_no_objects_and_hide_none(strength):
    camera = Photographer(Conditions(), 5)
    detector = PreciseDifferenceDetector(camera.background())
    for number in range(6):
        frame, truth = camera.frame()
        light = 1 + strength * np.sin(np.arange(len(frame)) / (30 + 20 * number) + number)
        frame = np.clip(np.rint(frame * light[:, None, None]), 0, 255).astype(np.uint8)
        found = [one for one in detector.detect(frame) if not one.cut_off]
        assert len(found) == 1 and math.dist(found[0].centre, truth) < 0.5


@pytest.mark.parametrize('conditions, most_px', [
    (Conditions(electrons=1e6, quality=0), 0.03),
    (Conditions(electrons=1e6, quality=0, colour=(0.9,)), 0.05),
    (Conditions(electrons=1e6, quality=0, colour=(0.05, 0.1, 0.6)), 0.03),
    (Conditions(electrons=1e6, quality=0, shape='block'), 0.03),
    (Conditions(electrons=1e6, quality=0, shape='bar', radius=24), 0.03),
    (Conditions(electrons=1e6, quality=0, pattern='grain'), 0.05),
    (Conditions(), 0.07), (Conditions(electrons=900), 0.07), (Conditions(flicker=0.2), 0.07)])
def test_short_way_and_long_way_give_the_same_result(conditions, most_px, monkeypatch):
    camera = Photographer(conditions, 3, SMALL)
    background = camera.background()
    frames = [camera.frame()[0] for _ in range(6)]
    short = [PreciseDifferenceDetector(background).detect(frame) for frame in frames]
    monkeypatch.setattr(search, 'find_plain', lambda *_: None)
    long = [PreciseDifferenceDetector(background).detect(frame) for frame in frames]
    assert sum(one != other for one, other in zip(short, long)) >= 4  # two ways, indeed
    for (one,), (other,) in zip(short, long):
        assert math.dist(one.centre, other.centre) < most_px
        assert one.area == pytest.approx(other.area, rel=0.02)
        assert one.cut_off == other.cut_off


def test_noise_is_measured_and_told():
    camera = Photographer(Conditions(electrons=2500, quality=0), 2, SMALL)
    detector = PreciseDifferenceDetector(camera.background())
    assert detector.noise is None
    frames = [camera.frame()[0] for _ in range(8)]
    detector.detect(frames[0])
    true_noise = np.std(np.float32([frame[:, :60] for frame in frames]), axis=0).mean()
    assert detector.noise == pytest.approx(true_noise, rel=0.3)
    assert DetectorSettings().faintness(2.0) == (
        'an object must differ from the surface by 20 grey levels: the noise of 2.0 levels '
        'allows 20, detector.faintest is 13')


def test_long_shadow_of_a_hand_that_is_cut_off_is_not_published():
    camera = Photographer(Conditions(), 9, SMALL)
    background = camera.background()
    frame = background.copy()
    frame[:150, :40] = 30
    found = PreciseDifferenceDetector(background).detect(frame)
    assert [one.cut_off for one in found] == [True]


@pytest.mark.parametrize('size', [(482, 640), (241, 321), (243, 322)])
def test_shade_from_outside_with_something_in_the_last_rows_and_columns_is_looked_at(size):
    background = np.full((*size, 3), 180, np.uint8)
    frame = background.copy()
    frame[:, :size[1] // 3] = 120
    frame[-1:, -100:-60] = frame[-100:-60, -1:] = 20
    frame[100:130, 200:230] = 20
    found = [one for one in PreciseDifferenceDetector(background).detect(frame) if not one.cut_off]
    assert [one.centre for one in found] == [pytest.approx((214.5, 114.5), abs=0.1)]


def test_table_without_light_in_two_colours_has_a_ratio_everywhere():
    background = np.zeros((200, 260, 3), np.uint8)
    background[..., 0] = 120
    frame = background.copy()
    cv2.circle(frame, (100, 100), 30, (60, 0, 80), cv2.FILLED)
    cv2.circle(frame, (120, 110), 20, (60, 0, 0), cv2.FILLED)
    # A warning of numpy is an error here.
    found, = PreciseDifferenceDetector(background).detect(frame)
    assert found.area == pytest.approx(3241, abs=20)
