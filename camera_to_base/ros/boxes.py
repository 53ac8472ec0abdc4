# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Boxes around objects, as markers for RViz and, where vision_msgs is installed, as detections."""

import math
from typing import Any, Iterable, List, NamedTuple, Optional

from camera_to_base.coordinate_transform import Pose
from camera_to_base.errors import InvalidValueError
from camera_to_base.ros.messages import MOST_POSES, pose_from_one, pose_to_one
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

try:
    import vision_msgs.msg as vision_msgs
except ImportError:  # It is no part of a ROS base installation.
    vision_msgs = None

_NAMESPACE = 'boxes'
_COLOUR = ColorRGBA(r=0.2, g=0.6, b=0.9, a=0.7)
_CM_PER_M = 100.0
# RViz refuses a marker without an extent.
_LEAST_M = 0.001


class SolidBox(NamedTuple):
    """
    The box around an object.

    :param pose: Its middle, at half its height, in cm, and the direction of its length, in rad.
    :param length: Along the direction, in cm.
    :param width: Across it, in cm.
    :param height: In cm; 0 for a flat object.
    """

    pose: Pose
    length: float
    width: float
    height: float


def box_markers(header: Header, boxes: Iterable[SolidBox]) -> MarkerArray:
    """
    Make a cube for each object; the first marker deletes those of earlier messages.

    A marker's id and text are the object's number, from 1, in the order of the PoseArray.
    """
    markers = [Marker(header=header, ns=_NAMESPACE, action=Marker.DELETEALL)]
    for number, box in enumerate(boxes, start=1):
        markers.append(Marker(
            header=header, ns=_NAMESPACE, id=number, type=Marker.CUBE, action=Marker.ADD,
            pose=pose_to_one(box.pose), scale=_size(box), color=_COLOUR, text=str(number)))
    return MarkerArray(markers=markers)


def boxes_of_markers(message: MarkerArray) -> List[SolidBox]:
    """
    Read boxes.

    :returns: In their order.
    :raises InvalidValueError: If a number is not finite, a box is turned about another axis than
        z, or there are far too many.
    """
    if len(message.markers) > MOST_POSES:
        raise InvalidValueError(
            f'expected at most {MOST_POSES} boxes, got {len(message.markers)}')
    return [_box(marker) for marker in message.markers if marker.action == Marker.ADD]


def _box(marker: Marker) -> SolidBox:
    size = [_CM_PER_M * side for side in (marker.scale.x, marker.scale.y, marker.scale.z)]
    if not all(math.isfinite(side) and side >= 0 for side in size):
        raise InvalidValueError(f'expected a box of finite sides, got {size} cm')
    return SolidBox(pose_from_one(marker.pose), *size)


def detection_type() -> Optional[type]:
    """Return vision_msgs/Detection3DArray; None where vision_msgs is not installed."""
    return None if vision_msgs is None else vision_msgs.Detection3DArray


def detections_message(header: Header, boxes: Iterable[SolidBox]) -> Any:
    """Make the same as vision_msgs/Detection3DArray, for where vision_msgs is installed."""
    return vision_msgs.Detection3DArray(header=header, detections=[
        vision_msgs.Detection3D(
            header=header, id=str(number),
            bbox=vision_msgs.BoundingBox3D(center=pose_to_one(box.pose), size=_size(box)))
        for number, box in enumerate(boxes, start=1)])


def _size(box: SolidBox) -> Vector3:
    return Vector3(x=max(box.length / _CM_PER_M, _LEAST_M), y=max(box.width / _CM_PER_M, _LEAST_M),
                   z=max(box.height / _CM_PER_M, _LEAST_M))
