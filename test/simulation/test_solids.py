# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Solid objects on the simulated table: where they are seen, how light they are, their shadows."""

import math

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters.spec import checked_values
from camera_to_base.simulation import CameraMove, SimulatedBoard, SimulatedScene
from camera_to_base.simulation.disturbances import BoardConditions
from camera_to_base.simulation.solids import draw_solids, polygon_coverage
from camera_to_base.simulation.specs import SHAPES, SIMULATION_SPECS
from camera_to_base.simulation.view import BoardView, Oval
import cv2
import numpy as np
import pytest

STILL = SimulatedScene('still_objects')
MOVE = CameraMove((12.0, -7.0), 6.0, (5.0, -4.0), 1.1)
SIZE, MIDDLE = (640, 480), (18.0, 13.5)
EMPTY_LEVEL = 200.0


def picture(scene=STILL, **parameters):
    """Give the second frame, without noise, and its board."""
    board = SimulatedBoard(scene=scene, **{'noise': 0, **parameters})
    board.read()
    return board.read(), board


def drawn(*ovals, tilt_deg=0.0, move=CameraMove()):
    """Draw objects on an even table."""
    view, conditions = BoardView(SIZE, 36.0, tilt_deg, move), BoardConditions()
    table = np.full((*SIZE[::-1], 3), EMPTY_LEVEL, np.float32)
    draw_solids(table, ovals, view, conditions)
    return table, view


def box(point=MIDDLE, height=4.0, yaw=0.3):
    return Oval(point, 2.0, 1.2, yaw, 'box', height)


def colourful(frame):
    """Tell which pixels show paint: neither table nor shadow has a colour here."""
    return np.ptp(frame, axis=2) > 0.2 * frame.max(axis=2)


def corners_of(oval):
    """Give the corners of a box at the surface and at its top, shape (8, 3)."""
    cos, sin = math.cos(oval.yaw), math.sin(oval.yaw)
    base = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [oval.half_length, oval.half_width]
    base = base @ [[cos, sin], [-sin, cos]] + oval.point
    return np.array([[*corner, z] for z in (0.0, oval.height_cm) for corner in base])


@pytest.mark.parametrize('move', [CameraMove(), MOVE])
@pytest.mark.parametrize('tilt_deg', [0, 35])
@pytest.mark.parametrize('point', [MIDDLE, (9.0, 8.0), (26.0, 18.0)])
def test_box_is_seen_where_a_pinhole_shows_its_corners(point, tilt_deg, move):
    oval = box(point)
    table, view = drawn(oval, tilt_deg=tilt_deg, move=move)
    hull = cv2.convexHull(view.pinhole.pixels_of(corners_of(oval)).astype(np.float32))
    moments = cv2.moments(hull)
    v, u = np.nonzero(colourful(table))
    assert len(u) == pytest.approx(moments['m00'], rel=0.02)
    centre = moments['m10'] / moments['m00'], moments['m01'] / moments['m00']
    assert (u.mean(), v.mean()) == pytest.approx(centre, abs=0.15)


@pytest.mark.parametrize('tilt_deg', [0, 20, 50])
@pytest.mark.parametrize('move', [CameraMove(), MOVE])
def test_camera_knows_its_own_place(tilt_deg, move):
    board = SimulatedBoard(tilt_deg=tilt_deg, scene=STILL._replace(move=move))
    pixels = np.array([[50.0, 400.0], [320.0, 240.0], [600.0, 30.0]])
    scaled = np.column_stack([pixels, np.ones(3)]) @ board.surface_from_pixel.T
    assert board.pinhole.locate(pixels) == pytest.approx(scaled[:, :2] / scaled[:, 2:])
    if move == CameraMove():
        tilt = math.radians(tilt_deg)
        place = board.pinhole.camera_place
        assert place.height_cm == pytest.approx(60 * math.cos(tilt))
        assert place.foot_cm == pytest.approx((18.0, 13.5 + 60 * math.sin(tilt)))


@pytest.mark.parametrize('shape', SHAPES)
def test_true_position_is_that_of_what_an_object_stands_on(shape):
    flat = picture()[1].true_objects
    solid = picture(shapes=(shape,), heights_cm=(5.0,), tilt_deg=30)[1].true_objects
    assert [true.point for true in solid] == [true.point for true in flat]
    assert all(high.radius > low.radius for high, low in zip(solid, flat))


