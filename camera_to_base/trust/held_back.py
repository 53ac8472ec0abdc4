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

"""Derives why no position is published although frames arrive."""

import time
from typing import Optional

from camera_to_base.reason import Reason

# Shorter interruptions are not reported: the next frame may be good.
_LASTING_S = 1.0


class HeldBack:
    """
    Records why a frame's positions were not published.

    `reason` is the reason to show. A passing reason is shown when a frame is held back a second
    after the first: a slow camera's next frame may be good. If passing reasons alternate, the one
    that is shown stays until it has not occurred for a second.
    """

    def __init__(self) -> None:
        self.reason: Optional[Reason] = None
        self._since: Optional[float] = None
        self._shown_at = 0.0

    def note(self, reason: Optional[Reason]) -> None:
        """Record a frame's reason; None if its positions were published."""
        now = time.monotonic()
        if reason is None:
            self.reason = self._since = None
        elif not reason.is_passing:
            self.reason, self._since = reason, None
        else:
            self._note_passing(reason, now)

    def _note_passing(self, reason: Reason, now: float) -> None:
        if self._since is None:
            self.reason, self._since = None, now
        if now - self._since < _LASTING_S:
            return
        if (self.reason is None or reason.kind == self.reason.kind
                or now - self._shown_at >= _LASTING_S):
            self.reason, self._shown_at = reason, now
