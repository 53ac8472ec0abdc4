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
import time

from camera_to_base.pipeline import Limits, ViewCheck, ViewWatch
import cv2
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[3] / 'benchmarks'))
import attack_scenes as scenes  # noqa: E402, I100
import nudge_scenes  # noqa: E402, I100

STRUCTURED = ['wood', 'faint grain', 'speckle', 'tiles', 'print', 'four marks']
BUMPS = {'5 px': (3, -4, 0, 0), '10 px': (8, 6, 0, 0), '40 px': (-38, 12, 0, 0),
         'turned by 0.6 deg': (0, 0, 0.6, 0), 'zoomed by 1.2 %': (0, 0, 0, 0.012)}


def table(name, seed=7):
    return scenes.Table(name, np.random.default_rng(seed))


def watch(table, limits=Limits()):
    return ViewWatch(table.shoot(), limits, table.shoot())


def arm(tip=(300, 240), colour=(90, 120, 170)):
    return scenes.arm(scenes.arm_cover((420, 560), tip, 80, np.zeros(4)), colour)


@pytest.mark.parametrize('name', STRUCTURED)
def test_first_frame_of_a_camera_that_was_bumped_is_held_back(name):
    surface = table(name)
    view = watch(surface)
    for move in BUMPS.values():
        assert view.reason(surface.shoot(move)) is not None
        assert view.reason(surface.shoot(move, [scenes.coin((300, 200)), arm()])) is not None
        assert view.reason(surface.shoot()) is None


@pytest.mark.parametrize('name', STRUCTURED + ['parallel lines', 'plain'])
def test_coins_hands_and_steps_of_the_light_are_no_bump(name):
    surface = table(name)
    view = watch(surface)
    for light in (0.4, 1.0, 1.4):
        for draw in ([], [scenes.coin((100, 100))], [arm()], [scenes.coin((320, 90)), arm()]):
            assert view.reason(surface.shoot(draw=draw, light=light)) is None


@pytest.mark.parametrize('name', ['wood', 'four marks'])
def test_frames_of_an_untouched_camera_are_cleared_by_the_quick_look(name, monkeypatch):
    surface = table(name)
    view = watch(surface)
    monkeypatch.delattr(ViewCheck, 'compare')
    for number in range(20):
        view.reason(surface.shoot(draw=[scenes.coin((60 + 25 * number, 200))]))


@pytest.mark.slow
@pytest.mark.parametrize('name', ['wood', 'faint grain', 'print'])
def test_noise_that_the_background_has_not_is_soon_taken_for_usual(name, monkeypatch):
    surface = table(name)
    mean = np.median([surface.shoot() for _ in range(9)], axis=0).astype(np.uint8)
    view = ViewWatch(mean, Limits())
    assert sum(view.reason(surface.shoot()) is not None for _ in range(30)) <= 2
    surface._noise_levels *= 2
    assert sum(view.reason(surface.shoot()) is not None for _ in range(30)) <= 2
    monkeypatch.delattr(ViewCheck, 'compare')
    for _ in range(10):
        view.reason(surface.shoot())


def test_drift_within_the_limit_is_told_and_goes_on():
    surface = table('wood')
    view = watch(surface)
    assert view.reason(surface.shoot((1.2, 1.0, 0, 0))) is None
    assert view.view.shift_px == pytest.approx(1.6, abs=0.4)


def test_frame_of_a_camera_that_has_drifted_is_moved_back():
    surface = table('print')
    view, before = watch(surface), surface.shoot().astype(int)
    frame = surface.shoot((1.2, -1.0, 0.1, 0))
    view.reason(frame)
    inner = np.s_[10:-10, 10:-10]
    moved_back = np.abs(view.motion.moved_back(frame) - before)[inner].mean()
    assert moved_back < 0.8 * np.abs(frame - before)[inner].mean()


def test_how_far_the_camera_was_bumped_is_said():
    surface = table('print')
    reason = watch(surface).reason(surface.shoot((8, 6, 0, 0)))
    assert reason.kind == 'view_moved' and 'moved by 10.' in reason.sentence


@pytest.mark.slow
@pytest.mark.parametrize('seed', range(6))
def test_far_tilt_of_a_faint_surface_is_not_taken_for_a_small_shift(seed):
    random = np.random.default_rng(seed)
    camera = nudge_scenes.Camera(table('faint grain', seed), random)
    nudge = nudge_scenes.random_nudge(random, 16.0, 'tilt')
    view = ViewWatch(camera.shoot(nudge(0.0)), Limits(), camera.shoot(nudge(0.0)))
    assert view.reason(camera.shoot(nudge(0.0))) is None
    assert all(view.reason(camera.shoot(nudge(1.0))) is not None for _ in range(10))


