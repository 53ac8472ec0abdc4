# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from pathlib import Path
import sys

from camera_to_base.pipeline import Limits, ViewWatch
from camera_to_base.pipeline.view.motion_fit import MotionFit, TILTED
from camera_to_base.pipeline.view.quick_look import QuickLook
import cv2
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[3] / 'benchmarks'))
import attack_scenes as scenes  # noqa: E402, I100

# Of 0.8 to 1 px at a corner.
MOVES = {'right': (0.8, 0, 0, 0), 'down': (0, -0.8, 0, 0), 'aslant': (0.6, 0.6, 0, 0),
         'turn': (0, 0, 0.143, 0), 'zoom': (0, 0, 0, -0.0025)}


def table(name, seed=7):
    return scenes.Table(name, np.random.default_rng(seed))


def glance(surface):
    return QuickLook(surface.shoot(), surface.shoot()).glance


@pytest.mark.parametrize('name', ['wood', 'speckle', 'tiles', 'print', 'four marks'])
def test_camera_that_stands_still_needs_no_more(name):
    surface = table(name)
    look = glance(surface)
    seen = [look(surface.shoot(draw=[scenes.coin((100 + 60 * number, 230))]))
            for number in range(8)]
    assert sum(one is not None and one.share > 0.7 and one.shift_px < 0.5 for one in seen) >= 6


@pytest.mark.slow
@pytest.mark.parametrize('name', ['wood', 'faint grain', 'speckle', 'tiles', 'print'])
@pytest.mark.parametrize('move', MOVES)
def test_smallest_motion_that_is_moved_back_is_left_to_the_whole_look(name, move):
    for seed in range(3):
        surface = table(name, seed)
        look = glance(surface)
        coin = [scenes.coin((140 + 100 * seed, 200))]
        assert look(surface.shoot(MOVES[move], coin)) is None


@pytest.mark.parametrize('name', ['wood', 'tiles', 'print'])
def test_tilt_is_left_to_the_whole_look(name):
    surface = table(name)
    look, still = glance(surface), surface.shoot()
    fit = MotionFit(np.zeros((1, 2)), scenes.SIZE, np.eye(2)[None], TILTED)
    for tilt in ((1.5, 0), (-1.2, 1.0), (0, -1.5)):
        matrix = fit.matrix(np.array([0, 0, 0, 0, *tilt], float))
        assert look(still) is not None
        assert look(cv2.warpPerspective(
            still, matrix, scenes.SIZE, borderMode=cv2.BORDER_REFLECT)) is None


def test_cover_over_much_of_the_surface_is_left_to_the_whole_look():
    surface = table('wood')
    look, frame = glance(surface), surface.shoot()
    frame[:, :260] = 90
    assert look(frame) is None


def test_share_that_must_be_in_place_is_respected_though_a_few_patches_would_do():
    surface = table('print')
    frame = surface.shoot()
    frame[120:240, 160:320] = 90
    assert 0.7 <= glance(surface)(frame).share < 0.97
    limits = Limits(max_changed_share=0.02)
    assert ViewWatch(surface.shoot(), limits).reason(frame).kind == 'view_changed'


@pytest.mark.parametrize('light', [0.2, 1.9])
def test_much_darker_or_lighter_frame_is_left_to_the_whole_look(light):
    surface = table('wood')
    look = glance(surface)
    assert look(surface.shoot()) is not None
    assert look(surface.shoot(light=light)) is None


def test_surface_of_parallel_lines_is_left_to_the_whole_look():
    surface = table('parallel lines')
    assert glance(surface)(surface.shoot()) is None
