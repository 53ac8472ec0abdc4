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

"""The pictures that a cell's camera node publishes."""

from typing import Callable, Dict, Tuple

from camera_to_base.dashboard.live.cells import full_name
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.subscription import Subscription
from sensor_msgs.msg import CompressedImage

TOPICS = {'annotated': 'debug_image/compressed', 'frame': 'frame/compressed',
          'mask': 'mask/compressed', 'background': 'background/compressed'}
# The background is published once; it waits for those who come later.
_LATCHED = {'background'}

OnPicture = Callable[[str, str, CompressedImage], None]


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
