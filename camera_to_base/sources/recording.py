# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""One interface for recordings and cameras: frames with number and time, or one picture."""

from dataclasses import dataclass
from functools import cached_property
import itertools
import os
import time
from typing import Callable, Iterator, List, NamedTuple, Optional, Protocol

from camera_to_base.errors import FrameSourceError, InvalidValueError
from camera_to_base.sources.kinds import FrameSource, SourceKind
import cv2
import numpy as np

# The rate of nearly all cameras; few of them report it.
_USUAL_FRAME_RATE = 30.0

# A camera's exposure settles within its first frames.
WARM_UP_FRAMES = 10
# An odd number, so that the median of each pixel is one of its values. The noise falls to about
# 0.4 of a single frame's.
FRAMES = 9


@dataclass(frozen=True)
class TimedFrame:
    """
    A frame of a recording.

    :param number: Number of the frame in the recording, from 0.
    :param stamp_ns: Its time in ns: since the start of a video, otherwise since 1970.
    :param decode: Returns the frame, or raises CameraToBaseError.
    :param live_at: Capture time by time.monotonic(); None for a recording.
    """

    number: int
    stamp_ns: int
    decode: Callable[[], np.ndarray]
    live_at: Optional[float] = None

    @property
    def taken_at(self) -> float:
        """Capture time in s: by time.monotonic(), or by the clock of the recording."""
        return self.stamp_ns * 1e-9 if self.live_at is None else self.live_at

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


class StillPicture(NamedTuple):
    """
    A picture as the camera has stored it.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param is_shown_turned: Whether its EXIF orientation tells viewers to turn or mirror it.
    """

    frame: np.ndarray
    is_shown_turned: bool


def read_picture(path: str) -> StillPicture:
    """
    Read a picture file, without the turn that its EXIF orientation asks viewers for.

    A camera's frames come without EXIF: as they are stored is how the node gets them.

    :raises InvalidValueError: If there is none, or it is no picture.
    """
    # Not by cv2.imread, which would print its own warning in addition to this error.
    try:
        content = np.fromfile(os.path.expanduser(path), np.uint8)
    except OSError as error:
        raise InvalidValueError(f"cannot read picture '{path}': {error.strerror}") from error
    frame = _decoded(content, cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
    if frame is None:
        raise InvalidValueError(
            f"cannot read picture '{path}': it is no picture that OpenCV knows, damaged, or "
            'larger than OpenCV reads')
    return StillPicture(frame, not np.array_equal(frame, _decoded(content, cv2.IMREAD_COLOR)))


def _decoded(content: np.ndarray, flags: int) -> Optional[np.ndarray]:
    try:
        return cv2.imdecode(content, flags) if content.size else None
    except cv2.error:  # such as a size beyond all limits
        return None


def median_frame(source: FrameSource) -> np.ndarray:
    """
    Return the median of several frames: it has less noise, and no hand that passes by.

    :returns: Shape (h, w, 3), uint8, BGR.
    :raises FrameSourceError: If the source gives no frame.
    """
    return np.median(still_frames(source), axis=0).astype(np.uint8)


def still_frames(source: FrameSource) -> List[np.ndarray]:
    """
    Return several frames of a camera that stands still, after those in which it settles.

    :returns: Each of shape (h, w, 3), uint8, BGR.
    :raises FrameSourceError: If the source gives no frame.
    """
    for _ in range(WARM_UP_FRAMES if source.kind.is_live else 0):
        source.read()
    frames = [source.read() for _ in range(FRAMES)]
    frames = [frame for frame in frames if frame is not None]
    if not frames:
        raise FrameSourceError('the source has ended before its first frame: name another')
    return frames
