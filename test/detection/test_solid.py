# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Solid objects are located at what they stand on, or left out with a reason."""

from dataclasses import replace
import math

from camera_to_base.detection import (
    DetectorSettings, HEIGHT_SPECS, object_heights, object_shape, ObjectLocator, sides_of)
from camera_to_base.detection.top_rim import told_height
from camera_to_base.drawing import draw_objects
from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import checked_values
from camera_to_base.surface import (
    LensModel, make_surface, PinholeSurface, RayedSilhouette, SURFACE_SPECS)
import cv2
import numpy as np
import pytest

SIZE = 1280, 720
TABLE, SIDE, TOP = (196, 188, 180), (60, 90, 170), (80, 115, 195)


def camera(tilt_deg):
    """Give a camera that looks at (0, 0) from 75 cm, tilted towards y."""
    tilt = math.radians(tilt_deg)
    position = 75 * np.array([0.0, math.sin(tilt), -math.cos(tilt)])
    turn = np.array([[1, 0, 0], [0, math.cos(tilt), math.sin(tilt)],
                     [0, -math.sin(tilt), math.cos(tilt)]])
    lens = LensModel(SIZE, (1000.0, 1000.0), (640.0, 360.0), (-0.1, 0.02, 0.0, 0.0, 0.0))
    return PinholeSurface(lens, cv2.Rodrigues(turn)[0].ravel(), position)


def prism(centre, length, width, angle, corners=4):
    angles = 2 * np.pi * (np.arange(corners) + 0.5) / corners
    unit = np.column_stack([np.cos(angles), np.sin(angles)])
    if corners == 4:
        unit *= math.sqrt(0.5) * np.array([length, width])
    else:
        unit *= length / 2
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return centre + unit @ turn.T


def picture(surface, *solids, top=TOP):
    """Draw upright solids with soft rims, the farthest first; without a colour, lighter on top."""
    scale = 4
    large = np.full((scale * SIZE[1], scale * SIZE[0], 3), TABLE, np.uint8)
    for base, height, *colour in solids:
        both = np.concatenate([np.column_stack([base, np.full(len(base), z)])
                               for z in (0.0, height)])
        pixels = (surface.pixels_of(both) + 0.5) * scale - 0.5
        cv2.fillConvexPoly(large, cv2.convexHull(np.round(16 * pixels).astype(np.int32)),
                           colour[0] if colour else SIDE, cv2.LINE_AA, 4)
        if not colour:
            cv2.fillConvexPoly(
                large, np.round(16 * pixels[len(base):]).astype(np.int32), top, cv2.LINE_AA, 4)
    frame = cv2.resize(large, SIZE, interpolation=cv2.INTER_AREA)
    noise = np.random.default_rng(3).normal(0, 1.0, frame.shape)
    return np.clip(np.round(frame + noise), 0, 255).astype(np.uint8)


def find(surface, heights, *solids, top=TOP):
    locator = ObjectLocator(
        picture(surface), surface, DetectorSettings(heights_cm=tuple(heights)))
    return locator.find(picture(surface, *solids, top=top))


@pytest.mark.parametrize('tilt_deg', [0, 35])
@pytest.mark.parametrize('height', [2.0, 5.0])
@pytest.mark.parametrize('corners', [4, 6, 60])
def test_prism_is_located_where_it_stands(tilt_deg, height, corners):
    surface = camera(tilt_deg)
    place = np.array([9.0, -6.0])
    found, = find(surface, [height], (prism(place, 5.0, 3.0, 0.4, corners), height)).objects
    assert math.dist(found.point, place) < 0.03
    size = found.size(surface)
    assert size.height_cm == height
    if corners == 4:
        assert found.yaw == pytest.approx(0.4, abs=0.02)
        np.testing.assert_allclose(size[:2], [5.0, 3.0], atol=0.1)


def test_coin_is_located_where_it_lies_below_a_tilted_camera():
    surface, place = camera(35), np.array([9.0, -6.0])
    frame = picture(surface, (prism(place, 2.4, 2.4, 0.0, 60), 0.2))
    off = {}
    for middle_cm in 0.0, 0.1:
        settings = DetectorSettings(flat_middle_cm=middle_cm)
        found, = ObjectLocator(picture(surface), surface, settings).locate(frame)
        off[middle_cm] = math.dist(found.point, place)
    assert off[0.0] > 0.05 and off[0.1] < 0.01


