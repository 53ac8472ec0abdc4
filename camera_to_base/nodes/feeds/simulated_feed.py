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

"""Feed of the simulated camera, which can be arranged while it runs."""

from camera_to_base.nodes.feeds.frame_feeds import TimedFeed
from camera_to_base.nodes.simulated import BumpService, SimulatedTool
from camera_to_base.settings import CameraSettings, NamedSource
from rclpy.node import Node


class SimulatedFeed(TimedFeed):
    """
    Renders frames at their own rate, and publishes where the simulated robot touches.

    :param node: The node whose executor renders.
    :param source: The simulated board.
    :param settings: The camera node's settings.
    :param callbacks: See :class:`TimedFeed`.
    """

    def __init__(
        self, node: Node, source: NamedSource, settings: CameraSettings, *callbacks
    ) -> None:
        super().__init__(node, source, *callbacks)
        self._settings = settings.simulated
        self._tool = SimulatedTool(node, source.frames, settings.simulated)
        self._bump_service = BumpService(node, source.frames, settings.simulated.seed)

    def configure(self, settings: CameraSettings) -> None:
        """Arrange the table, the camera and the robot anew."""
        if settings.simulated != self._settings:
            self._settings = settings.simulated
            self._source.arrange(self._settings.scene)
            self._tool.touch(self._settings.touch)

    def _on_timer(self) -> None:
        super()._on_timer()
        self._tool.publish()
