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

"""Ellipses that contain 95 % of the errors of positions, as markers for RViz."""

from typing import Iterable, List

from camera_to_base.coordinate_transform import axis_angle, Pose
from camera_to_base.errors import InvalidValueError
from camera_to_base.ros.messages import MOST_POSES, pose_from_one, pose_to_one
from camera_to_base.ros.pose_messages import UncertainPose
from camera_to_base.uncertainty import Ellipse, ellipse_covariance, error_ellipse
from geometry_msgs.msg import Vector3
import numpy as np
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

SHARE = 0.95
_NAMESPACE = 'ellipses_95'
_COLOUR = ColorRGBA(r=1.0, g=0.55, b=0.0, a=0.6)
# RViz refuses a marker without an extent.
_THICKNESS_M, _LEAST_M = 0.001, 1e-5
_CM_PER_M = 100.0


def ellipse_markers(header: Header, poses: Iterable[UncertainPose]) -> MarkerArray:
    """Make flat discs, one for each pose; the first marker deletes those of earlier messages."""
    markers = [Marker(header=header, ns=_NAMESPACE, action=Marker.DELETEALL)]
    for number, (pose, covariance) in enumerate(poses, start=1):
        ellipse = error_ellipse(covariance, SHARE)
        markers.append(Marker(
            header=header, ns=_NAMESPACE, id=number, type=Marker.CYLINDER, action=Marker.ADD,
            pose=pose_to_one(pose._replace(yaw=ellipse.angle)), color=_COLOUR,
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
    half_axes = np.array([marker.scale.x, marker.scale.y]) * _CM_PER_M / 2
    if not np.isfinite(half_axes).all():
        raise InvalidValueError(f'expected finite scales of a marker, got {half_axes.tolist()}')
    covariance = np.zeros((6, 6))
    covariance[:2, :2] = ellipse_covariance(
        Ellipse(*half_axes.tolist(), axis_angle(np.cos(pose.yaw), np.sin(pose.yaw))), SHARE)
    return UncertainPose(Pose(*pose[:3], 0.0), covariance)


def _diameter(half_axis_cm: float) -> float:
    return max(2 * half_axis_cm / _CM_PER_M, _LEAST_M)