def test_object_without_a_height_is_off_by_its_side():
    surface, place = camera(35), np.array([9.0, -6.0])
    frame = picture(surface, (prism(place, 5.0, 3.0, 0.4), 5.0))
    flat, = ObjectLocator(picture(surface), surface).locate(frame)
    assert math.dist(flat.point, place) > 1.0
    assert flat.solid is None and flat.size(surface).height_cm == 0
    # Its direction is off, too.
    assert abs(flat.yaw - 0.4) > 0.2
    assert not object_shape(flat, frame, picture(surface)).has_yaw


def test_each_object_takes_the_height_that_its_outline_fits():
    surface = camera(35)
    solids = [(prism(np.array([x, y]), 2.0, 2.0, 0.0, 60), height)
              for (x, y), height in (((-12, 2), 1.0), ((0, -5), 2.0), ((12, 4), 5.0))]
    found = find(surface, [1.0, 2.0, 5.0], *solids).objects
    assert sorted((round(one.point.x), one.solid.height_cm) for one in found) == [
        (-12, 1.0), (0, 2.0), (12, 5.0)]


@pytest.mark.parametrize('height, told', [(1.7, 2.0), (2.2, 2.0), (4.6, 5.0), (5.2, 5.0)])
def test_height_need_not_be_exact_to_be_told_from_another(height, told):
    thing = prism(np.array([9.0, -6.0]), 4.0, 3.0, 0.4)
    found, = find(camera(35), [2.0, 5.0], (thing, height)).objects
    assert found.solid.height_cm == told


def test_flat_disc_takes_the_lowest_height_and_no_higher_one():
    discs = [(prism(np.array([x, y]), 2.4, 2.4, 0.0, 60), 0.25)
             for x, y in ((-18, -9), (-6, 3), (7, -7), (16, 5))]
    found = find(camera(31), [0.25, 2.0, 5.0], *discs).objects
    assert [one.solid.height_cm for one in found] == [0.25] * 4
    assert max(min(math.dist(one.point, base.mean(axis=0)) for base, _ in discs)
               for one in found) < 0.05


def test_box_along_the_view_whose_outline_fits_two_heights_is_told_by_its_rim():
    # From a camera at (0, 39) cm, a box 2 cm high and 3 cm deep has the outline of one that is
    # 5 cm high, of the same width, and less deep.
    for height, depth in ((2.0, 3.4), (5.0, 2.2)):
        thing = prism(np.array([0.0, -6.0]), 3.0, depth, 0.0), height
        found, = find(camera(31), [2.0, 5.0], thing).objects
        assert found.solid.height_cm == height
        assert math.dist(found.point, (0.0, -6.0)) < 0.05


def test_height_is_unclear_where_the_outline_fits_two_and_no_rim_is_seen():
    thing = prism(np.array([0.0, -6.0]), 3.0, 2.2, 0.0), 5.0
    found = find(camera(31), [2.0, 5.0], thing, top=SIDE)
    assert not found.objects
    assert found.left_out[0].reason.kind == 'height_unclear'


@pytest.mark.parametrize('top, doubt', [(TOP, 0.5), (SIDE, 6.0)])
def test_side_that_may_be_shade_is_none_where_its_rim_is_seen(monkeypatch, top, doubt):
    surface = camera(31)
    locator = ObjectLocator(picture(surface), surface, DetectorSettings(heights_cm=(5.0,)))
    detect = locator._detector.detect
    monkeypatch.setattr(locator._detector, 'detect', lambda frame: [
        replace(one, doubt=6.0) for one in detect(frame)])
    frame = picture(surface, (prism(np.array([9.0, -6.0]), 5.0, 3.0, 0.4), 5.0), top=top)
    found, = locator.find(frame).objects
    assert found.detection.doubt == doubt


def test_straight_camera_cannot_tell_heights_apart():
    found = find(camera(0), [1.0, 5.0], (prism(np.zeros(2), 5.0, 3.0, 0.4), 5.0))
    assert not found.objects
    assert found.left_out[0].reason.kind == 'height_unclear'


@pytest.mark.parametrize('side, told', [((150, 144, 138), None), (TABLE, 0.25)])
def test_top_whose_side_was_taken_for_shade_is_no_flat_object(side, told):
    surface, base, height = camera(35), prism(np.array([9.0, -6.0]), 4.0, 3.0, 0.4), 2.0
    frame = picture(surface, (base, height, side))
    top = surface.pixels_of(np.column_stack([base, np.full(4, height)]))
    cv2.fillConvexPoly(frame, np.round(top).astype(np.int32), SIDE, cv2.LINE_AA)
    shares = np.linspace(0.0, 1.0, 40, endpoint=False)[:, None]
    outline = np.concatenate([one + shares * (other - one)
                              for one, other in zip(top, np.roll(top, -1, axis=0))])
    place = surface.camera_place
    assert told_height(RayedSilhouette(surface.locate(outline), place.foot_cm), outline, frame,
                       surface, place, [0.25, 2.0, 5.0]) == told


