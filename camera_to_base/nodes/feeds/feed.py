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

"""The feed for each kind of source; a feed passes frames or pixels to a camera node."""

from typing import Callable, NamedTuple, Optional, Protocol

from builtin_interfaces.msg import Time
from camera_to_base.detection import Pixel
from camera_to_base.nodes.feeds.frame_feeds import CameraFeed, OnFrame, TimedFeed
from camera_to_base.nodes.feeds.image_topic import ImageTopic
from camera_to_base.nodes.feeds.random_feed import RandomFeed
from camera_to_base.nodes.feeds.simulated_feed import SimulatedFeed
from camera_to_base.reason import Reason
from camera_to_base.settings import CameraSettings, NamedSource
from camera_to_base.sources import COMPRESSED_TOPIC, RANDOM, ReaderStatus, SIMULATED, TOPIC
from camera_to_base.trust import DamageCheck
from rclpy.node import Node


class Feed(Protocol):
    """
    Passes input to a node, in callbacks of the node's executor.

    `name` is the source's name. `reader` is the status of a camera; None for other sources.
    `reason` is why the feed gives nothing that can be published; None if it does.
    """

    name: str
    reader: Optional[ReaderStatus]
    reason: Optional[Reason]

    def configure(self, settings: CameraSettings) -> None:
        """Use new settings from now on."""

    def close(self) -> None:
        """Release the source."""


class FeedCallbacks(NamedTuple):
    """
    The functions that a feed calls.

    :param on_frame: Called for each frame.
    :param on_pixel: Called for each random pixel.
    :param may_start: The first frame of a recording is read once this returns True.
    :param on_end: Called once, when a recording has ended.
    """

    on_frame: OnFrame
    on_pixel: Callable[[Pixel, Time], None]
    may_start: Callable[[], bool]
    on_end: Callable[[], None]


def start_feed(
    node: Node, source: NamedSource, settings: CameraSettings, topic: str,
    callbacks: FeedCallbacks,
) -> Feed:
    """
    Start the feed that fits a source.

    :param topic: The topic of the positions, for messages.
    :raises FrameSourceError: If a camera is missing and `wait_for_camera` is false.
    """
    kind = source.kind
    if kind == RANDOM:
        return RandomFeed(node, settings, callbacks.on_pixel, topic)
    if kind in (TOPIC, COMPRESSED_TOPIC):
        return _subscribe(node, callbacks.on_frame, settings, kind == COMPRESSED_TOPIC)
    if kind.is_live:
        return CameraFeed(node, source, callbacks.on_frame, wait=settings.wait_for_camera)
    timed = callbacks.on_frame, callbacks.may_start, callbacks.on_end
    if kind.form == SIMULATED.form:
        return SimulatedFeed(node, source, settings, *timed)
    return TimedFeed(node, source, *timed)


def _subscribe(
    node: Node, on_frame: OnFrame, settings: CameraSettings, compressed: bool
) -> ImageTopic:
    # In a simulation without noise, undamaged frames may be identical to the byte.
    is_simulation = node.get_parameter('use_sim_time').value
    damage = DamageCheck().reason if not is_simulation else lambda frame: None
    return ImageTopic(node, on_frame, damage, compressed, settings.limits.max_frame_age_s)
