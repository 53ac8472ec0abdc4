# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math

from camera_to_base.detection.detection import Pixel
from camera_to_base.detection.left_out import locate_pixel, Point
from camera_to_base.detection.locator import ObjectLocator
from camera_to_base.detection.settings import DETECTOR_SPECS, DetectorSettings
from camera_to_base.errors import FrameSizeError, HorizonError, InvalidValueError, Level
from camera_to_base.parameters.spec import checked_values
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.surface.models import HomographySurface, ParallelSurface, PolynomialSurface
from camera_to_base.surface.points import Hull
import cv2
import numpy as np
import pytest

# A camera that looks along a road: x = (u - 320) / (v - 112), y = 128 / (v - 112).
ROAD = HomographySurface(np.array([[1, 0, -320], [0, 0, 128], [0, 1, -112]]))


def plain_frame():
    return np.full((480, 640, 3), 220, np.uint8)


def frame_with(*boxes):
    frame = plain_frame()
    for x, y, width, height in boxes:
        frame[y:y + height, x:x + width] = 20
    return frame


# The tutorial's closing kernel has no middle pixel and moves an object by one.
SETTINGS = DetectorSettings(method='tutorial', closing_size=1)


def detector():
    return SETTINGS.detector(plain_frame())


def locator(surface, settings=SETTINGS):
    return ObjectLocator(plain_frame(), surface, settings)


def test_object_is_located_at_the_centre_of_its_box():
    located, = locator(ParallelSurface(32.0)).locate(frame_with((340, 225, 100, 100)))
    assert located.detection.centre == Pixel(390, 275)
    assert located.point == pytest.approx((19.5, 13.75))


def test_each_object_comes_with_its_own_detection_largest_first():
    surface = ParallelSurface(64.0)
    frame = frame_with((400, 300, 60, 60), (50, 60, 100, 120), (300, 80, 80, 80))
    objects = locator(surface).locate(frame)
    assert [located.detection for located in objects] == detector().detect(frame)
    assert [located.point for located in objects] == [
        pytest.approx((10.0, 12.0)), pytest.approx((34.0, 12.0)), pytest.approx((43.0, 33.0))]


def test_frame_without_an_object_gives_none():
    assert locator(ParallelSurface()).locate(plain_frame()) == []


def test_what_is_seen_beyond_the_horizon_is_left_out():
    objects = locator(ROAD).locate(
        frame_with((100, 0, 300, 100), (300, 360, 41, 41), (500, 10, 60, 60), (100, 200, 80, 81)))
    assert [located.point for located in objects] == [
        pytest.approx(((140 - 320) / 128, 1.0)), pytest.approx((0.0, 128 / 268))]


def test_objects_beyond_the_horizon_are_left_out_the_largest_first():
    found = locator(ROAD).find(frame_with((100, 20, 40, 40), (500, 10, 60, 60)))
    assert found.objects == []
    assert [left_out.reason.kind for left_out in found.left_out] == ['beyond_horizon'] * 2
    assert '(530, 40)' in found.left_out[0].reason.sentence


@pytest.mark.parametrize('kind, place, options', [
    ('cut_off', (0, 100, 60, 60), {}),
    ('too_small', (300, 100, 60, 60), {'min_area_cm2': 100.0}),
    ('too_large', (300, 100, 60, 60), {'max_area_cm2': 1.0}),
    ('outside_hull', (300, 100, 60, 60), {'area': Hull([(0, 0), (50, 0), (0, 50)])})])
def test_object_that_does_not_count_is_left_out_with_the_reason(kind, place, options):
    settings = DetectorSettings(method='precise', **options)
    found = locator(ParallelSurface(64.0), settings).find(frame_with(place))
    assert found.objects == [] and [one.reason.kind for one in found.left_out] == [kind]
    assert found.left_out[0].reason.level is Level.OK


def test_frame_of_another_size_is_refused():
    with pytest.raises(FrameSizeError):
        locator(ParallelSurface()).locate(plain_frame()[:, :600])


def test_frame_that_is_no_picture_is_refused():
    with pytest.raises(InvalidValueError):
        locator(ParallelSurface()).locate(plain_frame()[:, :, 0])


@pytest.mark.parametrize('method, expected', [('tutorial', 2), ('precise', 1)])
def test_object_at_the_edge_counts_for_the_tutorial_only(method, expected):
    frame = frame_with((0, 100, 60, 60), (300, 100, 80, 80))
    settings = DetectorSettings(method=method)
    assert len(locator(ParallelSurface(64.0), settings).locate(frame)) == expected


def test_object_at_the_edge_counts_for_precise_where_it_was_asked_for():
    settings = DetectorSettings(method='precise', publish_cut_off=True)
    located, = locator(ParallelSurface(64.0), settings).locate(frame_with((0, 100, 60, 60)))
    assert located.detection.cut_off