def test_object_that_is_much_lower_than_told_is_left_out():
    found = find(camera(35), [9.0], (prism(np.array([9.0, -6.0]), 2.0, 2.0, 0.0, 60), 0.5))
    assert not found.objects
    assert found.left_out[0].reason.kind == 'other_height'


def test_object_that_fits_badly_is_located_with_its_misfit():
    place = np.array([9.0, -6.0])
    found, = find(camera(35), [3.7], (prism(place, 4.0, 4.0, 0.0, 60), 1.5)).objects
    assert found.solid.misfit_cm > 0
    assert math.dist(found.point, place) < 2 * found.solid.misfit_cm


def test_two_objects_that_are_seen_as_one_are_as_uncertain_as_that_is_wrong():
    places = np.array([[9.0, -6.0], [12.0, -9.5]])
    solids = [(prism(place, 3.0, 3.0, 0.0), 5.0) for place in places]
    found, = find(camera(35), [5.0], *solids).objects
    error = min(math.dist(found.point, place) for place in places)
    assert error > 1.0
    assert error < 2 * found.solid.misfit_cm


COLOURS_IN_A_ROW = [
    ((60, 90, 170), (60, 170, 60)), ((170, 90, 60), (40, 40, 40)), ((60, 170, 60), (170, 90, 60))]


def find_in_a_row(front, behind, corners, place):
    """Find an object at (9, -6) cm before another one."""
    return find(camera(35), [5.0], (prism(place, 3.5, 3.5, 0.1, corners), 5.0, behind),
                (prism(np.array([9.0, -6.0]), 3.5, 3.5, 0.1, corners), 5.0, front))


@pytest.mark.parametrize('front, behind', COLOURS_IN_A_ROW)
@pytest.mark.parametrize('corners', [4, 60])
def test_objects_of_two_colours_that_hide_one_another_are_two(front, behind, corners):
    places = np.array([[9.0, -6.0], [11.0, -12.0]])
    found = find_in_a_row(front, behind, corners, places[1]).objects
    nearest = [min(found, key=lambda one: math.dist(one.point, place)) for place in places]
    errors = [math.dist(one.point, place) for one, place in zip(nearest, places)]
    assert len(found) == 2 and errors[0] < 0.05 and nearest[0].detection.doubt == 0
    # A corner of the other one is hidden.
    cm_per_px = 0.09
    assert errors[1] < 2.0 * cm_per_px * nearest[1].detection.doubt < 0.8


@pytest.mark.parametrize('front, behind', COLOURS_IN_A_ROW)
@pytest.mark.parametrize('corners', [4, 60])
def test_object_whose_foot_is_hidden_is_left_out(front, behind, corners):
    found = find_in_a_row(front, behind, corners, np.array([10.0, -11.0]))
    one, = found.objects
    assert math.dist(one.point, (9.0, -6.0)) < 0.06
    assert 'hidden' in [left_out.reason.kind for left_out in found.left_out]


def test_bracket_of_one_colour_is_one():
    corner = np.array([9.0, -6.0])
    solids = [(prism(corner + np.array(by), *size, 0.0), 2.0, (60, 90, 170)) for by, size in (
        ((0.0, 0.0), (5.0, 2.0)), ((-1.5, 2.0), (2.0, 4.0)))]
    assert len(find(camera(35), [2.0], *solids).objects) == 1


def test_two_colours_without_a_notch_are_one_object():
    surface, place = camera(0), np.array([9.0, -6.0])
    solids = [(prism(place + np.array([by, 0.0]), 2.5, 3.0, 0.0), 2.0, colour) for by, colour in (
        (-1.25, (60, 90, 170)), (1.25, (90, 150, 60)))]
    assert len(find(surface, [2.0], *solids).objects) == 1


def test_outline_without_a_notch_is_not_less_certain():
    found, = find(camera(35), [5.0], (prism(np.array([9.0, -6.0]), 5.0, 3.0, 0.4), 5.0)).objects
    assert found.solid.misfit_cm == 0


def test_limits_of_the_area_hold_for_the_footprint():
    surface, place = camera(35), np.array([9.0, -6.0])
    solid = prism(place, 4.0, 4.0, 0.0), 5.0
    for limit, count in ((15.0, 1), (17.0, 0)):
        settings = DetectorSettings(min_area_cm2=limit, heights_cm=(5.0,))
        locator = ObjectLocator(picture(surface), surface, settings)
        assert len(locator.locate(picture(surface, solid))) == count


