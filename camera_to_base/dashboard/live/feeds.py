# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The pictures of a cell's camera node: for pages, for sessions, and one moment's as files."""

import time
from typing import Any, Callable, Dict, List, Optional, Tuple

from camera_to_base.coordinate_transform import Pose
from camera_to_base.dashboard.live.cells import full_name
from camera_to_base.dashboard.sessions.cell_sessions import CellSessions
from camera_to_base.errors import FrameSourceError
from camera_to_base.ros import DriverInfo, is_rectified
import cv2
from geometry_msgs.msg import PoseStamped
import numpy as np
from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node, NodeNameNonExistentError
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.subscription import Subscription
from rclpy.task import Future
from sensor_msgs.msg import CompressedImage

TOPICS = {'annotated': 'debug_image/compressed', 'frame': 'frame/compressed',
          'mask': 'mask/compressed', 'background': 'background/compressed'}
# The background is published once; it waits for those who come later.
_LATCHED = {'background', 'recorded'}
_IMAGES = {'sensor_msgs/msg/Image', 'sensor_msgs/msg/CompressedImage'}

OnPicture = Callable[[str, str, CompressedImage], None]
Stamp = Tuple[int, int]
PositionsAt = Callable[[Stamp], Optional[Dict[str, Any]]]

_CM_PER_M = 100.0
_SNAPSHOT_KINDS = ('frame', 'mask')
# A mask or positions that have not come by then do not come: nothing is published.
_LONGEST_SNAPSHOT_S = 4.0
_LONGEST_FOR_BASE_S = 1.0


def picture_qos(kind: str) -> QoSProfile:
    """Return the quality of service for a kind of picture: the newest one alone."""
    durability = (DurabilityPolicy.TRANSIENT_LOCAL if kind in _LATCHED
                  else DurabilityPolicy.VOLATILE)
    return QoSProfile(depth=1, durability=durability)


class PictureTopics:
    """
    Subscribes to pictures while somebody looks at them.

    :param node: The node that listens.
    :param on_picture: Called with the cell, the kind and the message.
    """

    def __init__(self, node: Node, on_picture: OnPicture) -> None:
        self._node, self._on_picture = node, on_picture
        self._subscriptions: Dict[Tuple[str, str], Subscription] = {}

    def look_at(self, namespace: str, kind: str) -> None:
        """Subscribe to a kind of picture of a cell; nothing if it is not published."""
        if (namespace, kind) in self._subscriptions or kind not in TOPICS:
            return
        self._subscriptions[namespace, kind] = self._node.create_subscription(
            CompressedImage, full_name(namespace, TOPICS[kind]),
            lambda message: self._on_picture(namespace, kind, message),
            picture_qos(kind))

    def look_away(self, namespace: str, kind: str) -> None:
        """End a subscription."""
        subscription = self._subscriptions.pop((namespace, kind), None)
        if subscription is not None:
            self._node.destroy_subscription(subscription)


