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

"""Reads a camera in a thread of its own: the newest frame wins, and a lost camera is sought."""

from contextlib import suppress
import threading
import time
from typing import Callable, NamedTuple, Optional

from camera_to_base.errors import FrameSourceError
from camera_to_base.reason import Reason
from camera_to_base.sources.freshness import Freshness
from camera_to_base.sources.reader_status import ReaderStatus
from camera_to_base.sources.video_file import FrameSource
import numpy as np

FIRST_PAUSE_S, LONGEST_PAUSE_S, _PAUSE_GROWTH = 0.5, 5.0, 1.2
# Longer than the timeouts of a stream, and short enough for a node that must end.
_JOIN_S = 1.9
_THREAD_NAME = 'frame reader'


class TakenFrame(NamedTuple):
    """A frame, and when it came, in s of time.monotonic()."""

    image: np.ndarray
    taken_at: float


class FrameReader(ReaderStatus):
    """
    Drains a camera, so that a slow consumer gets a new frame and never an old one.

    Only the reader's thread opens, reads and releases the camera: a release while another thread
    reads is a segmentation fault in OpenCV. Whatever else it raises, or `damage` does, is a lost
    camera, too.

    :param camera: A source whose `read` waits for a frame, opens what is not open, and raises
        FrameSourceError, closed, where that fails.
    :param on_frame: Called in the reader's thread for each frame.
    :param damage: Tells for each frame why it cannot be believed, or None.
    :param may_lag: Frames may lie in a buffer on the way, as those of a network stream do.
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
        # A daemon: should read() hang for good, only `os._exit` ends the process without an
        # abort (see `is_reader_hanging`), and no thread may be waited for on the way there.
        self._thread = threading.Thread(target=self._run, name=_THREAD_NAME, daemon=True)
        self._thread.start()

    def take(self) -> Optional[TakenFrame]:
        """Give the newest frame, once; None where no new one has come."""
        with self._lock:
            newest, self._newest = self._newest, None
            return newest

    def wait_for_first_attempt(self) -> None:
        """
        Wait until the camera has given its first frame.

        :raises FrameSourceError: If it could not be opened or gave none.
        """
        # A wait without an end could not be interrupted by a signal in older Pythons.
        while not self._first_attempt_over.wait(0.1):
            pass
        error = self.error  # the thread may make it None meanwhile
        if error is not None:
            raise error

    def close(self, timeout: float = _JOIN_S) -> bool:
        """
        End the thread, which releases the camera.

        :returns: Whether it has ended; a device's driver may hold it for longer.
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
        # Tells whether any frame came.
        count = 0
        if self._freshness is not None:
            self._freshness.restart()
        try:
            while not self._stop.is_set():
                begun_at = time.monotonic()
                image = self._camera.read()
                if count == 0 and self._last_frame_at is not None:
                    self._count(reconnects=1)
                self._keep(image, begun_at, time.monotonic())
                count += 1
        except FrameSourceError as error:
            self._lose(error)
        except Exception as error:
            # Nobody would learn of a thread that dies, and nobody would seek the camera again.
            self._lose(_as_source_error(error))
            with suppress(Exception):
                self._camera.release()
        return count > 0

    def _lose(self, error: FrameSourceError) -> None:
        self._error, self._old_since = error, None
        self._first_attempt_over.set()

    def _keep(self, image: np.ndarray, begun_at: float, ended_at: float) -> None:
        # First, for a frame that it fails on has not come.
        damage = self._damage(image)
        self._note_frame(ended_at)
        self._first_attempt_over.set()
        self._note_damage(damage)
        fresh = self._freshness is None or self._freshness.is_fresh(begun_at, ended_at)
        self._note_age(is_old=not fresh)
        if fresh and damage is None and not self._stop.is_set():
            with self._lock:
                self._count(overwritten=self._newest is not None)
                self._newest = TakenFrame(image, ended_at)
            self._on_frame()


def _as_source_error(error: Exception) -> FrameSourceError:
    # OpenCV's texts have several lines.
    text = ' '.join(str(error).split())
    return FrameSourceError(
        f'reading the camera failed, {type(error).__name__}: {text}; if that goes on, restart the '
        'node and report it')


def is_reader_hanging() -> bool:
    """
    Return whether a reader's thread has not ended though it was closed.

    An interpreter that exits then aborts in C++ (12 of 12 runs): leave by `os._exit`.
    """
    return any(thread.name == _THREAD_NAME for thread in threading.enumerate())
