# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Whether the clocks of the cameras' machines agree with the clock of this one."""

from collections import deque
from typing import Deque, Dict, NamedTuple, Optional

# The shortest of so many ways through the network tells how far a clock is off.
_MESSAGES = 30


class ClockError(NamedTuple):
    """
    A clock that is off.

    :param camera: The camera's name.
    :param ahead_s: By how much; negative where it is behind.
    """

    camera: str
    ahead_s: float


class ClockCheck:
    """
    Compares when messages were sent, by the sender's clock, with when they came, by this one's.

    A message is on its way for a millisecond or so. If the shortest of many ways took a negative
    time, or far more, it was not the network.
    """

    def __init__(self) -> None:
        self._ways: Dict[str, Deque[float]] = {}

    def note(self, camera: str, sent_s: float, received_s: float) -> None:
        """Note a message."""
        self._ways.setdefault(camera, deque(maxlen=_MESSAGES)).append(received_s - sent_s)

    def error(self, tolerance_s: float) -> Optional[ClockError]:
        """Return the clock that is off most, if it is by more than a tolerance."""
        errors = [ClockError(camera, -min(ways)) for camera, ways in self._ways.items()
                  if len(ways) == _MESSAGES]
        worst = max(errors, key=lambda one: abs(one.ahead_s), default=None)
        return worst if worst is not None and abs(worst.ahead_s) > tolerance_s else None