class SessionFeed:
    """
    Subscribes while a session wants it.

    :param node: The node that listens.
    :param namespace: The cell's.
    :param sessions: The cell's sessions.
    """

    def __init__(self, node: Node, namespace: str, sessions: CellSessions) -> None:
        self._node, self._namespace, self._sessions = node, namespace, sessions
        topics = {**TOPICS, 'recorded': TOPICS['background']}
        self._names = {kind: full_name(namespace, topic) for kind, topic in topics.items()}
        self._subscriptions: Dict[str, Subscription] = {}
        self._tool: Optional[str] = None
        self._driver: Optional[DriverInfo] = None

    def look_at_driver(self, camera: Optional[str]) -> None:
        """
        Listen to the camera_info beside the pictures of a camera node, if a session wants it.

        :param camera: Full name of the node; None if it does not run.
        """
        topic = self._image_topic(camera) if camera and self._sessions.wants_frames else None
        if topic == (self._driver and self._driver.image_topic):
            return
        if self._driver is not None:
            self._driver.close()
            self._driver = None
            self._sessions.see_camera_info(None)
        if topic is not None:
            self._driver = DriverInfo(
                self._node, topic,
                lambda info: self._sessions.see_camera_info(info, is_rectified(topic)))

    def check(self) -> None:
        """Begin and end what the sessions want."""
        self._keep('frame', self._sessions.wants_frames or self._sessions.wants_recording,
                   self._on_frame)
        self._keep('background', self._sessions.wants_objects, self._on_background)
        # It is sent to each new subscriber.
        self._keep('recorded', self._sessions.wants_recording, lambda message: (
            self._sessions.see_background_png(bytes(message.data))))
        if self._sessions.tool_topic != self._tool:
            self._listen_to_tool(self._sessions.tool_topic)

    def on_objects(self, poses: List[Pose]) -> None:
        """Take the objects of a frame."""
        if self._sessions.wants_objects:
            self._sessions.see_objects([(pose.x, pose.y) for pose in poses])

    def close(self) -> None:
        """End all."""
        self.look_at_driver(None)
        for name in list(self._subscriptions):
            self._end(name)

    def _image_topic(self, camera: str) -> Optional[str]:
        namespace, _, name = camera.rpartition('/')
        try:
            topics = self._node.get_subscriber_names_and_types_by_node(name, namespace or '/')
        except NodeNameNonExistentError:
            return None
        return next((topic for topic, kinds in topics if set(kinds) & _IMAGES), None)

    def _keep(self, kind: str, is_wanted: bool, callback: Callable[[Any], None]) -> None:
        if is_wanted and kind not in self._subscriptions:
            self._subscriptions[kind] = self._node.create_subscription(
                CompressedImage, self._names[kind], callback, picture_qos(kind))
        elif not is_wanted:
            self._end(kind)

    def _listen_to_tool(self, topic: str) -> None:
        self._end('tool')
        self._tool = topic
        if topic:
            try:
                self._subscriptions['tool'] = self._node.create_subscription(
                    PoseStamped, full_name(self._namespace, topic), self._on_tool, 10)
            except InvalidTopicNameException:
                pass  # the session tells that no poses come

    def _end(self, name: str) -> None:
        subscription = self._subscriptions.pop(name, None)
        if subscription is not None:
            self._node.destroy_subscription(subscription)

    def _on_frame(self, message: CompressedImage) -> None:
        if self._sessions.wants_recording:
            self._sessions.see_jpeg(bytes(message.data))
        if not self._sessions.wants_frames:
            return
        frame = cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR)
        if frame is not None:
            self._sessions.see_frame(frame)

    def _on_background(self, message: CompressedImage) -> None:
        self._sessions.see_background((message.header.stamp.sec, message.header.stamp.nanosec))

    def _on_tool(self, message: PoseStamped) -> None:
        place, stamp = message.pose.position, message.header.stamp
        self._sessions.see_tool(
            place.x * _CM_PER_M, place.y * _CM_PER_M, message.header.frame_id,
            stamp.sec + stamp.nanosec / 1e9)


class Snapshot:
    """
    Waits until the pictures and the positions of one frame have come.

    `answer` is the future of the pictures by file name and the positions as JSON.

    :param node: The node that listens.
    :param namespace: The cell's.
    :param positions_at: Returns the positions of the frame with a stamp; None while they are not
        there.
    """

    def __init__(self, node: Node, namespace: str, positions_at: PositionsAt) -> None:
        self._node, self._positions_at = node, positions_at
        self._began_at = time.monotonic()
        self._pictures: Dict[Stamp, Dict[str, CompressedImage]] = {}
        self.answer = Future()
        self._subscriptions = [
            node.create_subscription(
                CompressedImage, full_name(namespace, TOPICS[kind]),
                lambda message, kind=kind: self._see(kind, message), picture_qos(kind))
            for kind in _SNAPSHOT_KINDS]

    def check(self) -> bool:
        """Answer if everything is there, or nothing more is waited for; return whether it has."""
        waited = time.monotonic() - self._began_at
        for stamp, pictures in sorted(self._pictures.items()):
            is_whole = len(pictures) == len(_SNAPSHOT_KINDS)
            positions = self._positions_at(stamp) if is_whole else None
            # Base positions follow; of what is beyond the reach, none come.
            if positions and (waited > _LONGEST_FOR_BASE_S or all(
                    one['base'] for one in positions['objects'])):
                return self._end(stamp, positions)
        if waited < _LONGEST_SNAPSHOT_S:
            return False
        if not self._pictures:
            return self._fail()
        return self._end(max(self._pictures), {'objects': None})

    def close(self) -> None:
        """Stop listening."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        self._subscriptions: List[Any] = []

    def _see(self, kind: str, message: CompressedImage) -> None:
        stamp = message.header.stamp.sec, message.header.stamp.nanosec
        self._pictures.setdefault(stamp, {})[kind] = message
        for old in sorted(self._pictures)[:-20]:
            del self._pictures[old]

    def _end(self, stamp: Stamp, positions: Dict[str, Any]) -> bool:
        self.close()
        files = {f'{kind}.{"png" if "png" in one.format else "jpg"}': bytes(one.data)
                 for kind, one in self._pictures[stamp].items()}
        self.answer.set_result((files, {'stamp_s': stamp[0] + stamp[1] / 1e9, **positions}))
        return True

    def _fail(self) -> bool:
        self.close()
        self.answer.set_exception(FrameSourceError(
            'no pictures come from the camera node: is it running, and the camera plugged in?'))
        return True
