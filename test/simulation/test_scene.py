# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math

from camera_to_base.calibration.boards.board import find_board
from camera_to_base.errors import CalibrationError
from camera_to_base.markers import find_markers
from camera_to_base.simulation import CameraMove, SimulatedBoard, SimulatedScene, Touch
from camera_to_base.simulation.specs import PLACEMENT_COUNT, SHOWN, TABLES
import cv2
import numpy as np
import pytest

EMPTY = SimulatedScene(shows='empty')
MOVES = [CameraMove(shift_px=(12.0, -7.0)), CameraMove(turn_deg=10.0), CameraMove(zoom=1.2),
         CameraMove(tilt_deg=(8.0, 0.0)), CameraMove(tilt_deg=(0.0, -8.0)),
         CameraMove((-20.0, 15.0), -6.0, (5.0, 4.0), 0.9)]


def picture(scene, **parameters):
    """Give the second frame of a scene without noise, and its board."""
    board = SimulatedBoard(scene=scene, **{'noise': 0, **parameters})
    board.read()
    return board.read(), board


def shows_board(frame):
    try:
        return len(find_board(frame, 9, 6).pixels) == 54
    except CalibrationError:
        return False


def pixel(board, point):
    u, v, w = board.pixel_from_surface @ [*point, 1.0]
    return np.array([u / w, v / w])


def middle_of_the_dark(frame, at):
    """Give the centroid of the dark spot about a pixel."""
    u, v = np.rint(at).astype(int)
    window = 255 - frame[v - 45:v + 46, u - 45:u + 46].mean(axis=2)
    weights = np.clip(window - 140, 0, None)
    rows, columns = np.indices(weights.shape) - 45
    return np.array([u, v]) + [(columns * weights).sum() / weights.sum(),
                               (rows * weights).sum() / weights.sum()]


@pytest.mark.parametrize('tilt_deg', [0, 25])
@pytest.mark.parametrize('move', [CameraMove(), *MOVES])
def test_moved_camera_sees_the_objects_at_their_places_on_the_table(move, tilt_deg):
    frame, board = picture(SimulatedScene('still_objects', move=move), tilt_deg=tilt_deg)
    unmoved = SimulatedBoard(scene=SimulatedScene('still_objects'), tilt_deg=tilt_deg)
    unmoved.read()
    unmoved.read()
    assert [true.point for true in board.true_objects] == [
        true.point for true in unmoved.true_objects]
    for true in board.true_objects:
        assert middle_of_the_dark(frame, true.pixel) == pytest.approx(true.pixel, abs=0.15)


@pytest.mark.parametrize('table', TABLES)
@pytest.mark.parametrize('move', MOVES)
def test_table_moves_with_its_homography(table, move):
    # Warping the first picture as the homographies say gives the second one.
    first, start = picture(EMPTY._replace(table=table), texture=4.0)
    second, moved = picture(EMPTY._replace(table=table, move=move), texture=4.0)
    mapping = moved.pixel_from_surface @ start.surface_from_pixel
    expected = cv2.warpPerspective(first, mapping, (640, 480))
    seen = cv2.warpPerspective(np.full_like(first, 255), mapping, (640, 480)) == 255
    assert seen.mean() > 0.5
    close = np.abs(second.astype(int) - expected)[seen]
    assert close.mean() < 2.5
    assert np.abs(second.astype(int) - first)[seen].mean() > 1.5 * close.mean()


def test_move_is_of_the_size_and_direction_that_its_parameters_say():
    middle = np.array([18.0, 13.5])
    for move, expected in [(CameraMove(shift_px=(10.0, -5.0)), (10.0, -5.0)),
                           (CameraMove(turn_deg=30.0), (0.0, 0.0)),
                           (CameraMove(tilt_deg=(20.0, 10.0), zoom=1.5), (0.0, 0.0))]:
        board = picture(EMPTY._replace(move=move))[1]
        assert pixel(board, middle) - (320, 240) == pytest.approx(expected, abs=1e-9)
    turned = picture(EMPTY._replace(move=CameraMove(turn_deg=90.0)))[1]
    assert pixel(turned, middle + [1, 0]) - (320, 240) == pytest.approx((0, 640 / 36))
    near = picture(EMPTY._replace(move=CameraMove(zoom=1.25)))[1]
    assert pixel(near, middle + [1, 0]) - (320, 240) == pytest.approx((1.25 * 640 / 36, 0))
    tilted = picture(EMPTY._replace(move=CameraMove(tilt_deg=(20.0, 10.0))))[1]
    top, bottom = (tilted.surface_from_pixel @ [320, v, 1] for v in (0, 479))
    assert math.dist(top[:2] / top[2], middle) > math.dist(bottom[:2] / bottom[2], middle)


def test_extra_tilt_is_a_tilt():
    by_move = picture(SimulatedScene(move=CameraMove(tilt_deg=(12.0, 0.0))), tilt_deg=8.0)[0]
    np.testing.assert_array_equal(by_move, picture(SimulatedScene(), tilt_deg=20.0)[0])


def test_camera_that_is_put_back_sees_the_first_picture_again():
    board = SimulatedBoard(scene=EMPTY, noise=0, texture=3.0)
    first = board.read()
    board.arrange(EMPTY._replace(move=MOVES[-1]))
    assert np.abs(board.read().astype(int) - first).mean() > 2
    board.arrange(EMPTY)
    np.testing.assert_array_equal(board.read(), first)