@pytest.mark.parametrize('method', ['tutorial', 'precise'])
def test_size_limits_are_in_square_cm_on_the_surface(method):
    # 0.1 cm a pixel: 16, 64 and 144 cm².
    frame = frame_with((50, 60, 40, 40), (300, 80, 80, 80), (400, 300, 120, 120))
    settings = DetectorSettings(method=method, min_area_cm2=30.0, max_area_cm2=100.0)
    located, = locator(ParallelSurface(64.0), settings).locate(frame)
    assert located.point == pytest.approx((34.0, 12.0), abs=0.15)


@pytest.mark.parametrize('tilt_deg', [0, 40])
def test_precise_point_is_right_to_a_tenth_of_a_mm(tilt_deg):
    board = SimulatedBoard(tilt_deg=tilt_deg, frame_rate=0.5)
    locate = ObjectLocator(board.read(), HomographySurface(board.surface_from_pixel),
                           DetectorSettings(method='precise')).locate
    for _ in range(15):
        located, = locate(board.read())
        assert math.dist(located.point, board.true_point) < 0.01


def turn_deg(yaw, true_yaw):
    return math.degrees(abs((yaw - true_yaw + math.pi / 2) % math.pi - math.pi / 2))


def simulated(tilt_deg, method='precise', **conditions):
    board = SimulatedBoard(tilt_deg=tilt_deg, frame_rate=0.4, **conditions)
    locate = ObjectLocator(board.read(), HomographySurface(board.surface_from_pixel),
                           DetectorSettings(method=method)).locate
    return board, locate


@pytest.mark.parametrize('elongation', [1.5, 2.7])
@pytest.mark.parametrize('tilt_deg', [0, 30, 50])
@pytest.mark.parametrize('yaw_deg', [0.0, 15.0, 78.0])
def test_several_objects_are_right_to_a_mm_and_a_degree(elongation, tilt_deg, yaw_deg):
    board, locate = simulated(tilt_deg, diameters_cm=(3.4, 3.0, 2.6), elongation=elongation,
                              yaw_deg=yaw_deg, noise=5.0)
    for _ in range(8):
        objects = locate(board.read())
        whole = [true for true in board.true_objects if true.cut_off < -2]
        assert len(whole) >= 2
        for true in whole:
            found = min(objects, key=lambda found: math.dist(found.point, true.point))
            assert math.dist(found.point, true.point) < 0.1
            assert turn_deg(found.yaw, true.yaw) < 1.0


@pytest.mark.parametrize('tilt_deg', [0, 30, 50])
@pytest.mark.parametrize('diameter_px', [20, 30, 40, 60, 100])
@pytest.mark.parametrize('method', ['tutorial', 'precise'])
def test_coin_has_no_yaw(tilt_deg, diameter_px, method):
    board, locate = simulated(
        tilt_deg, method, diameters_cm=(diameter_px * 36.0 / 640,), noise=10.0)
    yaws = [located.yaw for _ in range(8) for located in locate(board.read())]
    # The tutorial's closing swallows small dark objects.
    assert yaws or (method == 'tutorial' and diameter_px <= 30)
    assert set(yaws) <= {None}


@pytest.mark.parametrize('tilt_deg', [0, 30])
def test_tutorials_yaw_of_a_large_object_is_right_to_a_few_degrees(tilt_deg):
    board, locate = simulated(
        tilt_deg, 'tutorial', diameters_cm=(6.0,), elongation=1.5, yaw_deg=40.0)
    for _ in range(8):
        located, = locate(board.read())
        assert turn_deg(located.yaw, board.true_objects[0].yaw) < 2.0


@pytest.mark.parametrize('size, yaw', [
    ((120, 40), 0.0), ((40, 120), math.pi / 2), ((80, 80), None), ((80, 90), None)])
@pytest.mark.parametrize('method', ['tutorial', 'precise'])
def test_yaw_is_the_direction_of_the_length(size, yaw, method):
    settings = DetectorSettings(method=method, closing_size=1)
    located, = locator(ParallelSurface(), settings).locate(frame_with((300, 100, *size)))
    assert located.yaw == (None if yaw is None else pytest.approx(yaw, abs=0.01))


def test_yaw_turns_from_the_surfaces_x_towards_its_y():
    # The same bar for a surface whose y points up: its yaw turns the other way.
    frame = cv2.fillConvexPoly(
        plain_frame(), np.array([[280, 180], [400, 220], [390, 250], [270, 210]]), (20, 20, 20))
    down, = locator(ParallelSurface(64.0)).locate(frame)
    up, = locator(HomographySurface(np.diag([0.1, -0.1, 1.0]))).locate(frame)
    assert math.degrees(down.yaw) == pytest.approx(18.4, abs=0.5)
    assert up.yaw == pytest.approx(-down.yaw)