def test_sides_are_darker_than_the_top_and_each_is_another_one():
    table, _ = drawn(box(yaw=0.7), tilt_deg=40)
    red = np.rint(table[:, :, 2][colourful(table)])
    levels, counts = np.unique(red, return_counts=True)
    large = levels[counts > 0.05 * counts.sum()]
    assert len(large) == 3
    assert large[-1] == round(1.8 * (BoardConditions().table_level - BoardConditions().contrast))


def test_two_lamps_make_two_shadows_on_the_sides_away_from_them():
    table, view = drawn(box(height=6.0))
    shade = np.where(colourful(table), EMPTY_LEVEL, np.rint(table[:, :, 0]))
    levels, counts = np.unique(shade[shade < EMPTY_LEVEL - 5], return_counts=True)
    dark, light = sorted(levels[np.argsort(counts)[-2:]])
    assert 0.5 * EMPTY_LEVEL < dark < light - 10 < EMPTY_LEVEL - 30
    for level, side in ((dark, (1, 1)), (light, (-1, -1))):
        v, u = np.nonzero(shade == level)
        from_middle = np.column_stack([u, v]) * view.cm_per_px - MIDDLE
        assert (from_middle.mean(axis=0) * side > 0.3).all()
        assert 2.0 < np.hypot(*from_middle.T).max() < 2.4 + 6.0


def test_flat_object_has_neither_sides_nor_shadow():
    table, _ = drawn(box(height=0.0), tilt_deg=30)
    painted = colourful(cv2.erode(table, np.ones((3, 3))))
    assert np.ptp(table[~cv2.dilate(painted.astype(np.uint8), np.ones((9, 9))).astype(bool)]) == 0


def test_nearer_object_hides_the_farther_one_in_any_order():
    near, far = box((18.0, 15.5), 6.0, 0.0), box((18.0, 12.0), 2.0, 0.0)
    one, view = drawn(near, far, tilt_deg=50)
    other, _ = drawn(far, near, tilt_deg=50)
    np.testing.assert_array_equal(one, other)
    # The near box hides a part of the far one, as it does alone.
    rows, columns = view.box(view.pixels_above(corners_of(near)))
    alone, _ = drawn(near, tilt_deg=50)
    seen = colourful(alone)
    assert np.abs(one - alone)[seen].max() < 0.5 * np.abs(one - alone)[rows, columns].max()


def test_flat_discs_are_drawn_as_ever():
    frame, board = picture()
    again, _ = picture(heights_cm=(0.0,), shapes=('disc',))
    np.testing.assert_array_equal(frame, again)
    mixed, _ = picture(heights_cm=(3.0, 0.0, 0.0, 0.0, 0.0))
    u, v = np.rint(board.true_objects[3].pixel).astype(int)
    window = slice(v - 25, v + 26), slice(u - 25, u + 26)
    np.testing.assert_array_equal(frame[window], mixed[window])


@pytest.mark.parametrize('turn', [0.0, 0.4, 1.1])
def test_polygon_covers_its_area_whichever_way_it_goes_round(turn):
    cos, sin = math.cos(turn), math.sin(turn)
    corners = np.array([[-9, -4], [9, -4], [9, 4], [-9, 4]]) @ [[cos, sin], [-sin, cos]]
    corners += [20.3, 17.8]
    window = slice(0, 40), slice(0, 40)
    covered = polygon_coverage(corners, *window)
    assert covered.sum() == pytest.approx(18 * 8, rel=0.02)
    np.testing.assert_allclose(polygon_coverage(corners[::-1], *window), covered, atol=1e-5)


@pytest.mark.parametrize('shape', SHAPES)
def test_solid_objects_at_the_edge_of_small_pictures_are_drawn(shape):
    for image_size in ((7, 5), (64, 48)):
        frame, _ = picture(SimulatedScene(), image_size=image_size, tilt_deg=20, over_edge=True,
                           shapes=(shape,), heights_cm=(6.0,))
        assert frame.shape == (*image_size[::-1], 3)


@pytest.mark.parametrize('name, value', [
    ('heights_cm', [2.0, 6.1]), ('heights_cm', [-1.0]), ('heights_cm', []),
    ('shapes', ['box', 'ball']), ('shapes', 'box'), ('shapes', [])])
def test_error_names_the_bad_parameter(name, value):
    with pytest.raises(InvalidValueError, match=f'simulated.{name}'):
        checked_values(SIMULATION_SPECS, {f'simulated.{name}': value})
