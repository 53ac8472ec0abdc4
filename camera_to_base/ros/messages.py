# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""
Conversion between ROS messages and numbers, in this module alone.

Pictures are in `nodes.image_messages`: a process without pictures does not load OpenCV.
"""

import math
from typing import Iterable, List, Sequence, Tuple

from camera_to_base.coordinate_transform import axis_angle, Pose
from camera_to_base.errors import InvalidValueError
from geometry_msgs.msg import (
    Point, PointStamped, Pose as PoseMessage, PoseArray, PoseStamped, Quaternion)
from std_msgs.msg import Float64MultiArray, Header

# A position has two numbers, or a few more; a message with thousands belongs to another topic.
MOST_NUMBERS = 16
MOST_POSES = 1000
_CM_PER_M = 100.0
# A quaternion that differs by more than this from a rotation about z, or from length 1, is
# refused.
_QUATERNION_TOLERANCE = 1e-3


def position_message(x: float, y: float) -> Float64MultiArray:
    """
    Make the message of both tutorial topics.

    :param x: In cm.
    :param y: In cm.
    """
    return Float64MultiArray(data=[x, y])


def position_from_message(message: Float64MultiArray) -> Tuple[float, float]:
    """
    Read a message of either tutorial topic.

    Numbers after the first two are ignored, as in the tutorial.

    :returns: x and y, in cm.
    :raises InvalidValueError: If it does not start with two finite numbers, or has far too many.
    """
    if len(message.data) > MOST_NUMBERS:
        raise InvalidValueError(f'expected [x, y] in cm, got {len(message.data)} numbers')
    position = tuple(message.data[:2])
    if len(position) < 2:
        raise InvalidValueError(f'expected [x, y] in cm, got {len(position)} number(s)')
    if not all(math.isfinite(value) for value in position):
        raise InvalidValueError(f'expected two finite numbers in cm, got {list(position)}')
    return position


def point_message(header: Header, x: float, y: float, z: float = 0.0) -> PointStamped:
    """
    Make a stamped point, in m.

    :param x: In cm; y and z, too.
    """
    return PointStamped(header=header, point=_point(x, y, z))


def point_from_message(message: PointStamped) -> Tuple[float, float, float]:
    """
    Read a stamped point.

    :returns: x, y and z, in cm.
    :raises InvalidValueError: If they are not finite.
    """
    return _cm(message.point)


def tool_message(header: Header, x: float, y: float) -> PoseStamped:
    """
    Make the pose of a robot's tool on the work surface, in m.

    :param x: In cm; y, too.
    """
    return PoseStamped(header=header, pose=pose_to_one(Pose(x, y, 0.0, 0.0)))


def poses_message(header: Header, poses: Iterable[Pose]) -> PoseArray:
    """Make a stamped array of poses, in m, with a yaw about the frame's z."""
    return PoseArray(header=header, poses=list(map(pose_to_one, poses)))


def poses_from_message(message: PoseArray) -> List[Pose]:
    """
    Read a stamped array of poses.

    :returns: In its order.
    :raises InvalidValueError: If one is not finite or turned about another axis than z, or there
        are far too many.
    """
    if len(message.poses) > MOST_POSES:
        raise InvalidValueError(f'expected at most {MOST_POSES} poses, got {len(message.poses)}')
    return list(map(pose_from_one, message.poses))


def pose_to_one(pose: Pose) -> PoseMessage:
    """Make a pose, in m, with a yaw about the frame's z."""
    x, y, z, yaw = pose
    return PoseMessage(position=_point(x, y, z), orientation=Quaternion(
        x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2)))


def pose_from_one(pose: PoseMessage) -> Pose:
    """
    Read a pose.

    :raises InvalidValueError: If it is not finite, or turned about another axis than z.
    """
    return Pose(*_cm(pose.position), _yaw(pose.orientation))


def _point(x: float, y: float, z: float) -> Point:
    return Point(x=x / _CM_PER_M, y=y / _CM_PER_M, z=z / _CM_PER_M)


def _cm(point: Point) -> Tuple[float, float, float]:
    numbers: Sequence[float] = (point.x, point.y, point.z)
    if not all(map(math.isfinite, numbers)):
        raise InvalidValueError(f'expected three finite numbers in m, got {list(numbers)}')
    return tuple(_CM_PER_M * number for number in numbers)


def _yaw(q: Quaternion) -> float:
    about_z = abs(q.x) + abs(q.y) < _QUATERNION_TOLERANCE
    if not (about_z and abs(math.hypot(q.z, q.w) - 1) < _QUATERNION_TOLERANCE):
        raise InvalidValueError(
            f'expected a yaw about z, got the quaternion ({q.x:g}, {q.y:g}, {q.z:g}, {q.w:g})')
    # Half the angle, doubled.
    return axis_angle(q.w * q.w - q.z * q.z, 2 * q.z * q.w)
