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

"""Derives from the usual rate of pictures after which time without one the camera is lost."""

from collections import deque
from statistics import median_low
from typing import Deque

from camera_to_base.sources.live.reader_status import LOST_AFTER_S

# After so many usual intervals without a frame a stream is interrupted: two frames are missing.
INTERRUPTED_INTERVALS = 2.5
# A slower camera counts as lost after this time.
_LONGEST_S = 10.0


class SilenceLimit:
    """
    Measures the rate of pictures, which is not known in advance.

    The limit is some usual intervals, but at least the time after which any camera is lost. The
    usual interval is the lower median of the last five, so that a single silence does not change
    it.
    """

    def __init__(self) -> None:
        self._arrivals: Deque[float] = deque(maxlen=6)

    def note(self, arrived_at: float) -> None:
        """Record the arrival of a picture, by time.monotonic()."""
        self._arrivals.append(arrived_at)

    @property
    def seconds(self) -> float:
        """Time without a picture after which the camera counts as lost."""
        arrivals = [*self._arrivals]
        intervals = [later - earlier for earlier, later in zip(arrivals, arrivals[1:])]
        usual = median_low(intervals) if intervals else 0.0
        return min(_LONGEST_S, max(LOST_AFTER_S, INTERRUPTED_INTERVALS * usual))