def test_object_of_which_a_part_is_missing_has_no_yaw():
    settings = DetectorSettings(method='precise', publish_cut_off=True)
    located, = locator(ParallelSurface(), settings).locate(frame_with((0, 100, 120, 40)))
    assert located.yaw is None


def test_tutorials_object_that_reaches_beyond_the_horizon_has_no_yaw():
    # The centre of its box is on the surface.
    located, = locator(ROAD).locate(frame_with((300, 40, 40, 240)))
    assert located.yaw is None


def test_object_narrower_than_two_closing_kernels_has_no_yaw_for_the_tutorial():
    frame = frame_with((300, 100, 120, 32))
    for closing_size, yaw in ((1, pytest.approx(0.0, abs=0.01)), (20, None)):
        settings = DetectorSettings(method='tutorial', closing_size=closing_size)
        located, = locator(ParallelSurface(), settings).locate(frame)
        assert located.yaw == yaw


@pytest.mark.parametrize('field, value', [
    ('method', 'best'), ('threshold', 256), ('median_size', 4), ('closing_size', 0),
    ('faintest', -1.0), ('min_area_cm2', math.nan), ('max_area_cm2', -1.0)])
def test_setting_that_cannot_be_used_is_refused_by_its_name(field, value):
    with pytest.raises(InvalidValueError, match=field):
        checked_values(DETECTOR_SPECS, {f'detector.{field}': value})


def test_largest_area_below_the_smallest_is_refused():
    with pytest.raises(InvalidValueError, match=r'max_area_cm2 must not be below .*10 cm².*got 9'):
        DetectorSettings(min_area_cm2=10.0, max_area_cm2=9.0)


@pytest.mark.parametrize('surface', [ParallelSurface(), PolynomialSurface(), ROAD])
def test_one_pixel_is_located_as_a_point_of_two_plain_numbers(surface):
    point = locate_pixel(surface, Pixel(417, 265))
    assert isinstance(point, Point)
    assert [type(value) for value in point] == [float, float]
    assert list(point) == surface.locate([[417, 265]])[0].tolist()


def test_pixel_above_the_horizon_is_refused():
    with pytest.raises(HorizonError):
        locate_pixel(ROAD, Pixel(320, 100))


def test_pixel_that_is_not_finite_is_refused():
    with pytest.raises(InvalidValueError):
        locate_pixel(ParallelSurface(), Pixel(float('nan'), 100))


def test_object_beyond_the_horizon_does_not_hide_the_others():
    settings = DetectorSettings(method='precise')
    found = locator(ROAD, settings).find(
        frame_with((300, 20, 40, 40), (300, 300, 60, 60), (100, 400, 30, 30)))
    assert [one.detection.box[:2] for one in found.objects] == [(300, 300), (100, 400)]
    alone = locator(ROAD, settings).find(frame_with((300, 300, 60, 60)))
    assert found.objects[0] == alone.objects[0]
    assert [one.reason.kind for one in found.left_out] == ['beyond_horizon']


def test_several_objects_are_located_as_each_alone():
    settings, boxes = DetectorSettings(method='precise'), ((300, 300, 60, 60), (100, 400, 30, 50))
    both = locator(ROAD, settings).locate(frame_with(*boxes))
    assert both == [one for box in boxes
                    for one in locator(ROAD, settings).locate(frame_with(box))]


def dusty_frame(count, radius=4):
    """Draw a coin and so many specks of dust, about 55 px² each."""
    frame = plain_frame()
    for number in range(count):
        cv2.circle(frame, (15 + 20 * (number % 31), 12 + 20 * (number // 31)), radius,
                   (40, 40, 40), cv2.FILLED)
    cv2.circle(frame, (300, 400), 30, (40, 40, 40), cv2.FILLED)
    return frame


@pytest.mark.parametrize('width_cm, options, published, kinds', [
    (16.0, {}, 1, {'speck'}),
    # What a file of today says stays.
    (16.0, {'min_area_cm2': 0.0}, 100, {'too_much'}),
    (16.0, {'min_area_cm2': 0.1}, 1, {'speck'}),
    (40.0, {'min_area_cm2': 1.0}, 1, {'too_small', 'too_much'})])
def test_dust_is_counted_but_not_published(width_cm, options, published, kinds):
    found = locator(ParallelSurface(width_cm), DetectorSettings(**options)).find(dusty_frame(400))
    assert len(found.objects) == published
    assert len(found.left_out) == 401 - published
    assert {one.reason.kind for one in found.left_out} == kinds


def test_small_thing_below_a_microscope_is_no_speck():
    found = locator(ParallelSurface(1.6), DetectorSettings()).find(dusty_frame(3, radius=8))
    assert len(found.objects) == 4 and not found.left_out
