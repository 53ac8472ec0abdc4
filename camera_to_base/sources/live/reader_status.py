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
from typing import Any, NamedTuple, Optional

from camera_to_base.errors import FrameSourceError
from camera_to_base.reason import Reason
from camera_to_base.sources.live.stamp_check import STAMP_KINDS

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


class ReaderFacts(NamedTuple):
    """
    What a reader has noted of its camera.

    :param last_frame_at: When the last frame arrived, by time.monotonic().
    :param error: Why no frame arrives.
    :param last_damage: The last reason for which a frame counted as damaged.
    :param damaged_in_a_row: Number of damaged frames since the last good one.
    :param old_since: Since when all frames have been old on arrival.
    """

    last_frame_at: Optional[float] = None
    error: Optional[FrameSourceError] = None
    last_damage: Optional[Reason] = None
    damaged_in_a_row: int = 0
    old_since: Optional[float] = None
    counts: ReaderCounts = ReaderCounts()


class ReaderSnapshot(NamedTuple):
    """
    A camera's status at one moment.

    :param error: Why no frame arrives; None if frames arrive or no cause is known.
    :param seconds_without_frame: Time since the last frame, or since the reader was started.
    :param longest_silence_s: Time without a frame after which the camera counts as lost.
    :param seconds_of_old_frames: Time for which all frames have been old on arrival; 0 if they
        are not.
    :param last_damage: The last reason for which a frame counted as damaged.
    :param damaged_in_a_row: Number of damaged frames since the last good one.
    """

    state: ReaderState
    error: Optional[FrameSourceError]
    seconds_without_frame: float
    longest_silence_s: float
    seconds_of_old_frames: float
    last_damage: Optional[Reason]
    damaged_in_a_row: int
    counts: ReaderCounts


class ReaderStatus:
    """
    The status of a camera. A reader is a subclass, and writes it from one thread only.

    The facts are replaced as a whole. So another thread reads either the old ones or the new ones,
    and a snapshot never mixes two moments.
    """

    def __init__(self) -> None:
        self._begun_at = time.monotonic()
        self._facts = ReaderFacts()

    def snapshot(self) -> ReaderSnapshot:
        """Return the status at this moment."""
        facts, now = self._facts, time.monotonic()
        begun_at = self._begun_at if facts.last_frame_at is None else facts.last_frame_at
        silent_s, longest_s = now - begun_at, self.longest_silence_s
        error = self._error_of(facts, silent_s)
        old_s = 0.0 if facts.old_since is None else now - facts.old_since
        state = ReaderState.RUNNING
        if facts.last_frame_at is None:
            state = ReaderState.WAITING
        elif error is not None or silent_s > longest_s:
            state = ReaderState.LOST
        return ReaderSnapshot(state, error, silent_s, longest_s, old_s, facts.last_damage,
                              facts.damaged_in_a_row, facts.counts)

    @property
    def error(self) -> Optional[FrameSourceError]:
        """See :class:`ReaderSnapshot`."""
        return self.snapshot().error

    @property
    def state(self) -> ReaderState:
        """What the reader is doing."""
        return self.snapshot().state

    @property
    def counts(self) -> ReaderCounts:
        """Counts of frames and attempts since the reader was started."""
        return self._facts.counts

    @property
    def longest_silence_s(self) -> float:
        """See :class:`ReaderSnapshot`."""
        return LOST_AFTER_S

    def _error_of(self, facts: ReaderFacts, silent_s: float) -> Optional[FrameSourceError]:
        return facts.error

    def _note_frame(self, taken_at: float) -> None:
        self._note(error=None, last_frame_at=taken_at)

    def _note_error(self, error: FrameSourceError) -> None:
        self._note(error=error, old_since=None)

    def _note_age(self, is_old: bool) -> None:
        self._note(old_since=(self._facts.old_since or time.monotonic()) if is_old else None)
        self._count(old=is_old)

    def _note_damage(self, damage: Optional[Reason]) -> None:
        # `damage` is None for an undamaged frame.
        facts = self._facts
        self._note(last_damage=damage or facts.last_damage,
                   damaged_in_a_row=facts.damaged_in_a_row + 1 if damage else 0)
        is_old = damage is not None and damage.kind in STAMP_KINDS
        self._count(read=1, old=is_old, damaged=damage is not None and not is_old)

    def _count(self, **more: int) -> None:
        counts = self._facts.counts
        self._note(counts=counts._replace(
            **{name: getattr(counts, name) + number for name, number in more.items()}))

    def _note(self, **changes: Any) -> None:
        self._facts = self._facts._replace(**changes)
