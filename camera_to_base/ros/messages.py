# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Conversion between ROS messages and numbers, poses and markers, in this module alone.

Pictures are elsewhere, as a process without pictures does not load OpenCV: `sources.decoding`
reads their messages, `nodes.outputs` makes them.
"""

import math
import textwrap
from typing import Iterable, List, NamedTuple, Tuple

from camera_to_base.coordinate_transform import axis_angle, Pose
from camera_to_base.errors import InvalidValueError, Reason
from camera_to_base.uncertainty import Ellipse, ellipse_covariance, error_ellipse
from geometry_msgs.msg import (
    Point, PointStamped, Pose as PoseMessage, PoseArray, PoseStamped, PoseWithCovariance,
    PoseWithCovarianceStamped, Quaternion, Vector3)
import numpy as np
from std_msgs.msg import ColorRGBA, Float64MultiArray, Header
from visualization_msgs.msg import Marker, MarkerArray

# A position has two numbers, or a few more; a message with thousands belongs to another topic.
MOST_NUMBERS = 16
MOST_POSES = 1000
_CM_PER_M = 100.0
# A quaternion that differs by more than this from a rotation about z, or from length 1, is
# refused.
_QUATERNION_TOLERANCE = 1e-3

# x, y and z in m, and the rotations about them in rad, for one cm and one rad.
_M_PER_CM = np.array([0.01] * 3 + [1.0] * 3)
_M2_PER_CM2 = np.outer(_M_PER_CM, _M_PER_CM)

SHARE = 0.95
_NAMESPACE = 'ellipses_95'
_ELLIPSE_COLOUR = ColorRGBA(r=1.0, g=0.55, b=0.0, a=0.6)
# RViz refuses a marker without an extent.
_THICKNESS_M, _LEAST_M = 0.001, 1e-5

_LEFT_OUT_COLOUR = ColorRGBA(r=0.7, g=0.7, b=0.7, a=1.0)
_LETTER_M = 0.008
_LETTERS_PER_LINE = 32


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
    x, y, z = point.x, point.y, point.z
    if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
        raise InvalidValueError(f'expected three finite numbers in m, got {[x, y, z]}')
    return _CM_PER_M * x, _CM_PER_M * y, _CM_PER_M * z


def _yaw(q: Quaternion) -> float:
    about_z = abs(q.x) + abs(q.y) < _QUATERNION_TOLERANCE
    if not (about_z and abs(math.hypot(q.z, q.w) - 1) < _QUATERNION_TOLERANCE):
        raise InvalidValueError(
            f'expected a yaw about z, got the quaternion ({q.x:g}, {q.y:g}, {q.z:g}, {q.w:g})')
    # Half the angle, doubled.
    return axis_angle(q.w * q.w - q.z * q.z, 2 * q.z * q.w)


class UncertainPose(NamedTuple):
    """
    A pose with its covariance.

    :param pose: In cm and rad.
    :param covariance: Shape (6, 6), of x, y, z in cm and the rotations about them in rad.
    """

    pose: Pose
    covariance: np.ndarray


def uncertain_pose_message(header: Header, uncertain: UncertainPose) -> PoseWithCovarianceStamped:
    """Make a stamped pose with its covariance, in m and rad."""
    return PoseWithCovarianceStamped(header=header, pose=PoseWithCovariance(
        pose=pose_to_one(uncertain.pose),
        covariance=(uncertain.covariance * _M2_PER_CM2).ravel()))


def uncertain_pose_from_message(message: PoseWithCovarianceStamped) -> UncertainPose:
    """
    Read a stamped pose with its covariance.

    :raises InvalidValueError: If a number is not finite, a variance is negative, or the pose is
        turned about another axis than z.
    """
    pose = pose_from_one(message.pose.pose)
    in_metres = np.reshape(message.pose.covariance, (6, 6))
    with np.errstate(over='ignore', invalid='ignore'):
        covariance = in_metres / _M2_PER_CM2
    if not math.isfinite(covariance.sum()) or covariance.diagonal().min() < 0:
        raise InvalidValueError('expected a covariance of finite numbers without a negative '
                                f'variance, got the diagonal {in_metres.diagonal().tolist()}')
    return UncertainPose(pose, covariance)


def ellipse_markers(header: Header, poses: Iterable[UncertainPose]) -> MarkerArray:
    """Make flat discs, one for each pose; the first marker deletes those of earlier messages."""
    markers = [Marker(header=header, ns=_NAMESPACE, action=Marker.DELETEALL)]
    for number, (pose, covariance) in enumerate(poses, start=1):
        ellipse = error_ellipse(covariance, SHARE)
        markers.append(Marker(
            header=header, ns=_NAMESPACE, id=number, type=Marker.CYLINDER, action=Marker.ADD,
            pose=pose_to_one(pose._replace(yaw=ellipse.angle)), color=_ELLIPSE_COLOUR,
            scale=Vector3(x=_diameter(ellipse.long), y=_diameter(ellipse.short),
                          z=_THICKNESS_M)))
    return MarkerArray(markers=markers)


def poses_of_markers(message: MarkerArray) -> List[UncertainPose]:
    """
    Read the poses that ellipses belong to.

    What an ellipse does not tell, z and the rotations, has no variance here.

    :raises InvalidValueError: If a number is not finite, or there are far too many.
    """
    if len(message.markers) > MOST_POSES:
        raise InvalidValueError(f'expected at most {MOST_POSES} markers, '
                                f'got {len(message.markers)}')
    return [_uncertain(marker) for marker in message.markers if marker.action == Marker.ADD]


def _uncertain(marker: Marker) -> UncertainPose:
    pose = pose_from_one(marker.pose)
    long, short = _CM_PER_M * marker.scale.x / 2, _CM_PER_M * marker.scale.y / 2
    if not math.isfinite(long + short):
        raise InvalidValueError(f'expected finite scales of a marker, got {[long, short]}')
    covariance = np.zeros((6, 6))
    covariance[:2, :2] = ellipse_covariance(Ellipse(long, short, pose.yaw), SHARE)
    return UncertainPose(Pose(pose.x, pose.y, pose.z, 0.0), covariance)


def _diameter(half_axis_cm: float) -> float:
    return max(2 * half_axis_cm / _CM_PER_M, _LEAST_M)


def left_out_markers(
    header: Header, left_out: Iterable[Tuple[Tuple[float, float], Reason]]
) -> MarkerArray:
    """
    Make a text for each object that was left out: its reason's sentence, at its place.

    A marker's namespace is the reason's kind, so that RViz can hide each kind. The first marker
    deletes those of earlier messages.

    :param left_out: Of each, x and y in cm in the camera frame, and the reason.
    """
    markers = [Marker(header=header, action=Marker.DELETEALL)]
    for number, ((x, y), reason) in enumerate(left_out, start=1):
        markers.append(Marker(
            header=header, ns=reason.kind, id=number, type=Marker.TEXT_VIEW_FACING,
            action=Marker.ADD, pose=pose_to_one(Pose(x, y, 0.0, 0.0)), color=_LEFT_OUT_COLOUR,
            scale=Vector3(z=_LETTER_M),
            text='\n'.join(textwrap.wrap(reason.sentence, _LETTERS_PER_LINE))))
    return MarkerArray(markers=markers)
