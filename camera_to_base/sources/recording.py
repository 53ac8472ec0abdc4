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

"""One interface for recordings and cameras: frames with their number and time."""

from dataclasses import dataclass
from functools import cached_property
import itertools
import time
from typing import Callable, Iterator, Optional, Protocol

from camera_to_base.sources.frame_source import FrameSource
from camera_to_base.sources.source_kind import SourceKind
import numpy as np

# The rate of nearly all cameras; few of them report it.
_USUAL_FRAME_RATE = 30.0


@dataclass(frozen=True)
class TimedFrame:
    """
    A frame of a recording.

    :param number: Number of the frame in the recording, from 0.
    :param stamp_ns: Its time in ns: since the start of a video, otherwise since 1970.
    :param decode: Returns the frame, or raises CameraToBaseError.
    :param taken_at: Capture time by time.monotonic(); None for a recording.
    """

    number: int
    stamp_ns: int
    decode: Callable[[], np.ndarray]
    taken_at: Optional[float] = None

    @cached_property
    def frame(self) -> np.ndarray:
        """
        The frame; it is decoded on the first access.

        :returns: Shape (h, w, 3), uint8, BGR.
        :raises CameraToBaseError: If it cannot be decoded.
        """
        return self.decode()


class Recording(Protocol):
    """
    A source whose frames can be read once.

    `kind` is the kind of source, with the frame rate for a video of it. `frame_count` is None if
    it is unknown.
    """

    kind: SourceKind
    frame_count: Optional[int]

    def frames(self) -> Iterator[TimedFrame]:
        """
        Read one frame after another.

        :raises FrameSourceError: If the next frame cannot be read.
        """

    def release(self) -> None:
        """Release the device or file."""


class PlayedRecording:
    """
    A video file or the simulated board; a frame's time follows from its number and the rate.

    :param source: The source to read.
    :param frame_count: Number of its frames; None if unknown.
    :param last: Number of frames to read; None for all.
    """

    def __init__(
        self, source: FrameSource, frame_count: Optional[int], last: Optional[int] = None
    ) -> None:
        self._source, self._last = source, last
        self.kind, self.frame_count = source.kind._replace(ends=True), frame_count

    def frames(self) -> Iterator[TimedFrame]:
        """Read one frame after another, see :meth:`Recording.frames`."""
        for number in itertools.islice(itertools.count(), self._last):
            frame = self._source.read()
            if frame is None:
                return
            stamp_ns = round(number * 1e9 / self.kind.frame_rate)
            yield TimedFrame(number, stamp_ns, lambda it=frame: it)

    def release(self) -> None:
        """Release the source."""
        self._source.release()


class LiveRecording:
    """
    A camera; a frame's time is its arrival time.

    :param camera: The camera to read.
    """

    frame_count = None

    def __init__(self, camera: FrameSource) -> None:
        self._camera = camera
        self.kind = camera.kind._replace(frame_rate=_USUAL_FRAME_RATE)

    def frames(self) -> Iterator[TimedFrame]:
        """Read one frame after another, see :meth:`Recording.frames`."""
        for number in itertools.count():
            frame = self._camera.read()
            yield TimedFrame(number, time.time_ns(), lambda it=frame: it, time.monotonic())

    def release(self) -> None:
        """Release the camera."""
        self._camera.release()
