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

"""Status of a camera that is read: state, error, damage, counts."""

from enum import Enum
import time
from typing import NamedTuple, Optional

from camera_to_base.errors import FrameSourceError
from camera_to_base.reason import Reason
from camera_to_base.sources.stamp_check import STAMP_KINDS

# Without a frame for this time a camera counts as lost, unless it is known to be slower.
LOST_AFTER_S = 1.0


class ReaderState(Enum):
    """What a reader is doing."""

    WAITING = 'waiting for the first frame'
    RUNNING = 'running'
    LOST = 'lost the camera'


class ReaderCounts(NamedTuple):
    """Counts of frames and attempts since the reader was started."""

    read: int = 0
    old: int = 0
    damaged: int = 0
    overwritten: int = 0
    attempts: int = 0
    reconnects: int = 0


class ReaderStatus:
    """
    The status of a camera. A reader is a subclass, and writes it from one thread only.

    `last_damage` is the last reason for which a frame counted as damaged. `damaged_in_a_row` is
    the number of damaged frames since the last good one.
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
        """Why no frame arrives; None if frames arrive or no cause is known."""
        return self._error

    @property
    def state(self) -> ReaderState:
        """What the reader is doing."""
        if self._last_frame_at is None:
            return ReaderState.WAITING
        lost = self.error is not None or self.seconds_without_frame > self.longest_silence_s
        return ReaderState.LOST if lost else ReaderState.RUNNING

    @property
    def longest_silence_s(self) -> float:
        """Time without a frame after which the camera counts as lost."""
        return LOST_AFTER_S

    @property
    def seconds_without_frame(self) -> float:
        """Time since the last frame, or since the reader was started."""
        return time.monotonic() - (self._last_frame_at or self._begun_at)

    @property
    def seconds_of_old_frames(self) -> float:
        """Time for which all frames have been old on arrival; 0 if they are not."""
        since = self._old_since  # a copy: the reader's thread may set it to None meanwhile
        return 0.0 if since is None else time.monotonic() - since

    def _note_frame(self, taken_at: float) -> None:
        self._error, self._last_frame_at = None, taken_at

    def _note_age(self, is_old: bool) -> None:
        self._old_since = (self._old_since or time.monotonic()) if is_old else None
        self._count(old=is_old)

    def _note_damage(self, damage: Optional[Reason]) -> None:
        # `damage` is None for an undamaged frame.
        self.last_damage = damage or self.last_damage
        self.damaged_in_a_row = self.damaged_in_a_row + 1 if damage else 0
        is_old = damage is not None and damage.kind in STAMP_KINDS
        self._count(read=1, old=is_old, damaged=damage is not None and not is_old)

    def _count(self, **more: int) -> None:
        # Only the reader's thread writes; other threads read either the old tuple or the new one.
        self.counts = self.counts._replace(
            **{name: getattr(self.counts, name) + number for name, number in more.items()})
