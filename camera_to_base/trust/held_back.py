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

"""Tells why no position is published though frames come."""

import time
from typing import Optional

# A single frame may be held back: the next one comes.
_LASTING_S = 1.0


class HeldBack:
    """
    Books for each frame why no position of it may be published.

    `reason` tells why, where that has been so for a second, by the frames' own times: a slow
    camera's next frame may be good. None where one was published since.
    """

    def __init__(self) -> None:
        self.reason: Optional[str] = None
        self._since: Optional[float] = None

    def note(self, reason: Optional[str]) -> None:
        """Book one frame; None for one that was published."""
        now = time.monotonic()
        self._since = None if reason is None else now if self._since is None else self._since
        lasts = reason is not None and now - self._since >= _LASTING_S
        self.reason = reason if lasts else None