CANNOT_BE_USED = {
    'unknown camera height': ({'object_height_cm': 4.0}, 'object_height_cm needs to know where '
                              'the camera is: calibrate board with tilted placements.*'
                              'surface.camera_height_cm'),
    'unknown foot point': (
        {'surface.model': 'homography', 'object_height_cm': 4.0,
         'surface.camera_height_cm': 60.0}, 'set surface.camera_foot_cm'),
    'object above the camera': (
        {'object_height_cm': 61.0, 'surface.camera_height_cm': 60.0},
        "object_height_cm must be below the camera's height, 60 cm, got 61"),
    'one of several above the camera': (
        {'object_heights_cm': [2.0, 61.0], 'surface.camera_height_cm': 60.0},
        'object_heights_cm must be below.*got 61'),
    'negative height': ({'object_height_cm': -1.0}, 'object_height_cm must be 0'),
    'one of several negative': ({'object_heights_cm': [2.0, -1.0]}, 'object_heights_cm must be'),
    'foot point of one number': (
        {'surface.camera_foot_cm': [1.0]},
        r'surface.camera_foot_cm must be 0 or 2 numbers in cm, got \[1.0\]'),
}


def values_of(given):
    return checked_values([*SURFACE_SPECS, *HEIGHT_SPECS], given)


@pytest.mark.parametrize('case', CANNOT_BE_USED)
def test_height_that_cannot_be_used_is_refused_with_the_cure(case):
    given, said = CANNOT_BE_USED[case]
    with pytest.raises(InvalidValueError, match=said):
        values = values_of(given)
        object_heights(values, make_surface(values))


def test_heights_are_ascending_and_zero_is_flat():
    values = values_of({'object_heights_cm': [5.0, 2.0], 'surface.camera_height_cm': 60.0})
    assert object_heights(values, make_surface(values)) == (2.0, 5.0)
    assert object_heights(values_of({}), make_surface(values_of({}))) == ()


def test_parallel_camera_stands_above_the_pictures_centre_whatever_its_size():
    surface = make_surface(values_of({'surface.camera_height_cm': 60.0}))
    for size in ((640, 480), (1280, 720)):
        sized = surface.for_image_size(size)
        centre, = sized.locate([np.subtract(size, 1) / 2])
        assert sized.camera_place.foot_cm == pytest.approx(centre)


def test_footprint_is_drawn_where_it_stands():
    surface, place = camera(35), np.array([9.0, -6.0])
    solid = prism(place, 5.0, 3.0, 0.4), 5.0
    found, = find(surface, [5.0], solid).objects
    drawn = draw_objects(picture(surface, solid), [found])
    corners = surface.pixels(solid[0])
    np.testing.assert_allclose(cv2.minAreaRect(found.solid.pixels.astype(np.float32))[0],
                               corners.mean(axis=0), atol=2)
    u, v = np.round(surface.pixels(place[None]))[0].astype(int)
    assert drawn[v, u].tolist() == [32, 32, 240]


@pytest.mark.parametrize('corners', [4, 6, 60])
@pytest.mark.parametrize('place', [(9.0, -6.0), (-11.0, 3.0)])
def test_object_whose_side_is_seen_is_in_doubt_by_as_much_as_it_is_off(corners, place):
    surface, place = camera(35), np.array(place)
    solid = prism(place, 3.0, 3.0, 0.3, corners), 3.5
    background, frame = picture(surface), picture(surface, solid)
    locator = ObjectLocator(background, surface)
    for _ in range(2):  # The second time it is known.
        found, = locator.locate(frame)
        off = math.dist(found.point, place)
        assert 0.8 * off < found.sides.off_cm < 1.5 * off
        assert 3.2 < found.sides.height_cm < 6.0
        assert object_shape(found, frame, background).misfit_cm == pytest.approx(
            found.sides.off_cm / 1.9)
    assert sides_of(found.detection, surface, surface.camera_place) == found.sides


@pytest.mark.parametrize('corners', [4, 6, 60])
@pytest.mark.parametrize('tilt_deg, place, height', [
    (35, (9.0, -6.0), 0.02), (35, (-11.0, 3.0), 0.02), (0, (0.5, 0.0), 4.0)])
def test_flat_object_and_one_below_the_camera_do_not_look_solid(tilt_deg, place, height, corners):
    thing = prism(np.array(place), 3.0, 3.0, 0.3, corners), height
    found, = find(camera(tilt_deg), [], thing).objects
    assert found.sides is None


def test_object_whose_height_is_told_is_not_in_doubt_by_its_sides():
    solid = prism(np.array([9.0, -6.0]), 3.0, 3.0, 0.3), 3.5
    found, = find(camera(35), [3.5], solid).objects
    assert found.sides is None
