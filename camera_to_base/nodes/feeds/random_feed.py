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

"""The tutorial's replacement for a camera: a random pixel every period."""

from typing import Callable

from builtin_interfaces.msg import Time
from camera_to_base.detection import Pixel, random_pixel
from camera_to_base.reason import Level, Reason
from camera_to_base.ros import real_time_timer
from camera_to_base.settings import CameraSettings
from rclpy.node import Node


class RandomFeed:
    """
    Draws a random pixel every period.

    :param node: The node whose executor runs the timer.
    :param settings: The camera node's settings.
    :param on_pixel: Called with each pixel and the time.
    :param topic: The topic of the positions, for the warning.
    """

    name, reader = 'random', None

    def __init__(
        self, node: Node, settings: CameraSettings, on_pixel: Callable[[Pixel, Time], None],
        topic: str,
    ) -> None:
        self._node, self._on_pixel = node, on_pixel
        self.reason = Reason('random', Level.WARN, _sentence(settings.source, topic))
        node.get_logger().warning(self.reason.sentence)
        self._timer = real_time_timer(node, settings.period, self._on_timer)

    def configure(self, settings: CameraSettings) -> None:
        """Use the new period from now on."""
        self._timer.timer_period_ns = round(settings.period * 1e9)
        self._timer.reset()

    def close(self) -> None:
        """Stop the timer."""
        self._node.destroy_timer(self._timer)

    def _on_timer(self) -> None:
        self._on_pixel(random_pixel(), self._node.get_clock().now().to_msg())


def _sentence(source: str, topic: str) -> str:
    cause = 'no camera is attached: ' if source == 'auto' else ''
    return (f'{cause}the positions on {topic} are RANDOM, as in the tutorial; name a camera or a '
            'file with the parameter source')
