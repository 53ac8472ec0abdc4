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

"""Publishes pictures of what a camera node sees, if there are subscribers."""

from typing import Callable, Optional

from camera_to_base.drawing import (
    AreaOverlay, draw_ellipses, draw_left_out, draw_note, draw_objects, Label, object_mask)
from camera_to_base.nodes.pictures.image_messages import image_message, jpeg_message
from camera_to_base.trust import FrameUncertainty, Sighting
import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header


class DebugImages:
    """
    Publishes the annotated frame, and the mask of the objects.

    Nothing is drawn or encoded for a topic without subscribers. The topics are reliable, so that
    reliable and best-effort subscribers match. Depth 1 drops old pictures.

    :param node: The node that publishes.
    """

    def __init__(self, node: Node) -> None:
        def publisher(message_type: type, topic: str) -> Publisher:
            return node.create_publisher(
                message_type, topic, QoSProfile(depth=1),
                qos_overriding_options=QoSOverridingOptions.with_default_policies())

        self._image = publisher(Image, 'debug_image')
        self._jpeg = publisher(CompressedImage, 'debug_image/compressed')
        self._mask = publisher(Image, 'mask')

    def publish(
        self, header: Header, frame: np.ndarray, sighting: Sighting, note: str, label: Label,
        areas: Optional[AreaOverlay] = None, uncertainty: Optional[FrameUncertainty] = None,
    ) -> None:
        """
        Publish the pictures that have subscribers.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param sighting: The objects that were found on it.
        :param note: Text for the corner: the background's age, or why nothing is published.
        :param label: Formats a position as text.
        :param areas: The areas in which objects count; None to draw none.
        :param uncertainty: Of the positions; None to draw no ellipses.
        """
        if _has_listener(self._image) or _has_listener(self._jpeg):
            picture = draw_left_out(frame, sighting.left_out)
            picture = draw_objects(picture, sighting.objects, label)
            if uncertainty is not None:
                draw_ellipses(picture, [(found.detection.centre, uncertainty.in_picture(found))
                                        for found in sighting.objects])
            if areas is not None:
                areas.draw(picture)
            draw_note(picture, note)
            _publish(self._image, lambda: image_message(header, picture))
            _publish(self._jpeg, lambda: jpeg_message(header, picture))
        _publish(self._mask, lambda: image_message(
            header, object_mask(frame, sighting.objects)))


def _has_listener(publisher: Publisher) -> bool:
    return publisher.get_subscription_count() > 0


def _publish(publisher: Publisher, make_message: Callable[[], object]) -> None:
    if _has_listener(publisher):
        publisher.publish(make_message())
