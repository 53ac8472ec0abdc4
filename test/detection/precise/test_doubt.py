# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Doubt in a place: no farther than its thing is wide; what is all in doubt is left out."""

from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.segments import doubt_of, Unsure
import cv2
from lit_table import coded, covered, painted, SIZE
import numpy as np
import pytest


def printed_squares(seed, gamma=1.0, gain=(1, 1, 1), has_disc=False):
    rows, columns = np.indices(SIZE) // 40
    picture = np.where(((rows + columns) % 2 > 0)[..., None],
                       np.float32((190, 195, 190)), np.float32((70, 78, 86)))
    if has_disc:
        cv2.circle(picture, (140, 100), 12, (91, 129, 154), -1, cv2.LINE_AA)
    picture = 255 * (cv2.GaussianBlur(picture, (0, 0), 0.8) / 255) ** gamma * np.float32(gain)
    picture += np.random.default_rng(seed).normal(0, 1.5, picture.shape)
    return np.uint8(np.clip(np.rint(picture), 0, 255))


def test_another_tone_curve_shows_where_a_print_does_and_is_no_drift_of_the_noise():
    background = printed_squares(1)
    frame = printed_squares(2, 0.8, (0.9, 0.9, 0.98), has_disc=True)
    reference = Reference(background, 13.0)
    reference.follow(frame)
    assert reference.noise[1].drift == 0
    found, = PreciseDifferenceDetector(background).detect(frame)
    assert found.centre == pytest.approx((140, 100), abs=0.3) and found.doubt < 1


def test_drift_of_the_noise_is_seen_on_a_print():
    background, frame = printed_squares(1), printed_squares(2)
    blocks = np.random.default_rng(3).normal(0, 4, (SIZE[0] // 8, SIZE[1] // 8, 3))
    drift = cv2.resize(np.float32(blocks), SIZE[::-1], interpolation=cv2.INTER_NEAREST)
    reference = Reference(background, 13.0)
    reference.follow(np.uint8(np.clip(frame + drift, 0, 255)))
    assert reference.noise[1].drift > 0.5


def test_print_without_two_like_places_tells_no_drift():
    stripes = 40 * (np.indices(SIZE)[1] // 3 % 5)
    background = np.uint8(np.repeat(stripes[..., None], 3, axis=2))
    reference = Reference(background, 13.0)
    reference.follow(background + np.uint8(2))
    assert reference.noise[1].drift == 0


def test_what_is_farther_away_than_a_thing_is_wide_is_no_face_of_it():
    ball, arm = np.zeros(SIZE, np.uint8), np.zeros(SIZE, np.uint8)
    ball[100:120, 40:60] = arm[105:115, 60:300] = 1
    assert 1 < doubt_of(ball, [Unsure(arm, 0.5)]) < 10


def grey_box_below_two_soft_lamps(seed):
    rng = np.random.default_rng(seed)
    table = np.full((*SIZE, 3), rng.uniform(0.55, 0.85)) * (1 + rng.normal(0, 0.02, 3))
    turn, sides = rng.uniform(0, np.pi), rng.uniform(18, 30, 2)
    along = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    top = (160, 120) + np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * sides @ along

    def swept(far, blur):
        to = rng.uniform(0, 2 * np.pi)
        way = far * np.array([np.cos(to), np.sin(to)])
        return covered(*cv2.convexHull(np.float32([*top, *top + way]))[:, 0], blur=blur)

    light = table
    for _ in range(2):
        light = light * (1 - rng.uniform(0.1, 0.3) * swept(
            rng.uniform(8, 25), rng.uniform(1, 4)))
    light = painted(light, swept(rng.uniform(3, 8), 0.7), table[0, 0] * rng.uniform(0.2, 0.45))
    colour = table[0, 0] * rng.uniform(0.5, 0.75) * (1 + rng.normal(0, 0.015, 3))
    return table, painted(light, covered(*top), colour)


@pytest.mark.parametrize('seed', [718, 1322, 1788, 1854])
def test_sliver_of_a_box_as_grey_as_its_shade_is_left_out(seed):
    table, light = grey_box_below_two_soft_lamps(seed)
    detector = PreciseDifferenceDetector(coded(table, 1, 85))
    assert detector.detect(coded(light, 2, 85)) == []
    assert any(one.kind == 'light_or_thing' for one in detector.dropped)
