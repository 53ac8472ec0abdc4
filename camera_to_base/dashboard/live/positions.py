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

"""Listens to the positions of a cell."""

from collections import deque
import time
from typing import Any, Callable, Deque, List, Optional

from camera_to_base.coordinate_transform import Pose
from camera_to_base.dashboard.live.cells import full_name
from camera_to_base.dashboard.live.frames import LeftOutPlace, SeenFrame, SeenFrames
from camera_to_base.errors import CameraToBaseError
from camera_to_base.ros import poses_from_message, poses_of_markers
from geometry_msgs.msg import PoseArray
from rclpy.node import Node
from visualization_msgs.msg import Marker, MarkerArray

# The rate is counted over this time.
_RATE_S = 3.0
_CM_PER_M = 100.0


class CellPositions:
    """
    Listens to the objects in both frames, their ellipses, and what was left out.

    :param node: The node that listens.
    :param namespace: The cell's.
    :param on_objects: Called with the objects of each frame, in the camera frame.
    """

    def __init__(
        self, node: Node, namespace: str, on_objects: Callable[[List[Pose]], None]
    ) -> None:
        self._node, self._on_objects = node, on_objects
        self._frames = SeenFrames()
        self._came_at: Deque[float] = deque(maxlen=1000)
        self._started_at = time.monotonic()

        def subscribe(kind: type, topic: str, callback: Callable[[Any], None]) -> Any:
            return node.create_subscription(kind, full_name(namespace, topic), callback, 5)

        self._subscriptions = [
            subscribe(PoseArray, 'objects_in_cam_frame', self._on_camera),
            subscribe(PoseArray, 'objects_in_robot_base_frame', self._on_base),
            subscribe(MarkerArray, 'objects_in_cam_frame/ellipses', self._on_camera_ellipses),
            subscribe(MarkerArray, 'objects_in_robot_base_frame/ellipses',
                      self._on_base_ellipses),
            subscribe(MarkerArray, 'objects_in_cam_frame/left_out', self._on_left_out)]

    @property
    def newest(self) -> Optional[SeenFrame]:
        """The frame to show; None before the first one."""
        return self._frames.newest

    @property
    def silent_s(self) -> float:
        """Time since the last message with objects, or since listening began."""
        return time.monotonic() - (self._came_at[-1] if self._came_at else self._started_at)

    @property
    def rate_hz(self) -> float:
        """Messages with objects in a second."""
        now = time.monotonic()
        span = min(_RATE_S, max(now - self._started_at, 0.5))
        return sum(now - came_at < span for came_at in self._came_at) / span

    def close(self) -> None:
        """Stop listening."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)

    def _on_camera(self, message: PoseArray) -> None:
        self._came_at.append(time.monotonic())
        frame = self._frames.at(message.header.stamp)
        frame.latency_s = self._node.get_clock().now().nanoseconds / 1e9 - frame.stamp_s
        frame.camera = _read(poses_from_message, message)
        self._on_objects(frame.camera)

    def _on_base(self, message: PoseArray) -> None:
        self._frames.at(message.header.stamp).base = _read(poses_from_message, message)

    def _on_camera_ellipses(self, message: MarkerArray) -> None:
        if message.markers:
            frame = self._frames.at(message.markers[0].header.stamp)
            frame.camera_ellipses = _read(poses_of_markers, message)

    def _on_base_ellipses(self, message: MarkerArray) -> None:
        if message.markers:
            frame = self._frames.at(message.markers[0].header.stamp)
            frame.base_ellipses = _read(poses_of_markers, message)

    def _on_left_out(self, message: MarkerArray) -> None:
        if message.markers:
            frame = self._frames.at(message.markers[0].header.stamp)
            frame.left_out = [_left_out(marker) for marker in message.markers
                              if marker.action == Marker.ADD]


def _read(convert: Callable[[Any], list], message: Any) -> list:
    try:
        return convert(message)
    except CameraToBaseError:
        return []  # not of this package's nodes


def _left_out(marker: Marker) -> LeftOutPlace:
    place = marker.pose.position
    return LeftOutPlace(marker.ns, ' '.join(marker.text.split()),
                        place.x * _CM_PER_M, place.y * _CM_PER_M)
