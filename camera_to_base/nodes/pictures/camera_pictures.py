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

"""Publishes pictures for programs that show or calibrate the camera, if there are subscribers."""

import time
from typing import Optional

from camera_to_base.drawing import object_mask
from camera_to_base.nodes.pictures.image_messages import jpeg_message, png_message
from camera_to_base.trust import Sighting
import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Header

# Nobody looks faster; each frame costs milliseconds.
_SHORTEST_PERIOD_S = 0.09


class CameraPictures:
    """
    Publishes the frame as it is, the mask, and the background.

    Nothing is encoded for a topic without subscribers. The background is sent once; a subscriber
    that comes later gets it, too, if it asks for the durability "transient local".

    :param node: The node that publishes.
    """

    def __init__(self, node: Node) -> None:
        def publisher(
            topic: str, durability: DurabilityPolicy = DurabilityPolicy.VOLATILE
        ) -> Publisher:
            return node.create_publisher(
                CompressedImage, f'{topic}/compressed', QoSProfile(
                    depth=1, durability=durability),
                qos_overriding_options=QoSOverridingOptions.with_default_policies())

        self._frame, self._mask = publisher('frame'), publisher('mask')
        self._background = publisher('background', DurabilityPolicy.TRANSIENT_LOCAL)
        self._sent_background: Optional[np.ndarray] = None
        self._last_at = 0.0

    def publish(
        self, header: Header, frame: np.ndarray, sighting: Sighting,
        background: Optional[np.ndarray],
    ) -> None:
        """
        Publish the pictures that have subscribers.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param sighting: The objects that were found on it.
        :param background: Of the same shape; None where there is none.
        """
        if time.monotonic() - self._last_at >= _SHORTEST_PERIOD_S:
            self._publish_frame(header, frame, sighting)
        if background is not None and background is not self._sent_background and (
                _has_listener(self._background)):
            self._background.publish(png_message(header, background))
            self._sent_background = background

    def _publish_frame(self, header: Header, frame: np.ndarray, sighting: Sighting) -> None:
        if _has_listener(self._frame):
            self._frame.publish(jpeg_message(header, frame))
            self._last_at = time.monotonic()
        if _has_listener(self._mask):
            self._mask.publish(png_message(header, object_mask(frame, sighting.objects)))
            self._last_at = time.monotonic()


def _has_listener(publisher: Publisher) -> bool:
    return publisher.get_subscription_count() > 0