@pytest.mark.slow
def test_bumps_are_a_few_px_each_another_one_and_the_same_for_a_seed():
    board = SimulatedBoard()
    random, again = np.random.default_rng(5), np.random.default_rng(5)
    bumps = [board.random_bump(random) for _ in range(50)]
    assert bumps == [board.random_bump(again) for _ in range(50)]
    assert len(set(bumps)) == 50
    for bump in bumps:
        board.arrange(SimulatedScene(move=bump))
        assert 3.5 < board.shift_px < 15.5


@pytest.mark.parametrize('shows', SHOWN)
def test_scene_shows_what_it_says(shows):
    board = SimulatedBoard(scene=EMPTY, noise=0)
    empty = board.read()
    board.arrange(SimulatedScene(shows))
    frame = board.read()
    assert len(board.true_objects) == {'objects': 1, 'still_objects': 5}.get(shows, 0)
    assert shows_board(frame) == (shows == 'board')
    assert np.array_equal(frame, empty) == (shows == 'empty')


def test_still_objects_lie_still_and_apart_and_differ_in_size():
    board = SimulatedBoard(scene=SimulatedScene('still_objects'))
    board.read()
    board.read()
    first = board.true_objects
    board.read()
    assert board.true_objects == first
    radii = sorted((true.radius for true in first), reverse=True)
    assert all(larger > 1.05 * smaller for larger, smaller in zip(radii, radii[1:]))
    points = [true.point for true in first]
    assert min(math.dist(a, b) for a in points for b in points if a != b) > 6


@pytest.mark.slow
@pytest.mark.parametrize('tilt_deg', [0, 30])
@pytest.mark.parametrize('number', range(1, PLACEMENT_COUNT + 1))
def test_whole_board_is_seen_at_each_placement(number, tilt_deg):
    frame, _ = picture(SimulatedScene('board', number), tilt_deg=tilt_deg, noise=2.0)
    assert shows_board(frame)


@pytest.mark.slow
def test_placements_together_cover_the_picture():
    covered = np.zeros((480, 640), bool)
    for number in range(1, PLACEMENT_COUNT + 1):
        frame = picture(SimulatedScene('board', number))[0]
        corners = np.float32(find_board(frame, 9, 6).pixels)
        hull = cv2.convexHull(corners).astype(np.int32)
        covered |= cv2.fillConvexPoly(np.zeros((480, 640), np.uint8), hull, 1) > 0
    # Outside of the outer corners there is always a square and its margin.
    assert covered.mean() > 0.5


@pytest.mark.parametrize('shows', ['empty', 'still_objects'])
@pytest.mark.parametrize('table', TABLES)
@pytest.mark.parametrize('tilt_deg', [0, 25])
def test_markers_are_seen_where_they_lie(table, shows, tilt_deg):
    move = CameraMove((6.0, -4.0), 3.0, (2.0, -1.0), 0.98)
    still = SimulatedScene(shows, 1, True, table)
    for scene in still, still._replace(move=move):
        frame, board = picture(scene, tilt_deg=tilt_deg, noise=2.0)
        found = find_markers(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY))
        assert sorted(found) == [0, 1, 2, 3]
        for number, corners in found.items():
            true = [pixel(board, point) for point in board.true_markers[number]]
            assert corners == pytest.approx(np.array(true), abs=0.6)


def test_layouts_lay_each_object_a_little_elsewhere_and_apart():
    usual = picture(SimulatedScene('still_objects'))[1].true_objects
    seen = set()
    for layout in range(1, 20):
        frame, board = picture(SimulatedScene('still_objects', layout=layout), elongation=1.5)
        again = picture(SimulatedScene('still_objects', layout=layout), elongation=1.5)[0]
        np.testing.assert_array_equal(frame, again)
        points = [true.point for true in board.true_objects]
        assert max(math.dist(*pair) for pair in zip(
            points, (true.point for true in usual))) < 1.5 * math.sqrt(2)
        assert min(math.dist(a, b) for a in points for b in points if a != b) > 5
        seen.add((points[0], board.true_objects[0].yaw))
    assert len(seen) == 19


def test_taken_object_is_gone_and_the_others_stay_as_they_are():
    frame, board = picture(SimulatedScene('still_objects'))
    without, fewer = picture(SimulatedScene('still_objects', taken=(2, 5)))
    kept = [board.true_objects[index] for index in (0, 2, 3)]
    assert fewer.true_objects == kept
    empty, _ = picture(EMPTY)
    for index, true in enumerate(board.true_objects):
        u, v = np.rint(true.pixel).astype(int)
        window = slice(v - 30, v + 31), slice(u - 30, u + 31)
        expected = empty if index in (1, 4) else frame
        np.testing.assert_array_equal(without[window], expected[window])


def test_objects_do_not_lie_on_the_markers():
    frame, board = picture(SimulatedScene('still_objects', markers=True))
    for true in board.true_objects:
        for corners in board.true_markers.values():
            away = np.abs(np.array(true.point) - corners.mean(axis=0)) - 2.7
            assert away.max() > 0


def test_touch_is_at_the_middle_of_what_is_touched():
    board = picture(SimulatedScene('still_objects', markers=True))[1]
    by_size = sorted(board.true_objects, key=lambda true: -true.radius)
    assert [board.point_of(Touch(number)) for number in range(7)] == [
        None, *(true.point for true in by_size), None]
    assert board.point_of(Touch(1, marker=2)) == pytest.approx(
        tuple(board.true_markers[2].mean(axis=0)))
    board.arrange(SimulatedScene('empty'))
    board.read()
    assert board.point_of(Touch(1)) is None and board.point_of(Touch(0, marker=2)) is None
