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

"""Feeds of frames: a recording's at its own rate, a camera's as they arrive."""

import time
from typing import Callable, Optional

from builtin_interfaces.msg import Time
from camera_to_base.reason import Reason
from camera_to_base.ros import real_time_timer
from camera_to_base.settings import CameraSettings, NamedSource
from camera_to_base.sources import FrameReader, source_reason
from camera_to_base.trust import DamageCheck
import numpy as np
from rclpy.node import Node
from rclpy.time import Time as RosTime

# Called with a frame, its capture time by time.monotonic() (None for a recording), and its capture
# time as ROS time.
OnFrame = Callable[[np.ndarray, Optional[float], Time], None]

_START_PERIOD_S = 0.1


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
            self._on_frame(frame, None, self._node.get_clock().now().to_msg())


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
