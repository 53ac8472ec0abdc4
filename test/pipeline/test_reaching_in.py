# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.pipeline.reaching_in import ReachingIn
import cv2
import numpy as np
import pytest

SIZES = (640, 480), (641, 483), (1920, 1080), (100, 100), (1000, 24), (24, 1000)
EDGES = {'left': np.s_[10:22, :12], 'right': np.s_[10:22, -12:], 'top': np.s_[:12, 10:22],
         'bottom': np.s_[-12:, 10:22]}


def shoot(size, seed):
    random = np.random.default_rng(seed)
    grain = np.random.default_rng(0).normal(0, 4, (size[1], size[0], 1))
    noise = random.normal(0, 1, (size[1], size[0], 3))
    return np.clip(150 + grain + noise, 0, 255).astype(np.uint8)


@pytest.mark.parametrize('size', SIZES, ids=str)
def test_on_a_table_without_hands_nothing_reaches_in(size):
    reaching_in = ReachingIn(shoot(size, 1))
    for gain in (1.0, 0.6):
        frame = (gain * shoot(size, 2)).astype(np.uint8)
        changes = reaching_in.find(frame, 0.0)
        assert not changes.any_reaching_in
        assert abs(changes.gain - gain) < 0.03


@pytest.mark.parametrize('edge', EDGES)
@pytest.mark.parametrize('size', SIZES, ids=str)
def test_finger_reaches_in_from_every_edge(size, edge):
    background, frame = shoot(size, 1), shoot(size, 2)
    frame[EDGES[edge]] = 60
    assert ReachingIn(background).find(frame, 0.0).any_reaching_in


def test_what_touches_what_the_background_does_not_show_reaches_in():
    background, frame = shoot((640, 480), 1), shoot((640, 480), 2)
    unknown = np.zeros((480, 640), np.uint8)
    unknown[:, :16] = 255
    frame[200:260, 16:360], frame[300:340, 400:440] = 60, 60
    background[:, :16] = frame[:, :16]
    found = ReachingIn(background, unknown).find(frame, 0.0).reaching_in
    assert found[55, 50] and not found[80, 105] and not found[:, :4].any()
    assert not ReachingIn(background).find(frame, 0.0).any_reaching_in


@pytest.mark.parametrize('gain', [0.5, 0.8, 1.25])
@pytest.mark.parametrize('edge', EDGES)
@pytest.mark.parametrize('size', SIZES[:3], ids=str)
def test_shade_and_sun_at_the_edge_of_a_textured_table_do_not_reach_in(size, edge, gain):
    background, light = shoot(size, 1), np.ones(size[::-1], np.float32)
    place = tuple(slice(part.start and 6 * part.start, part.stop and 6 * part.stop)
                  for part in EDGES[edge])
    light[place] = gain
    light = cv2.GaussianBlur(light, (0, 0), 8)[..., None]
    frame = np.rint(light * shoot(size, 2)).astype(np.uint8)
    changes = ReachingIn(background).find(frame, 0.0)
    assert changes.differs.any() and not changes.any_reaching_in


def test_arm_with_a_shade_reaches_in_and_so_does_its_shade():
    background, frame = shoot((640, 480), 1), shoot((640, 480), 2)
    frame[200:300, :360] = frame[200:300, :360] // 2
    frame[220:260, :340] = 100
    found = ReachingIn(background).find(frame, 0.0).reaching_in
    assert found[60, 70] and found[72, 70]


def test_shade_at_the_edge_of_a_plain_table_may_be_an_arm():
    background, frame = (np.full((480, 640, 3), 150, np.uint8) for _ in range(2))
    frame[200:260, :360] = 75
    assert ReachingIn(background).find(frame, 0.0).reaching_in[57, 60]


@pytest.mark.parametrize('written', [np.s_[:6], np.s_[4:12:2], np.s_[-3:]])
def test_what_is_written_over_the_picture_does_not_hide_an_arm(written):
    background, frame = (np.random.default_rng(seed).normal(150, 1, (480, 640, 3)).round().astype(
        np.uint8) for seed in (1, 2))
    frame[:200, 300:340], frame[-200:, 300:340] = 90, 90
    for picture in background, frame:
        picture[written] = 255
    assert ReachingIn(background).find(frame, 0.0).any_reaching_in


def test_what_does_not_touch_the_edge_does_not_reach_in():
    background, frame = shoot((640, 480), 1), shoot((640, 480), 2)
    frame[200:260, 300:360] = 60
    square = np.array([[300, 200], [300, 259], [359, 259], [359, 200]], np.int32)
    changes = ReachingIn(background).find(frame, 0.0, [square])
    assert not changes.any_reaching_in
    assert changes.differs.sum() == 15 * 15