@pytest.mark.slow
@pytest.mark.parametrize('name,seed', [
    ('tiles', 0), ('tiles', 1), ('tiles', 2), ('table edge', 0), ('table edge', 1),
    ('table edge', 16)])
def test_slide_along_an_edge_is_noticed_in_any_light(name, seed):
    surface = table(name, seed)
    view = watch(surface)
    for light in (0.7, 1.0, 1.2, 1.35):
        assert view.reason(surface.shoot(light=light)) is None
        for move in ((10, 0, 0, 0), (0, 10, 0, 0), (-19, 0, 0, 0), (0, -14, 0, 0)):
            assert view.reason(surface.shoot(move, light=light)) is not None


def test_surface_without_structure_is_told_and_holds_nothing_back():
    surface = table('plain')
    view = watch(surface)
    assert view.reason(surface.shoot((20, 0, 0, 0))) is None
    assert not view.view.has_structure


@pytest.mark.parametrize('quality', [60, 80, 92])
@pytest.mark.parametrize('noise, count', [(1.6, 1), (1.6, 7), (3.0, 1), (3.0, 25)])
def test_compressed_noise_is_no_structure_and_no_belt(noise, count, quality):
    random = np.random.default_rng(5)

    def shoot():
        picture = random.normal(185, noise, (480, 640, 3)).round().clip(0, 255)
        coded = cv2.imencode('.jpg', picture, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
        return cv2.imdecode(coded, cv2.IMREAD_COLOR)

    background = np.median([shoot() for _ in range(count)], axis=0).astype(np.uint8)
    for witness in (None, shoot()):
        view = ViewWatch(background, Limits(), witness)
        assert view.reason(shoot()) is None
        assert view.motion.is_in_place


def test_step_across_parallel_lines_is_held_back():
    surface = table('parallel lines', seed=3)
    view = watch(surface)
    assert any(view.reason(surface.shoot((*move, 0, 0))) for move in ((9, 0), (0, 9)))


def test_belt_that_moves_while_the_background_is_taken_is_no_structure():
    surface = table('wood')
    view = ViewWatch(surface.shoot(), Limits(), surface.shoot((18, 0, 0, 0)))
    assert view.reason(surface.shoot((40, 0, 0, 0))) is None
    assert not view.view.has_structure


def test_another_place_is_held_back_though_no_shift_can_be_told():
    view, other = watch(table('print', 1)), table('print', 2)
    assert view.reason(other.shoot()) is not None


def test_covered_structure_is_held_back_until_it_is_uncovered():
    surface = table('wood')
    view, frame = watch(surface), surface.shoot()
    frame[:, 120:] = 90
    reason = view.reason(frame)
    assert reason.kind in ('view_changed', 'view_unknown') and 'uncover' in reason.sentence
    assert view.reason(surface.shoot()) is None


def test_smaller_share_that_may_change_is_respected():
    surface = table('wood')
    view, frame = watch(surface, Limits(max_changed_share=0.2)), surface.shoot()
    frame[:, :256] = 90
    assert view.reason(frame).kind == 'view_changed'
    view.configure(Limits(max_changed_share=0.7))
    assert view.reason(frame) is None


def test_check_can_be_switched_off():
    surface = table('wood')
    assert watch(surface, Limits(max_shift_px=0.0)).reason(surface.shoot((20, 0, 0, 0))) is None


@pytest.mark.parametrize('size', [(1, 1), (2, 3), (3, 700), (700, 3), (17, 33), (48, 64)])
def test_odd_sizes_are_watched(size):
    random = np.random.default_rng(1)
    frames = [random.integers(0, 255, (*size, 3)).astype(np.uint8) for _ in range(3)]
    ViewWatch(frames[0], Limits(), frames[1]).reason(frames[2])
    ViewWatch(frames[0], Limits()).reason(frames[0])


def test_quick_look_costs_a_few_milliseconds_at_most():
    surface = table('wood')
    view, frame, times = watch(surface), surface.shoot(), []
    for _ in range(20):
        begin = time.perf_counter()
        view.reason(frame)
        times.append(time.perf_counter() - begin)
    assert min(times) < 0.005


@pytest.mark.parametrize('move', [(12, 9, 0, 0), (40, 5, 0, 0), (-30, 60, 2, 0)])
@pytest.mark.parametrize('levels', [-60, 25, 60])
def test_moved_view_of_nothing_but_a_plain_box_is_held_back(levels, move):
    surface = table('plain')
    colour = tuple(map(float, surface.colour + levels))
    cv2.rectangle(surface.canvas, (250, 200), (420, 330), colour, -1)
    view = watch(surface)
    assert view.reason(surface.shoot()) is None
    assert view.reason(surface.shoot(move)) is not None
