# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math

from builtin_interfaces.msg import Time
from camera_to_base.coordinate_transform import Pose
from camera_to_base.errors import InvalidValueError
from camera_to_base.ros.messages import (
    point_from_message, point_message, poses_from_message, poses_message, position_from_message,
    position_message)
import pytest
from std_msgs.msg import Float64MultiArray, Header


def test_position_comes_back_as_it_went_in():
    assert position_from_message(position_message(1.25, -7.5)) == (1.25, -7.5)


def test_message_holds_x_and_y_and_no_layout():
    message = position_message(1.25, -7.5)
    assert list(message.data) == [1.25, -7.5]
    assert message.layout == Float64MultiArray().layout


def test_further_numbers_are_left_alone():
    assert position_from_message(Float64MultiArray(data=[1.0, 2.0, 3.0])) == (1.0, 2.0)


@pytest.mark.parametrize('data', [
    [], [1.0], [math.nan, 1.0], [1.0, math.nan], [math.inf, 1.0], [1.0, -math.inf]])
def test_what_is_no_position_is_refused(data):
    with pytest.raises(InvalidValueError):
        position_from_message(Float64MultiArray(data=data))


def test_message_of_far_too_many_numbers_is_refused():
    assert position_from_message(Float64MultiArray(data=[1.0] * 16)) == (1.0, 1.0)
    with pytest.raises(InvalidValueError, match='1000000 numbers'):
        position_from_message(Float64MultiArray(data=[1.0] * 10**6))


HEADER = Header(stamp=Time(sec=12, nanosec=34), frame_id='camera_surface')


def test_stamped_point_is_in_metres_and_comes_back_in_cm():
    message = point_message(HEADER, 125.0, -75.0, 10.0)
    assert (message.point.x, message.point.y, message.point.z) == (1.25, -0.75, 0.1)
    assert message.header == HEADER
    assert point_from_message(message) == pytest.approx((125.0, -75.0, 10.0))


def test_poses_come_back_as_they_went_in():
    poses = [Pose(1.0, 2.0, 0.0, yaw) for yaw in (0.0, 0.3, -1.5, math.pi / 2)]
    message = poses_message(HEADER, poses)
    assert message.header == HEADER
    assert poses_from_message(message) == [pytest.approx(pose) for pose in poses]


def test_pose_of_a_round_object_is_not_turned():
    orientation = poses_message(HEADER, [Pose(1.0, 2.0, 0.0, 0.0)]).poses[0].orientation
    assert (orientation.x, orientation.y, orientation.z, orientation.w) == (0.0, 0.0, 0.0, 1.0)


def test_no_object_is_an_empty_array():
    message = poses_message(HEADER, [])
    assert message.poses == [] and message.header == HEADER
    assert poses_from_message(message) == []


@pytest.mark.parametrize('place', ['x', 'y', 'z'])
@pytest.mark.parametrize('value', [math.nan, math.inf, -math.inf])
def test_point_that_is_not_finite_is_refused(place, value):
    message = point_message(HEADER, 1.0, 2.0)
    setattr(message.point, place, value)
    with pytest.raises(InvalidValueError, match='finite'):
        point_from_message(message)


@pytest.mark.parametrize('turned', [
    {'x': 0.7071, 'w': 0.7071}, {'w': 0.0}, {'w': 2.0}, {'z': math.nan}, {'w': math.inf}])
def test_pose_that_is_turned_about_another_axis_is_refused(turned):
    message = poses_message(HEADER, [Pose(1.0, 2.0, 0.0, 0.0)])
    for name, value in turned.items():
        setattr(message.poses[0].orientation, name, value)
    with pytest.raises(InvalidValueError, match='yaw about z'):
        poses_from_message(message)


def test_array_of_far_too_many_poses_is_refused():
    with pytest.raises(InvalidValueError, match='1001'):
        poses_from_message(poses_message(HEADER, [Pose(1.0, 2.0, 0.0, 0.0)] * 1001))
