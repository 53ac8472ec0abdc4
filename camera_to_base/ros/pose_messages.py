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

"""Conversion between poses with a covariance and their ROS messages."""

import math
from typing import NamedTuple

from camera_to_base.coordinate_transform import Pose
from camera_to_base.errors import InvalidValueError
from camera_to_base.ros.messages import pose_from_one, pose_to_one
from geometry_msgs.msg import PoseWithCovariance, PoseWithCovarianceStamped
import numpy as np
from std_msgs.msg import Header

# x, y and z in m, and the rotations about them in rad, for one cm and one rad.
_M_PER_CM = np.array([0.01] * 3 + [1.0] * 3)
_M2_PER_CM2 = np.outer(_M_PER_CM, _M_PER_CM)


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
