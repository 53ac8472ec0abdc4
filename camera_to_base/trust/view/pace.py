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

"""Decides which of the frames that are held back are compared in full."""

import time
from typing import Callable, Optional

# So many frames are compared in a row where a nudge may be corrected; later rows are shorter.
_FIRST_ROW, _LATER_ROW = 8, 2
# After a row no frame is compared for this many times what it took, for so many s at most. Where
# a nudge may be corrected, the camera may have been in motion up to now.
_REST_FACTOR, _LONGEST_REST_S, _LONGEST_REST_IN_MOTION_S = 3.0, 0.5, 0.1


class Pace:
    """
    Limits the time that full comparisons take while frames are held back.

    A comparison takes 20 to 150 ms, and the quick look clears a frame as soon as the view is as
    it was. So a frame between two comparisons is held back for the reason of the frame before it.

    :param stopwatch: Returns a time in s; the cost of a comparison is measured with it.
    """

    def __init__(self, stopwatch: Callable[[], float] = time.perf_counter) -> None:
        self._stopwatch, self._began_at = stopwatch, 0.0
        self._now: Optional[float] = None
        self._is_turn = True
        self.reset()

    def reset(self) -> None:
        """Compare the next frame in full if the look does not clear it."""
        self._due_at: Optional[float] = None
        self._row, self._longest_row, self._cost_s = 0, _FIRST_ROW, 0.0

    def begin(self, now: Optional[float]) -> bool:
        """
        Begin with a frame.

        :param now: The frame's time, in s; None for a frame that stands for itself.
        :returns: Whether it is compared in full if the look does not clear it.
        """
        self._now, self._began_at = now, self._stopwatch()
        self._is_turn = now is None or self._due_at is None or now >= self._due_at
        return self._is_turn

    def end(self, *, is_held_back: bool, may_be_corrected: bool) -> None:
        """Note what has become of the frame; a nudge is corrected if the next frame agrees."""
        if not is_held_back or self._now is None:
            self.reset()
        elif self._is_turn:
            self._row += 1
            self._cost_s += self._stopwatch() - self._began_at
            if not may_be_corrected or self._row >= self._longest_row:
                self._rest(_LONGEST_REST_IN_MOTION_S if may_be_corrected else _LONGEST_REST_S)

    def _rest(self, longest_s: float) -> None:
        rest_s = min(_REST_FACTOR * self._cost_s, longest_s)
        self._due_at = self._now + self._stopwatch() - self._began_at + rest_s
        self._row, self._longest_row, self._cost_s = 0, _LATER_ROW, 0.0
