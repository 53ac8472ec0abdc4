# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A camera driver's topics: its pictures, and the camera_info beside them."""

import time
from typing import Any, Callable, List, Optional

from camera_to_base.errors import FrameSourceError, InvalidValueError
from camera_to_base.ros.listeners import Listener
from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

_TRANSPORTS = 'compressed', 'theora', 'ffmpeg', 'zstd', 'raw'
_RECTIFIED = 'image_rect'
_COMPRESSED = '/compressed'
# Discovery of a driver takes up to a few seconds; then pictures and camera_info come together.
_LONGEST_WAIT_S, _LONGEST_INFO_S = 10.0, 2.0


def camera_info_topic(image_topic: str) -> str:
    """
    Return the topic of a picture's camera_info: in its namespace, as image_transport has it.

    :param image_topic: Full name, with or without a transport such as `/compressed`.
    """
    return _base_topic(image_topic).rpartition('/')[0] + '/camera_info'


def is_rectified(image_topic: str) -> bool:
    """Tell by the name, image_rect…, whether the pictures have no distortion any more."""
    return _base_topic(image_topic).rpartition('/')[2].startswith(_RECTIFIED)


def _base_topic(image_topic: str) -> str:
    base, _, last = image_topic.rpartition('/')
    return base if last in _TRANSPORTS and base else image_topic


class DriverInfo:
    """
    Listens to the camera_info of a driver's pictures.

    :param node: The node that listens.
    :param image_topic: Full name of the pictures' topic.
    :param on_info: Called with each that differs from the one before.

    `info` is the newest; None until one has come.
    """

    def __init__(
        self, node: Node, image_topic: str,
        on_info: Callable[[CameraInfo], None] = lambda info: None,
    ) -> None:
        self._node, self._on_info = node, on_info
        self.image_topic, self.topic = image_topic, camera_info_topic(image_topic)
        self.info: Optional[CameraInfo] = None
        self._subscription = node.create_subscription(
            CameraInfo, self.topic, self._take,
            QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))

    def close(self) -> None:
        """End the subscription."""
        self._node.destroy_subscription(self._subscription)

    def _take(self, info: CameraInfo) -> None:
        header = info.header
        if self.info is not None:
            # Each has a stamp of its own.
            info.header = self.info.header
        if info != self.info:
            info.header = header
            self.info = info
            self._on_info(info)


class PictureListener(Listener):
    """
    Receives a driver's pictures, and its camera_info.

    :param topic: Of the pictures; with `/compressed` at its end, of JPEG or PNG.
    :raises InvalidValueError: If it is no topic's name.
    """

    def __init__(self, topic: str) -> None:
        super().__init__('calibrate')
        self.is_compressed = topic.endswith(_COMPRESSED)
        self._messages: List[Any] = []
        try:
            self._subscription = self._subscribe(topic, ReliabilityPolicy.BEST_EFFORT)
        except InvalidTopicNameException as error:
            self.close()
            raise InvalidValueError(
                f"'{topic}' is no topic: write one as ros2 topic list does, such as "
                '/camera/image_raw') from error
        self.topic: str = self._subscription.topic_name
        self._is_found = False
        self.driver = DriverInfo(self.node, self.topic)

    def next_picture(self) -> Any:
        """
        Wait for a picture that comes from now on.

        :raises FrameSourceError: If none comes; the message says what is there.
        """
        until = time.monotonic() + _LONGEST_WAIT_S
        if not self._is_found and self.spin_until(
                lambda: self.node.count_publishers(self.topic) > 0, _LONGEST_WAIT_S):
            # As reliable as the driver is: parts of large pictures are lost otherwise.
            self._is_found = True
            self.node.destroy_subscription(self._subscription)
            self._subscription = self._subscribe(self.topic, ReliabilityPolicy.BEST_AVAILABLE)
        self._messages.clear()
        if not self.spin_until(lambda: bool(self._messages), until - time.monotonic()):
            raise FrameSourceError(self._cause())
        return self._messages[-1]

    def wait_for_info(self) -> Optional[CameraInfo]:
        """Return the camera_info; None where the driver publishes none."""
        self.spin_until(lambda: self.driver.info is not None, _LONGEST_INFO_S)
        return self.driver.info

    def _subscribe(self, topic: str, reliability: ReliabilityPolicy) -> Subscription:
        return self.node.create_subscription(
            CompressedImage if self.is_compressed else Image, topic, self._messages.append,
            QoSProfile(depth=1, reliability=reliability))

    def _cause(self) -> str:
        if self.node.count_publishers(self.topic):
            return (f'{self.topic} gives no picture for {_LONGEST_WAIT_S:g} s: is it of type '
                    'sensor_msgs/Image, or with /compressed at its end CompressedImage?')
        others = sorted(name for name, kinds in self.node.get_topic_names_and_types() if any(
            kind.startswith('sensor_msgs/msg/') and kind.endswith('Image') for kind in kinds))
        return (f'nobody publishes {self.topic}: start the driver; there are '
                f'{", ".join(others) or "no pictures at all"}')
