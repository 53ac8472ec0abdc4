# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Listens to the positions of a cell, and puts the messages of one frame together."""

from collections import deque, OrderedDict
from dataclasses import dataclass, field
import time
from typing import Any, Callable, Deque, Dict, List, Optional, Tuple

from camera_to_base.coordinate_transform import Pose
from camera_to_base.dashboard.live.cells import full_name
from camera_to_base.errors import CameraToBaseError
from camera_to_base.ros import (
    boxes_of_markers, poses_from_message, poses_of_markers, silhouettes_of_markers, SolidBox,
    SurfaceSilhouette, UncertainPose)
from geometry_msgs.msg import PoseArray
from rclpy.node import Node
from rclpy.subscription import Subscription
from visualization_msgs.msg import Marker, MarkerArray

# As many frames are kept while their messages arrive one after the other.
_MOST_FRAMES = 30
# If no base positions came for so many frames, or so long, the camera positions are shown alone.
_LONGEST_WAIT_FRAMES, _LONGEST_WAIT_S = 10, 1.0

Stamp = Tuple[int, int]

# The rate is counted over this time.
_RATE_S = 3.0
_CM_PER_M = 100.0
# What is listened to for some cells alone.
_SILHOUETTES, _FUSED = 'silhouettes', 'fused'


@dataclass
class LeftOutPlace:
    """Something that was left out: where, in cm in the camera frame, and why."""

    kind: str
    sentence: str
    x: float
    y: float


@dataclass
class SeenFrame:
    """
    What came about one frame; None for what has not come.

    :param camera: The objects in the camera frame; those of a fused cell, in the base frame.
    :param is_fused: Whether it is of a fused cell, all of which is in the base frame.
    :param stamp_s: When it was taken.
    :param latency_s: The time from then until its objects came.
    """

    camera: Optional[List[Pose]] = None
    base: Optional[List[Pose]] = None
    camera_ellipses: List[UncertainPose] = field(default_factory=list)
    base_ellipses: List[UncertainPose] = field(default_factory=list)
    left_out: List[LeftOutPlace] = field(default_factory=list)
    boxes: Optional[List[SolidBox]] = None
    silhouettes: List[SurfaceSilhouette] = field(default_factory=list)
    is_fused: bool = False
    stamp_s: float = 0.0
    latency_s: float = 0.0


class SeenFrames:
    """Keeps the newest frames by their stamps."""

    def __init__(self) -> None:
        self._frames: 'OrderedDict[Stamp, SeenFrame]' = OrderedDict()

    def at(self, stamp: Any) -> SeenFrame:
        """Return the frame with a stamp; a new one if none has it."""
        key = stamp.sec, stamp.nanosec
        if key not in self._frames:
            self._frames[key] = SeenFrame(stamp_s=stamp.sec + stamp.nanosec / 1e9)
            while len(self._frames) > _MOST_FRAMES:
                self._frames.popitem(last=False)
        return self._frames[key]

    def known(self, stamp: Stamp) -> Optional[SeenFrame]:
        """Return the frame with a stamp if its objects have come in the camera frame."""
        frame = self._frames.get(stamp)
        return frame if frame and frame.camera is not None else None

    @property
    def newest(self) -> Optional[SeenFrame]:
        """
        The newest frame with base positions; the newest one at all if these do not come.

        Base positions come some milliseconds after the camera positions.
        """
        seen = [frame for frame in reversed(self._frames.values()) if frame.camera is not None]
        whole = (frame for frame in seen[:_LONGEST_WAIT_FRAMES] if frame.base is not None
                 and seen[0].stamp_s - frame.stamp_s < _LONGEST_WAIT_S)
        return next(whole, seen[0] if seen else None)

    @property
    def newest_with_boxes(self) -> Optional[SeenFrame]:
        """The newest frame whose boxes have come; None where none have."""
        return next((frame for frame in reversed(self._frames.values())
                     if frame.boxes is not None), None)


