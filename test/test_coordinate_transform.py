# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math
import os
import re
import subprocess
import sys

from camera_to_base.coordinate_transform import (
    CameraToRobotBaseConversion, CoordinateConversion, homogeneous_matrix, rotation_matrix)
from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np
import pytest

X, Y, Z = np.eye(3)


def tutorial_conversion():
    return CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)


def turn(axis, angle_deg):
    return cv2.Rodrigues(axis * np.deg2rad(angle_deg))[0]


def printed_positions():
    environment = {**os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    printed = subprocess.run(
        [sys.executable, '-m', 'camera_to_base.coordinate_transform'],
        env=environment, capture_output=True, text=True, timeout=60, check=True).stdout
    positions = re.findall(r'^(\d\.\d):x: (\S+), y: (\S+)$', printed, re.MULTILINE)
    return np.array(positions, dtype=float)


@pytest.mark.parametrize('u, v', [(0, 0), (250, 450), (390, 275), (639, 479)])
def test_tutorials_numbers_give_the_tutorials_base_point(u, v):
    x, y = 36.0 / 640 * u, 36.0 / 640 * v
    base_point = tutorial_conversion().convert(np.array([[x], [y], [0.0], [1.0]]))
    assert base_point.ravel() == pytest.approx(
        [0.05625 * u - 17.8, 24.4 - 0.05625 * v, 0.0, 1.0], abs=1e-9)


def test_one_point_comes_back_as_one_column():
    assert tutorial_conversion().convert([[1], [2], [3], [1]]).shape == (4, 1)


def test_many_points_are_converted_as_each_of_them_alone():
    points = np.vstack([np.random.default_rng(1).uniform(-50, 50, (3, 17)), np.ones(17)])
    together = tutorial_conversion().convert(points)
    alone = [tutorial_conversion().convert(points[:, [column]]) for column in range(17)]
    assert together.shape == (4, 17)
    np.testing.assert_allclose(together, np.hstack(alone), rtol=0, atol=1e-12)


def test_no_points_give_no_points():
    assert tutorial_conversion().convert(np.empty((4, 0))).shape == (4, 0)


def test_points_are_left_as_they_are():
    points = np.array([[1.0], [2.0], [3.0], [1.0]])
    tutorial_conversion().convert(points)
    assert points.ravel().tolist() == [1.0, 2.0, 3.0, 1.0]


def test_surface_points_are_points_with_z_zero():
    base_points = tutorial_conversion().convert_surface_points([[0.0, 0.0], [19.5, 13.75]])
    np.testing.assert_allclose(
        base_points, [[-17.8, 24.4, 0.0], [1.7, 10.65, 0.0]], rtol=0, atol=1e-9)


def test_no_surface_points_give_no_base_points():
    assert tutorial_conversion().convert_surface_points(np.empty((0, 2))).shape == (0, 3)


def test_parent_class_converts_nothing():
    with pytest.raises(NotImplementedError):
        CoordinateConversion().convert(np.ones((4, 1)))


def test_conversion_is_a_coordinate_conversion():
    assert isinstance(tutorial_conversion(), CoordinateConversion)


@pytest.mark.parametrize('rotation_deg, point, turned', [
    ((90, 0, 0), Y, Z),
    ((90, 0, 0), Z, -Y),
    ((0, 90, 0), Z, X),
    ((0, 90, 0), X, -Z),
    ((0, 0, 90), X, Y),
    ((0, 0, 90), Y, -X),
    ((180, 0, 0), Y, -Y),
])
def test_positive_angles_turn_by_the_right_hand_rule(rotation_deg, point, turned):
    np.testing.assert_allclose(rotation_matrix(*rotation_deg) @ point, turned, atol=1e-12)


@pytest.mark.parametrize('rotation_deg', [
    (10, 20, 30), (-75, 40, 160), (180, -30, 45), (90, 90, 90), (0, 0, 0), (720, -360, 1)])
def test_roll_pitch_and_yaw_turn_one_after_another_about_fixed_axes(rotation_deg):
    roll, pitch, yaw = rotation_deg
    np.testing.assert_allclose(
        rotation_matrix(roll, pitch, yaw), turn(Z, yaw) @ turn(Y, pitch) @ turn(X, roll),
        atol=1e-12)


def test_optical_frame_of_rep_103_looks_forward():
    body_from_optical = rotation_matrix(-90, 0, -90)
    right, down, forward = body_from_optical.T
    np.testing.assert_allclose([right, down, forward], [-Y, -Z, X], atol=1e-12)


def test_north_east_down_of_rep_103_becomes_east_north_up():
    east_north_up_from_north_east_down = rotation_matrix(180, 0, 90)
    north, east, down = east_north_up_from_north_east_down.T
    np.testing.assert_allclose([north, east, down], [Y, X, -Z], atol=1e-12)


def test_homogeneous_matrix_rotates_first_and_displaces_then():
    matrix = homogeneous_matrix((0, 0, 90), (10, 20, 30))
    np.testing.assert_allclose(matrix @ [1, 0, 0, 1], [10, 21, 30, 1], atol=1e-12)


def test_tutorials_constructor_is_a_roll():
    general = CameraToRobotBaseConversion.from_roll_pitch_yaw((35, 0, 0), (1, 2, 3))
    np.testing.assert_array_equal(
        CameraToRobotBaseConversion(35, 1, 2, 3).base_from_camera, general.base_from_camera)


def test_general_conversion_applies_its_matrix():
    conversion = CameraToRobotBaseConversion.from_roll_pitch_yaw((10, 20, 30), (1, 2, 3))
    rotation = turn(Z, 30) @ turn(Y, 20) @ turn(X, 10)
    np.testing.assert_allclose(
        conversion.convert_surface_points([[4.0, 5.0]])[0],
        rotation @ [4.0, 5.0, 0.0] + [1, 2, 3], atol=1e-12)


def test_matrix_cannot_be_changed():
    conversion = tutorial_conversion()
    with pytest.raises(ValueError):
        conversion.base_from_camera[0, 3] = 0.0
    with pytest.raises(AttributeError):
        conversion.base_from_camera = np.eye(4)


def test_values_changed_after_construction_do_not_reach_the_matrix():
    rotation_deg, displacement_cm = np.array([180.0, 0, 0]), np.array([-17.8, 24.4, 0])
    conversion = CameraToRobotBaseConversion.from_roll_pitch_yaw(rotation_deg, displacement_cm)
    rotation_deg[:], displacement_cm[:] = 7.0, 7.0
    np.testing.assert_array_equal(
        conversion.base_from_camera, tutorial_conversion().base_from_camera)


@pytest.mark.parametrize('value', [float('nan'), float('inf'), None])
@pytest.mark.parametrize('place', range(4))
def test_value_that_is_no_finite_number_is_refused(place, value):
    values = [180.0, -17.8, 24.4, 0.0]
    values[place] = value
    with pytest.raises(InvalidValueError, match='must be finite numbers'):
        CameraToRobotBaseConversion(*values)


@pytest.mark.parametrize('rotation_deg, displacement_cm, name', [
    ((180, 0), (0, 0, 0), 'rotation_deg'),
    ((180, 0, 0, 0), (0, 0, 0), 'rotation_deg'),
    ((180, 0, 0), (), 'displacement_cm'),
    ((180, 0, 0), 5.0, 'displacement_cm'),
    ((180, 0, 0), ((0, 0, 0),), 'displacement_cm'),
])
def test_error_names_what_is_not_three_numbers(rotation_deg, displacement_cm, name):
    with pytest.raises(InvalidValueError, match=name):
        CameraToRobotBaseConversion.from_roll_pitch_yaw(rotation_deg, displacement_cm)


@pytest.mark.parametrize('shape', [(), (4,), (3, 1), (1, 4), (5, 2), (4, 1, 1)])
def test_points_of_another_shape_are_refused(shape):
    with pytest.raises(InvalidValueError, match=re.escape(f'got shape {shape}')):
        tutorial_conversion().convert(np.ones(shape))


@pytest.mark.parametrize('shape', [(), (2,), (1, 3), (2, 1), (1, 2, 1)])
def test_surface_points_of_another_shape_are_refused(shape):
    with pytest.raises(InvalidValueError, match=re.escape(f'got shape {shape}')):
        tutorial_conversion().convert_surface_points(np.ones(shape))


@pytest.mark.parametrize('value', [float('nan'), float('inf'), -float('inf')])
def test_points_that_are_not_finite_are_refused(value):
    with pytest.raises(InvalidValueError, match='finite'):
        tutorial_conversion().convert([[1.0], [value], [0.0], [1.0]])
    with pytest.raises(InvalidValueError, match='finite'):
        tutorial_conversion().convert_surface_points([[0.0, 0.0], [value, 1.0]])


def test_module_prints_three_seconds_of_the_tutorials_positions():
    seconds, x, y = printed_positions().T
    np.testing.assert_allclose(seconds, np.arange(1, 31) / 10)
    u, v = (x + 17.8) / 0.05625, (24.4 - y) / 0.05625
    for pixels in (u, v):
        np.testing.assert_allclose(pixels, np.rint(pixels), rtol=0, atol=1e-6)
        assert 250 <= np.rint(pixels).min() < np.rint(pixels).max() <= 450


def test_one_point_comes_out_as_among_many():
    conversion = CameraToRobotBaseConversion.from_roll_pitch_yaw((10, 20, 30), (1, 2, 3))
    points = np.random.default_rng(0).uniform(-50, 50, (20, 2))
    together = conversion.convert_surface_points(points)
    alone = [conversion.convert_point(x, y) for x, y in points]
    np.testing.assert_allclose(alone, together, rtol=0, atol=1e-12)


@pytest.mark.parametrize('x, y', [(np.nan, 0), (0, np.inf), (1e308, -1e308)])
def test_one_point_that_is_not_finite_is_refused(x, y):
    conversion = CameraToRobotBaseConversion.from_roll_pitch_yaw((0, 0, 45), (0, 0, 0))
    with pytest.raises(InvalidValueError):
        conversion.convert_point(x * 10, y * 10)


@pytest.mark.parametrize('rotation_deg, yaw_deg, expected_deg', [
    ((180, 0, 0), 30, -30), ((0, 0, 90), 30, -60), ((0, 0, 45), 30, 75), ((180, 0, 90), 0, 90),
    ((0, 0, 0), 90, 90), ((180, 0, 0), 90, 90), ((0, 0, 180), -20, -20)])
def test_direction_of_a_long_axis_is_turned_with_the_frame(rotation_deg, yaw_deg, expected_deg):
    conversion = CameraToRobotBaseConversion.from_roll_pitch_yaw(rotation_deg, (0, 0, 0))
    yaw = conversion.convert_yaw(math.radians(yaw_deg))
    assert math.degrees(yaw) == pytest.approx(expected_deg)


def test_direction_of_a_long_axis_is_that_of_its_converted_ends():
    conversion = CameraToRobotBaseConversion.from_roll_pitch_yaw((180, 0, 25), (1, 2, 3))
    for yaw in np.linspace(-1.5, 1.5, 13):
        (x0, y0, _), (x1, y1, _) = conversion.convert_surface_points(
            [[4, 5], [4 + math.cos(yaw), 5 + math.sin(yaw)]])
        assert math.tan(conversion.convert_yaw(yaw)) == pytest.approx((y1 - y0) / (x1 - x0))


def test_point_above_the_surface_is_converted_with_its_height():
    assert tutorial_conversion().convert_point(1.0, 2.0, 3.0) == pytest.approx((-16.8, 22.4, -3.0))
