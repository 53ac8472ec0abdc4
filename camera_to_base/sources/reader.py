# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Reads a live source in a separate thread: the newest frame, its age, and a lost camera again."""

from collections import deque
from contextlib import suppress
from statistics import median
import threading
import time
from typing import Callable, Deque, NamedTuple, Optional

from camera_to_base.errors import FrameSourceError, Reason
from camera_to_base.sources.kinds import FrameSource
from camera_to_base.sources.status import INTERRUPTED_INTERVALS, ReaderStatus
import numpy as np

# How much later than usual, by its stamp, a frame may come: a network's jitter.
_LARGEST_DELAY_S = 0.15
# The usual delay is the least one of as long, known once frames have come for at least as long.
_MEMORY_S, _SHORTEST_MEMORY_S = 2.0, 1.0
# Stamps whose delay falls by more within this memory, or grows by more, in s per s, do not run
# like the clock.
_LARGEST_FALL_S, _LARGEST_DRIFT = 0.1, 0.025
# Before, a delay that falls tells that a queue is being emptied.
_RECENT_S = 0.4
# No queue takes as long: such stamps run faster than the clock.
_LONGEST_FALL_S = 5.0
# A stream that stays late must be opened again: the queue is in its server.
_LONGEST_LAG_S = 2.0

# A frame that could be read faster than this was there already, unless the camera is faster yet.
_WAITED_S = 0.006
# On a busy processor, reading a buffered frame takes long, too. So a new frame must also arrive
# at least this share of the usual interval after the frame before.
_WAITED_INTERVALS = 0.5
# If a reader has not had to wait for this time, its frames count as old.
_LONGEST_RUSH_S = 0.2
# A longer rush means that the camera has become faster: no buffer holds that many frames.
_NEW_RATE_S = 2.0
_RUSH_WAITS = 32
# A shorter silence is no stall, however fast the camera is.
_STALL_S = 0.25

FIRST_PAUSE_S, LONGEST_PAUSE_S, _PAUSE_GROWTH = 0.5, 5.0, 1.2
# Longer than the time-outs of a stream, and short enough for a node that must end.
_JOIN_S = 1.9
_THREAD_NAME = 'frame reader'


class _Delay(NamedTuple):
    at: float
    seconds: float


