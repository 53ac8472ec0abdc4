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

from camera_to_base.pipeline.view.view_check import View, view_reason, ViewCheck
import cv2
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[3] / 'benchmarks'))
import view_shift  # noqa: E402, I100


@pytest.fixture(params=['board', 'wood', 'tiles'])
def surface(request):
    return view_shift.SURFACES[request.param]()


def shifts(surface, move, disturbance='nothing', noise=2.0):
    return view_shift.measure(
        surface, view_shift.MOVES[move], view_shift.DISTURBANCES[disturbance], 3, noise)


@pytest.mark.parametrize('disturbance', ['nothing', 'coin', 'hand', 'brighter', 'sun and shadow'])
def test_camera_that_was_not_touched_never_counts_as_moved(surface, disturbance):
    told = [shift for shift in shifts(surface, 'none', disturbance) if shift is not None]
    assert all(shift < 1.0 for shift in told)


@pytest.mark.parametrize('move, true_px', [('5 px', 5.0), ('0.5 deg', 3.5), ('2 deg', 14.0)])
@pytest.mark.parametrize('disturbance', ['nothing', 'brighter'])
def test_shift_and_rotation_are_told(surface, move, true_px, disturbance):
    assert shifts(surface, move, disturbance) == pytest.approx([true_px] * 3, abs=1.0, rel=0.3)


@pytest.mark.slow
@pytest.mark.parametrize('disturbance', ['nothing', 'coin'])
def test_nudge_is_told_after_a_hundred_checks_of_an_untouched_camera(surface, disturbance):
    random = np.random.default_rng(5)
    check = ViewCheck(view_shift.seen(surface, view_shift.MOVES['none'], random))

    def told(move):
        frame = view_shift.seen(surface, view_shift.MOVES[move], random,
                                disturb=view_shift.DISTURBANCES[disturbance])
        return check.compare(frame).shift_px

    assert max(told('none') for _ in range(100)) < 1.0
    assert told('5 px') == pytest.approx(5.0, abs=0.5)
    assert told('2 deg') == pytest.approx(14.0, abs=0.5)


def vignette(depth):
    v, u = np.mgrid[:480, :640]
    return (1 - depth * np.hypot(u - 320, v - 240) / 400)[..., None]


