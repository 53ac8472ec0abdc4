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

"""Tells by the usual rate of pictures how long a silence must be before the camera is lost."""

from collections import deque
from statistics import median_low
from typing import Deque

from camera_to_base.sources.reader_status import LOST_AFTER_S

_USUAL_INTERVALS = 2.5
_LONGEST_S = 10.0


class SilenceLimit:
    """
    Follows the rate of pictures that nothing is known about before.

    The limit is 1 s, or 2.5 of the usual intervals where these are longer, and 10 s at most. The
    usual one is the lower median of the last five: a silence does not make a fast camera slow.
    """

    def __init__(self) -> None:
        self._arrivals: Deque[float] = deque(maxlen=6)

    def note(self, arrived_at: float) -> None:
        """Book a picture, by time.monotonic()."""
        self._arrivals.append(arrived_at)

    @property
    def seconds(self) -> float:
        """How long no picture may come before the camera counts as lost."""
        arrivals = [*self._arrivals]
        intervals = [later - earlier for earlier, later in zip(arrivals, arrivals[1:])]
        usual = median_low(intervals) if intervals else 0.0
        return min(_LONGEST_S, max(LOST_AFTER_S, _USUAL_INTERVALS * usual))
