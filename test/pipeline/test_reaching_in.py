# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.pipeline.reaching_in import ReachingIn
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


def test_what_does_not_touch_the_edge_does_not_reach_in():
    background, frame = shoot((640, 480), 1), shoot((640, 480), 2)
    frame[200:260, 300:360] = 60
    square = np.array([[300, 200], [300, 259], [359, 259], [359, 200]], np.int32)
    changes = ReachingIn(background).find(frame, 0.0, [square])
    assert not changes.any_reaching_in
    assert changes.differs.sum() == 15 * 15