def white_table(mark=None, width=0, light=1.0):
    """Draw a white table with one textured mark, the lens darkening the corners."""
    picture = np.full((480, 640, 3), 200.0)
    if mark is not None:
        texture = np.random.default_rng(9).integers(40, 200, (width // 10, width // 10), np.uint8)
        u, v = mark
        picture[v:v + width, u:u + width] = cv2.resize(
            texture, (width, width), interpolation=cv2.INTER_NEAREST)[..., None]
    return picture * light


def seen(picture, random):
    return np.clip(picture + random.normal(0, 2, picture.shape), 0, 255).astype(np.uint8)


@pytest.mark.slow
@pytest.mark.parametrize('width', [140, 160, 180, 200])
def test_camera_that_was_not_touched_does_not_count_as_moved_where_all_structure_is_in_one_place(
        width):
    random, table = np.random.default_rng(3), white_table((40, 40), width, vignette(0.2))
    check = ViewCheck(seen(table, random))
    views = [check.compare(seen(table, random)) for _ in range(40)]
    assert not [view for view in views if view_reason(view, 3.0, 0.7)]


def test_cup_on_the_only_mark_of_a_table_does_not_count_as_another_view():
    random, table = np.random.default_rng(3), white_table((300, 200), 30)
    check = ViewCheck(seen(table, random))
    cv2.circle(table, (315, 215), 60, (60, 60, 60), -1)
    views = [check.compare(seen(table, random)) for _ in range(40)]
    assert not [view for view in views if view_reason(view, 3.0, 0.7)]


@pytest.mark.parametrize('depth', [0.0, 0.1, 0.2, 0.4])
def test_light_that_falls_off_to_the_corners_is_no_structure(depth):
    random, table = np.random.default_rng(3), white_table(light=vignette(depth))
    check = ViewCheck(seen(table, random))
    assert not any(check.compare(seen(table, random)).has_structure for _ in range(5))


def test_pictures_are_not_written_to(surface):
    random = np.random.default_rng(5)
    pictures = [view_shift.seen(surface, view_shift.MOVES[move], random)
                for move in ('none', '5 px')]
    copies = [picture.copy() for picture in pictures]
    views = []
    check = ViewCheck(pictures[0])
    for _ in range(3):
        views.append(check.compare(pictures[1]))
    assert all((picture == copy).all() for picture, copy in zip(pictures, copies))
    assert views[1:] == views[:-1]


@pytest.mark.parametrize('move, true_px', [('5 px', 5.0), ('20 px', 20.0), ('2 deg', 14.0)])
def test_nudge_is_told_though_a_hand_covers_a_fifth_of_the_view(surface, move, true_px):
    assert shifts(surface, move, 'hand') == pytest.approx([true_px] * 3, abs=1.0)


def test_dark_picture_of_the_same_view_has_not_changed(surface):
    random = np.random.default_rng(5)
    check = ViewCheck(view_shift.seen(surface, (0, 0, 0), random))
    view = check.compare(view_shift.seen(
        surface, (0, 0, 0), random, disturb=lambda picture, _: 0.3 * picture))
    assert view.shift_px < 1.0 and view.changed_share < 0.2


@pytest.mark.parametrize('noise', [0.0, 2.0, 12.0])
def test_noise_is_no_structure(noise):
    random = np.random.default_rng(5)
    check = ViewCheck(view_shift.seen(view_shift.plain(), (0, 0, 0), random, noise))
    for move in ((0, 0, 0), (3, -4, 0)):
        view = check.compare(view_shift.seen(view_shift.plain(), move, random, noise))
        assert view == View(None, 0.0, has_structure=False)


def test_marks_in_the_corners_make_a_surface_of_one_colour_tell_a_shift():
    surface = view_shift.plain()
    for u, v in ((90, 90), (660, 90), (90, 500), (660, 500)):
        cv2.drawMarker(surface, (u, v), (40, 40, 40), cv2.MARKER_CROSS, 50, 7)
    assert shifts(surface, '5 px', 'coin') == pytest.approx([5.0] * 3, abs=0.5)


def test_large_shift_is_told_where_the_surface_has_a_structure_of_its_own():
    assert shifts(view_shift.wood(), '20 px', 'coin') == pytest.approx([20.0] * 3, abs=2.0)


def test_shift_cannot_be_told_on_a_surface_of_one_colour():
    assert shifts(view_shift.plain(), '20 px') == [None] * 3


def test_picture_of_something_else_is_a_changed_view():
    random = np.random.default_rng(1)
    check = ViewCheck(view_shift.seen(view_shift.tiles(), (0, 0, 0), random))
    view = check.compare(view_shift.seen(view_shift.wood(), (0, 0, 0), random))
    assert 'differs' in view_reason(view, 3.0, 0.7).sentence


def test_covered_view_is_a_changed_one_though_the_rest_tells_that_it_has_not_moved():
    random = np.random.default_rng(1)
    check = ViewCheck(view_shift.seen(view_shift.tiles(), (0, 0, 0), random))
    frame = view_shift.seen(view_shift.tiles(), (0, 0, 0), random)
    frame[:, 170:] = 120
    view = check.compare(frame)
    assert view.shift_px < 1.0
    assert 'uncover' in view_reason(view, 3.0, 0.7).sentence


@pytest.mark.parametrize('size', [(1, 1), (2, 3), (3, 700), (700, 3), (17, 33)])
def test_odd_sizes_are_compared(size):
    random = np.random.default_rng(1)
    frames = [random.integers(0, 255, (*size, 3)).astype(np.uint8) for _ in range(2)]
    assert ViewCheck(frames[0]).compare(frames[1]).changed_share <= 1.0


def test_reason_says_how_far_the_view_has_moved_and_what_to_do():
    assert view_reason(View(2.9, 0.1), 3.0, 0.7) is None
    assert view_reason(View(None, 0.6), 3.0, 0.7) is None
    reason = view_reason(View(7.25, 0.1), 3.0, 0.7)
    assert reason.kind == 'view_moved'
    assert '7.2 px' in reason.sentence and '~/capture_background' in reason.sentence
