# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The feed for each kind of source; a feed passes frames or pixels to a camera node."""

import time
from typing import Callable, NamedTuple, Optional, Protocol

from builtin_interfaces.msg import Time
from camera_to_base.detection import Pixel, random_pixel
from camera_to_base.errors import Level, Reason
from camera_to_base.nodes.image_topic import ImageTopic
from camera_to_base.nodes.simulated import BumpService, SimulatedTool
from camera_to_base.pipeline import DamageCheck
from camera_to_base.ros import real_time_timer
from camera_to_base.settings import CameraSettings, NamedSource
from camera_to_base.sources import (
    COMPRESSED_TOPIC, FrameReader, RANDOM, ReaderStatus, SIMULATED, source_reason, TOPIC)
import numpy as np
from rclpy.node import Node
from rclpy.time import Time as RosTime

# Called with a frame, its capture time by time.monotonic() (None for a recording), and its capture
# time as ROS time.
OnFrame = Callable[[np.ndarray, Optional[float], Time], None]

_START_PERIOD_S = 0.1


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


class TimedFeed:
    """
    Reads a recording at its own rate.

    :param node: The node whose executor reads.
    :param source: The source to read.
    :param on_frame: Called for each frame.
    :param may_start: The first frame of a recording is read once this returns True.
    :param on_end: Called once, when the recording has ended.
    """

    reader = reason = None

    def __init__(
        self,
        node: Node,
        source: NamedSource,
        on_frame: OnFrame,
        may_start: Callable[[], bool],
        on_end: Callable[[], None],
    ) -> None:
        self._node, self._source = node, source.frames
        self.name, self._kind = source.name, source.kind
        self._on_frame, self._may_start, self._on_end = on_frame, may_start, on_end
        self._count = 0
        self._timer = real_time_timer(node, _START_PERIOD_S, self._on_start_timer)

    def configure(self, settings: CameraSettings) -> None:
        """Do nothing: a recording has no settings."""

    def close(self) -> None:
        """Release the source."""
        self._source.release()

    def _on_start_timer(self) -> None:
        if not self._kind.ends or self._may_start():
            self._node.destroy_timer(self._timer)
            self._timer = real_time_timer(
                self._node, 1 / self._kind.frame_rate, self._on_timer)

    def _on_timer(self) -> None:
        frame = self._source.read()
        if frame is None:
            self._timer.cancel()
            self._on_end()
        else:
            # A recording has its own clock.
            taken_at = self._count / self._kind.frame_rate if self._kind.ends else None
            self._count += 1
            self._on_frame(frame, taken_at, self._node.get_clock().now().to_msg())


class CameraFeed:
    """
    Takes the newest frame of a camera as soon as it arrives.

    :param node: The node whose executor takes the frames.
    :param camera: The camera to read, see :class:`FrameReader`.
    :param on_frame: Called for each frame.
    :param wait: Whether to wait for a camera that is missing.
    :raises FrameSourceError: If it is missing and `wait` is false.
    """

    def __init__(
        self, node: Node, camera: NamedSource, on_frame: OnFrame, wait: bool
    ) -> None:
        self._node, self._on_frame = node, on_frame
        self.name, self._camera = camera.name, camera.frames
        new_frame = node.create_guard_condition(self._on_new_frame)
        self.reader = FrameReader(
            camera.frames, new_frame.trigger, DamageCheck().reason, camera.kind.may_lag)
        try:
            if not wait:
                self.reader.wait_for_first_attempt()
        except BaseException:
            self.close()
            raise

    @property
    def reason(self) -> Optional[Reason]:
        """Why no good frame arrives; None if one does."""
        return source_reason(self.reader, self.name)

    def configure(self, settings: CameraSettings) -> None:
        """Request the new picture size when the camera is next opened."""
        self._camera.image_size = settings.image_size

    def close(self) -> None:
        """Stop the reader, which releases the camera."""
        self.reader.close()

    def _on_new_frame(self) -> None:
        taken = self.reader.take()
        if taken is not None:
            self._on_frame(taken.image, taken.taken_at, self._ros_time(taken.taken_at))

    def _ros_time(self, taken_at: float) -> Time:
        age_ns = int((time.monotonic() - taken_at) * 1e9)
        now = self._node.get_clock().now()
        # Simulation time starts at 0 and may be less than the frame's age.
        return RosTime(nanoseconds=max(0, now.nanoseconds - age_ns)).to_msg()


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
