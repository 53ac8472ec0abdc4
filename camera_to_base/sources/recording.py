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

"""Recordings and cameras as one kind of thing: frames, each with its number and its time."""

from dataclasses import dataclass
from functools import cached_property
import itertools
import time
from typing import Callable, Iterator, Optional, Protocol

from camera_to_base.sources.source_kind import SourceKind
from camera_to_base.sources.video_file import FrameSource
import numpy as np

# What nearly every camera gives; few tell.
_USUAL_FRAME_RATE = 30.0


@dataclass(frozen=True)
class TimedFrame:
    """
    A frame of a recording.

    :param number: Of the recording's frames, from 0.
    :param stamp_ns: Its time in ns: since the beginning of a video, since 1970 elsewhere.
    :param decode: Makes the frame, or raises CameraToBaseError.
    :param taken_at: When a camera took it, by time.monotonic(); None for a recording.
    """

    number: int
    stamp_ns: int
    decode: Callable[[], np.ndarray]
    taken_at: Optional[float] = None

    @cached_property
    def frame(self) -> np.ndarray:
        """
        Give the frame, which is decoded once, and not before somebody asks for it.

        :returns: Shape (h, w, 3), uint8, BGR.
        :raises CameraToBaseError: If it cannot be decoded.
        """
        return self.decode()


class Recording(Protocol):
    """
    What frames can be read from, once.

    `kind` tells what it is, with the frame rate that a video of it should have; `frame_count` is
    None where nobody knows.
    """

    kind: SourceKind
    frame_count: Optional[int]

    def frames(self) -> Iterator[TimedFrame]:
        """
        Read one frame after another.

        :raises FrameSourceError: If there should be another frame, but none came.
        """

    def release(self) -> None:
        """Give the device or file back."""


class PlayedRecording:
    """
    A source with a rate, a video file or the simulated board: its frames' numbers tell the time.

    :param source: What to read.
    :param frame_count: How many frames it has; None where nobody knows.
    :param last: Read no more than this many; None for all.
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
        """Give the source back."""
        self._source.release()


class LiveRecording:
    """
    A camera, whose frames have the time at which they came.

    :param camera: What to read.
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
        """Give the camera back."""
        self._camera.release()
