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

"""What is known about where a camera's frames come from: state, error, damage, counts."""

from enum import Enum
import time
from typing import NamedTuple, Optional

from camera_to_base.errors import FrameSourceError
from camera_to_base.reason import Reason
from camera_to_base.sources.stamp_check import STAMP_KINDS

# No frame for as long as this means that the camera is lost, unless it is known to be slower.
LOST_AFTER_S = 1.0


class ReaderState(Enum):
    """What a reader is doing."""

    WAITING = 'waiting for the first frame'
    RUNNING = 'running'
    LOST = 'lost the camera'


class ReaderCounts(NamedTuple):
    """What a reader has done so far."""

    read: int = 0
    old: int = 0
    damaged: int = 0
    overwritten: int = 0
    attempts: int = 0
    reconnects: int = 0


class ReaderStatus:
    """
    Books what came of a camera; a reader is one, and writes it from one thread alone.

    `last_damage` tells why a frame could not be believed, `damaged_in_a_row` how many could not
    since the last good one.
    """

    def __init__(self) -> None:
        self._last_frame_at: Optional[float] = None
        self._begun_at = time.monotonic()
        self._error: Optional[FrameSourceError] = None
        self.last_damage: Optional[Reason] = None
        self.damaged_in_a_row = 0
        self._old_since: Optional[float] = None
        self.counts = ReaderCounts()

    @property
    def error(self) -> Optional[FrameSourceError]:
        """Tell why no frame comes; None while one does, or where no cause is known."""
        return self._error

    @property
    def state(self) -> ReaderState:
        """Tell what the reader is doing."""
        if self._last_frame_at is None:
            return ReaderState.WAITING
        lost = self.error is not None or self.seconds_without_frame > self.longest_silence_s
        return ReaderState.LOST if lost else ReaderState.RUNNING

    @property
    def longest_silence_s(self) -> float:
        """How long no frame may come before the camera counts as lost."""
        return LOST_AFTER_S

    @property
    def seconds_without_frame(self) -> float:
        """How long ago the last frame came, or the reader was started."""
        return time.monotonic() - (self._last_frame_at or self._begun_at)

    @property
    def seconds_of_old_frames(self) -> float:
        """For how long no frame has come that was new on arrival, though frames come."""
        since = self._old_since  # the reader's thread may make it None meanwhile
        return 0.0 if since is None else time.monotonic() - since

    def _note_frame(self, taken_at: float) -> None:
        self._error, self._last_frame_at = None, taken_at

    def _note_age(self, is_old: bool) -> None:
        self._old_since = (self._old_since or time.monotonic()) if is_old else None
        self._count(old=is_old)

    def _note_damage(self, damage: Optional[Reason]) -> None:
        # None for a frame that can be believed.
        self.last_damage = damage or self.last_damage
        self.damaged_in_a_row = self.damaged_in_a_row + 1 if damage else 0
        is_old = damage is not None and damage.kind in STAMP_KINDS
        self._count(read=1, old=is_old, damaged=damage is not None and not is_old)

    def _count(self, **more: int) -> None:
        # The reader's thread alone writes; whoever reads gets one tuple or the next.
        self.counts = self.counts._replace(
            **{name: getattr(self.counts, name) + number for name, number in more.items()})