class CellPositions:
    """
    Listens to the objects in both frames, their shapes and ellipses, and what was left out.

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
        self._owed_since: Optional[float] = None

        def subscribe(kind: type, topic: str, callback: Callable[[Any], None]) -> Any:
            return node.create_subscription(kind, full_name(namespace, topic), callback, 5)

        def keep(frame_id: str, topic: str, name: str, convert: Callable[[Any], list]) -> Any:
            return subscribe(
                MarkerArray, f'objects_in_{frame_id}/{topic}', self._keeps(name, convert))

        self._subscriptions = [
            subscribe(PoseArray, 'objects_in_cam_frame', self._on_camera),
            subscribe(PoseArray, 'objects_in_robot_base_frame', self._on_base),
            keep('cam_frame', 'ellipses', 'camera_ellipses', poses_of_markers),
            keep('robot_base_frame', 'ellipses', 'base_ellipses', poses_of_markers),
            keep('cam_frame', 'left_out', 'left_out', _left_out_places),
            keep('cam_frame', 'boxes', 'boxes', boxes_of_markers)]
        self._subscribe_more = {
            _SILHOUETTES: lambda: [
                keep('cam_frame', 'silhouettes', 'silhouettes', silhouettes_of_markers)],
            _FUSED: lambda: [
                keep('robot_base_frame', 'left_out', 'left_out', _left_out_places),
                keep('robot_base_frame', 'boxes', 'boxes', boxes_of_markers)]}
        self._more: Dict[str, List[Subscription]] = {}

    def want_silhouettes(self, are_wanted: bool) -> None:
        """Listen to silhouettes, or not: without a camera's place the node has none."""
        self._want(_SILHOUETTES, are_wanted)

    def want_fused(self, is_fused: bool) -> None:
        """Listen to a fused cell, or not: all of it comes in the base frame."""
        self._want(_FUSED, is_fused)

    def _want(self, name: str, is_wanted: bool) -> None:
        if is_wanted and name not in self._more:
            self._more[name] = self._subscribe_more[name]()
        elif not is_wanted:
            for subscription in self._more.pop(name, []):
                self._node.destroy_subscription(subscription)

    @property
    def newest(self) -> Optional[SeenFrame]:
        """The frame to show; None before the first one."""
        return self._frames.newest

    @property
    def newest_with_boxes(self) -> Optional[SeenFrame]:
        """The newest frame whose boxes have come; None where none have."""
        return self._frames.newest_with_boxes

    def at(self, stamp: Stamp) -> Optional[SeenFrame]:
        """Return the frame with a stamp if its objects have come in the camera frame."""
        return self._frames.known(stamp)

    @property
    def silent_s(self) -> float:
        """Time since the last message with objects, or since listening began."""
        return time.monotonic() - (self._came_at[-1] if self._came_at else self._started_at)

    @property
    def owed_s(self) -> float:
        """Time since objects came that have not come in the base frame; 0 if they have."""
        return 0.0 if self._owed_since is None else time.monotonic() - self._owed_since

    @property
    def rate_hz(self) -> float:
        """Messages with objects in a second."""
        now = time.monotonic()
        span = min(_RATE_S, max(now - self._started_at, 0.5))
        return sum(now - came_at < span for came_at in self._came_at) / span

    def close(self) -> None:
        """Stop listening."""
        self.want_silhouettes(False)
        self.want_fused(False)
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)

    def _on_camera(self, message: PoseArray) -> None:
        was_silent = self.silent_s > _LONGEST_WAIT_S
        self._came_at.append(time.monotonic())
        if was_silent or self._owed_since is None:
            self._owed_since = self._came_at[-1]
        frame = self._frames.at(message.header.stamp)
        frame.latency_s = self._node.get_clock().now().nanoseconds / 1e9 - frame.stamp_s
        frame.camera = _read(poses_from_message, message)
        self._on_objects(frame.camera)

    def _on_base(self, message: PoseArray) -> None:
        if _FUSED in self._more:
            self._on_camera(message)
            self._frames.at(message.header.stamp).is_fused = True
        self._owed_since = None
        self._frames.at(message.header.stamp).base = _read(poses_from_message, message)

    def _keeps(
        self, name: str, convert: Callable[[MarkerArray], list]
    ) -> Callable[[MarkerArray], None]:
        """Return what keeps a message with markers in its frame, by the name of the field."""
        def keep(message: MarkerArray) -> None:
            if message.markers:
                frame = self._frames.at(message.markers[0].header.stamp)
                setattr(frame, name, _read(convert, message))
        return keep


def _read(convert: Callable[[Any], list], message: Any) -> list:
    try:
        return convert(message)
    except CameraToBaseError:
        return []  # not of this package's nodes


def _left_out_places(message: MarkerArray) -> List[LeftOutPlace]:
    return [_left_out(marker) for marker in message.markers if marker.action == Marker.ADD]


def _left_out(marker: Marker) -> LeftOutPlace:
    place = marker.pose.position
    return LeftOutPlace(marker.ns, ' '.join(marker.text.split()),
                        place.x * _CM_PER_M, place.y * _CM_PER_M)
