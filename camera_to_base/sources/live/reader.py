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

"""Reads a camera in a separate thread, keeps the newest frame, and reopens a lost camera."""

from contextlib import suppress
import threading
import time
from typing import Callable, NamedTuple, Optional

from camera_to_base.errors import FrameSourceError
from camera_to_base.reason import Reason
from camera_to_base.sources.frame_source import FrameSource
from camera_to_base.sources.live.freshness import Freshness
from camera_to_base.sources.live.reader_status import ReaderStatus
import numpy as np

FIRST_PAUSE_S, LONGEST_PAUSE_S, _PAUSE_GROWTH = 0.5, 5.0, 1.2
# Longer than the time-outs of a stream, and short enough for a node that must end.
_JOIN_S = 1.9
_THREAD_NAME = 'frame reader'


class TakenFrame(NamedTuple):
    """A frame, and its arrival time in s of time.monotonic()."""

    image: np.ndarray
    taken_at: float


class FrameReader(ReaderStatus):
    """
    Reads all frames of a camera, so that a slow consumer gets the newest frame.

    Only the reader's thread opens, reads and releases the camera: to release it while another
    thread reads is a segmentation fault in OpenCV. Any other exception of the camera or of
    `damage` also counts as a lost camera.

    :param camera: A source whose `read` waits for a frame and opens the camera if it is closed.
        On failure `read` closes the camera and raises FrameSourceError.
    :param on_frame: Called in the reader's thread for each frame.
    :param damage: Returns why a frame is damaged, or None if it is not.
    :param may_lag: Whether frames may wait in a buffer, as with a network stream.
    """

    def __init__(
        self,
        camera: FrameSource,
        on_frame: Callable[[], None] = lambda: None,
        damage: Callable[[np.ndarray], Optional[Reason]] = lambda frame: None,
        may_lag: bool = True,
    ) -> None:
        super().__init__()
        self._camera = camera
        self._on_frame = on_frame
        self._damage = damage
        self._freshness = Freshness() if may_lag else None
        self._lock = threading.Lock()
        self._stop = threading.Event()
        self._first_attempt_over = threading.Event()
        self._newest: Optional[TakenFrame] = None
        # A daemon thread: if read() never returns, the process must reach `os._exit` without
        # joining the thread (see `is_reader_hanging`).
        self._thread = threading.Thread(target=self._run, name=_THREAD_NAME, daemon=True)
        self._thread.start()

    def take(self) -> Optional[TakenFrame]:
        """Return the newest frame, once; None if no new one has arrived."""
        with self._lock:
            newest, self._newest = self._newest, None
            return newest

    def wait_for_first_attempt(self) -> None:
        """
        Wait until the camera has given its first frame.

        :raises FrameSourceError: If it could not be opened or gave none.
        """
        # With a time-out, so that a signal interrupts the wait in older Python versions, too.
        while not self._first_attempt_over.wait(0.1):
            pass
        error = self.error  # a copy: the thread may set it to None meanwhile
        if error is not None:
            raise error

    def close(self, timeout: float = _JOIN_S) -> bool:
        """
        Stop the thread, which releases the camera.

        :returns: Whether it has ended; a device driver may block it for longer.
        """
        self._stop.set()
        self._thread.join(timeout)
        return not self._thread.is_alive()

    def _run(self) -> None:
        pause = FIRST_PAUSE_S
        while not self._stop.is_set():
            self._count(attempts=1)
            if self._read_until_lost():
                pause = FIRST_PAUSE_S
            self._stop.wait(pause)
            pause = min(LONGEST_PAUSE_S, pause * _PAUSE_GROWTH)
        self._camera.release()

    def _read_until_lost(self) -> bool:
        # Returns whether any frame arrived.
        count = 0
        if self._freshness is not None:
            self._freshness.restart()
        try:
            while not self._stop.is_set():
                begun_at = time.monotonic()
                image = self._camera.read()
                if count == 0 and self._facts.last_frame_at is not None:
                    self._count(reconnects=1)
                self._keep(image, begun_at, time.monotonic())
                count += 1
                if self._freshness is not None and self._freshness.lags:
                    self._camera.release()
                    raise FrameSourceError(
                        'the stream is behind, by its own time stamps: it is opened anew')
        except FrameSourceError as error:
            self._lose(error)
        except Exception as error:
            # Otherwise the thread would end unnoticed, and the camera would not be reopened.
            self._lose(_as_source_error(error))
            with suppress(Exception):
                self._camera.release()
        return count > 0

    def _lose(self, error: FrameSourceError) -> None:
        self._note_error(error)
        self._first_attempt_over.set()

    def _keep(self, image: np.ndarray, begun_at: float, ended_at: float) -> None:
        # First: a frame for which it raises does not count as arrived.
        damage = self._damage(image)
        self._note_frame(ended_at)
        self._first_attempt_over.set()
        self._note_damage(damage)
        fresh = self._freshness is None or self._freshness.is_fresh(
            begun_at, ended_at, getattr(self._camera, 'stamp_s', None))
        self._note_age(is_old=not fresh)
        if fresh and damage is None and not self._stop.is_set():
            with self._lock:
                self._count(overwritten=self._newest is not None)
                self._newest = TakenFrame(image, ended_at)
            self._on_frame()


def _as_source_error(error: Exception) -> FrameSourceError:
    # OpenCV's messages have several lines.
    text = ' '.join(str(error).split())
    return FrameSourceError(
        f'reading the camera failed, {type(error).__name__}: {text}; if that goes on, restart the '
        'node and report it')


def is_reader_hanging() -> bool:
    """
    Return whether a reader's thread has not ended though it was closed.

    If it has not, a normal exit of the interpreter aborts in C++ (12 of 12 runs): use `os._exit`.
    """
    return any(thread.name == _THREAD_NAME for thread in threading.enumerate())
