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

"""Compares a stream's own time stamps with the clock: a frame that comes late is an old one."""

from collections import deque
from typing import Deque, NamedTuple, Optional

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