class StreamClock:
    """
    Measures whether frames of an RTSP stream arrive late.

    Stamps that do not run like the clock are left alone. Frames that a server itself holds back
    from the first one on cannot be told.
    """

    def __init__(self) -> None:
        self._recent: Deque[_Delay] = deque()
        self._usual: Deque[_Delay] = deque()
        self._falling_since: Optional[float] = None
        self._late_since: Optional[float] = None
        self._is_useful = True

    @property
    def lags(self) -> bool:
        """Return whether frames have been late for so long that they will stay late."""
        return (self._late_since is not None
                and self._recent[-1].at - self._late_since > _LONGEST_LAG_S)

    def is_late(self, stamp_s: float, came_at: float) -> bool:
        """
        Judge one frame.

        :param stamp_s: Its stamp, in s from any beginning.
        :param came_at: When it came, in s of a clock that never jumps.
        """
        delay = _Delay(came_at, came_at - stamp_s)
        _append(self._recent, delay, _RECENT_S)
        usual_s = self._usual_s()
        is_late = usual_s is not None and delay.seconds - usual_s > _LARGEST_DELAY_S
        self._late_since = (self._late_since or came_at) if is_late else None
        is_known = usual_s is not None and self._usual_time_s >= _SHORTEST_MEMORY_S
        return is_late or not is_known and self._is_useful and self._falls(delay)

    def accept(self) -> None:
        """Take the frame that was judged last for a new one."""
        _append(self._usual, self._recent[-1], _MEMORY_S)

    @property
    def _usual_time_s(self) -> float:
        return self._usual[-1].at - self._usual[0].at

    def _usual_s(self) -> Optional[float]:
        if not self._usual:
            return None
        delays, time_s = [delay.seconds for delay in self._usual], self._usual_time_s
        if time_s < _SHORTEST_MEMORY_S:
            # Steady delays tell a sudden step already: a stall soon after the start.
            return min(delays) if max(delays) - min(delays) <= _LARGEST_FALL_S else None
        # A busy machine or network makes frames late, none early: the least delays count.
        before, after = min(delays[:len(delays) // 2]), min(delays[len(delays) // 2:])
        runs_like_the_clock = -_LARGEST_FALL_S <= after - before <= _LARGEST_DRIFT * time_s
        return min(before, after) if runs_like_the_clock else None

    def _falls(self, delay: _Delay) -> bool:
        falls = max(self._recent, key=_seconds).seconds - delay.seconds > _LARGEST_DELAY_S
        self._falling_since = (self._falling_since or delay.at) if falls else None
        self._is_useful = not falls or delay.at - self._falling_since <= _LONGEST_FALL_S
        return falls and self._is_useful


def _seconds(delay: _Delay) -> float:
    return delay.seconds


def _append(delays: Deque[_Delay], delay: _Delay, memory_s: float) -> None:
    delays.append(delay)
    while delay.at - delays[0].at > memory_s:
        delays.popleft()


class Freshness:
    """
    Judges frames by how long a reader had to wait for them.

    Buffered frames are read without waiting, in a rush. They are those that FFmpeg collects while
    it opens an RTSP stream (1 s), those that the sockets hold after the network or this process
    has stalled, and all frames if reading is slower than the camera. A frame is new if the reader
    had to wait for it. After a stall the reader must have waited for two frames in a row: the
    first wait is the stall itself, and a rush may contain a single slow read.
    """

    def __init__(self) -> None:
        self._intervals: Deque[float] = deque(maxlen=9)
        self.restart()

    def restart(self) -> None:
        """Trust nothing yet: the stream was opened anew."""
        self._stream_clock = StreamClock()
        self._waits_needed = 2
        self._waited_s = _WAITED_S
        self._rush_waits: Deque[float] = deque(maxlen=_RUSH_WAITS)
        self._waited_at = 0.0
        self._rushing_since: Optional[float] = None
        self._ended_at: Optional[float] = None

    @property
    def lags(self) -> bool:
        """Tell whether all frames will be old until the stream is opened anew."""
        return self._stream_clock.lags

    def is_fresh(
        self, begun_at: float, ended_at: float, stamp_s: Optional[float] = None
    ) -> bool:
        """
        Judge one frame.

        :param begun_at: When reading it began, in s, of a clock that never jumps.
        :param ended_at: When it was there.
        :param stamp_s: The stream's own time stamp, in s from any beginning; None for none.
        """
        is_late = stamp_s is not None and self._stream_clock.is_late(stamp_s, ended_at)
        is_fresh = self._was_waited_for(begun_at, ended_at) and not is_late
        if is_fresh and stamp_s is not None:
            self._stream_clock.accept()
        return is_fresh

    def _was_waited_for(self, begun_at: float, ended_at: float) -> bool:
        interval = ended_at - (self._ended_at if self._ended_at is not None else begun_at)
        self._ended_at = ended_at
        usual = median(self._intervals) if self._intervals else 0.0
        if interval > max(_STALL_S, INTERRUPTED_INTERVALS * usual):
            self._waits_needed = 2
        elif ended_at - begun_at >= self._waited_s and interval >= _WAITED_INTERVALS * usual:
            self._waits_needed = max(0, self._waits_needed - 1)
            self._waited_at, self._rushing_since = ended_at, None
        elif self._waits_needed or ended_at - self._waited_at > _LONGEST_RUSH_S:
            self._rush(ended_at, ended_at - begun_at)
            return False
        self._intervals.append(interval)
        return self._waits_needed == 0

    def _rush(self, now: float, waited_s: float) -> None:
        # In a rush, the intervals are shorter than the camera's.
        self._waits_needed = 2
        self._rushing_since = self._rushing_since or now
        self._rush_waits.append(waited_s)
        if now - self._rushing_since > _NEW_RATE_S:
            self._intervals.clear()
            self._waited_s = min(_WAITED_S, _WAITED_INTERVALS * median(self._rush_waits))


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
