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

"""Distinguishes a stream's new frames from frames that waited in a buffer."""

from collections import deque
from statistics import median
from typing import Deque, Optional

from camera_to_base.sources.live.silence_limit import INTERRUPTED_INTERVALS
from camera_to_base.sources.live.stream_clock import StreamClock

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
