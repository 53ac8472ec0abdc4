# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The status of a live source, and the reason why no good frame arrives."""

from collections import deque
from enum import Enum
from statistics import median_low
import time
from typing import Any, Deque, NamedTuple, Optional

from camera_to_base.errors import FrameSourceError, Level, Reason, TopicTypeError

# The clocks of two computers, and a simulation's stepped clock, normally differ by less.
_LARGEST_LEAD_S = 0.1
_DAY_S = 86400.0
_CLOCKS = ("synchronise the clocks of the driver's computer and of this one (chrony); set "
           'use_sim_time to true where a simulation or a played bag publishes /clock, and only '
           'there')
STAMP_KINDS = ('no_stamp', 'stamp_ahead', 'stamp_old')

# Without a frame for this time a camera counts as lost, unless it is known to be slower.
LOST_AFTER_S = 1.0

# After so many usual intervals without a frame a stream is interrupted: two frames are missing.
INTERRUPTED_INTERVALS = 2.5
# A slower camera counts as lost after this time.
_LONGEST_S = 10.0

# A camera is reported after this many damaged frames in a row.
_DAMAGED_IN_A_ROW = 10
# A single late picture does not mean that the clocks differ.
_STAMPS_IN_A_ROW = 3
# After opening or a stall, a stream gives old frames for a second or two.
_OLD_FOR_S = 4.0


def stamp_reason(stamp_ns: int, arrived_ns: int, max_age_s: float) -> Optional[Reason]:
    """
    Return why a picture's stamp cannot be its capture time, or is too old.

    :param stamp_ns: In ns; 0 for none.
    :param arrived_ns: Its arrival time, by the same clock.
    :param max_age_s: Its greatest allowed age on arrival.
    :returns: None for a stamp that can be used.
    """
    age_s = (arrived_ns - stamp_ns) / 1e9
    if stamp_ns == 0 and age_s > max_age_s:
        return _reason('no_stamp', 'has no stamp: choose a camera driver that stamps its pictures')
    if age_s < -_LARGEST_LEAD_S:
        return _reason('stamp_ahead', f'was stamped {_span(-age_s)} in the future: {_CLOCKS}')
    if age_s > max_age_s:
        return _reason('stamp_old', (
            f'is {_span(age_s)} old by its stamp when it arrives, at most {max_age_s:g} s are '
            f'allowed (max_frame_age): {_CLOCKS}'))
    return None


def _reason(kind: str, what: str) -> Reason:
    return Reason(kind, Level.ERROR, f'the picture {what}', is_passing=True)


def _span(seconds: float) -> str:
    return f'{seconds:.2f} s' if seconds < _DAY_S else f'{seconds / _DAY_S:.0f} days'


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


def source_reason(status: ReaderStatus, name: str) -> Optional[Reason]:
    """
    Return why a source gives no good frame.

    :param name: The name of the source, or of its topic.
    :returns: None while good frames arrive.
    """
    seen = status.snapshot()
    if seen.state is not ReaderState.RUNNING:
        return _silence(seen, name)
    damage = seen.last_damage
    if seen.damaged_in_a_row >= _STAMPS_IN_A_ROW and damage.kind in STAMP_KINDS:
        return Reason(damage.kind, Level.ERROR, f"nothing of '{name}' is used: {damage.sentence}")
    if seen.damaged_in_a_row >= _DAMAGED_IN_A_ROW:
        return Reason('damaged', Level.ERROR, (
            f"no picture of camera '{name}' can be used, {damage.sentence}"))
    if seen.seconds_of_old_frames >= _OLD_FOR_S:
        return Reason('old_frames', Level.ERROR, (
            f"camera '{name}' gives more frames than can be read, so that they are old when they "
            'come: lower its rate or its picture size'))
    return None


def _silence(seen: ReaderSnapshot, name: str) -> Reason:
    error = seen.error
    cause = error or f"camera '{name}' gives no frame: is it switched on, and reachable?"
    if error is None and seen.seconds_without_frame < seen.longest_silence_s:
        return Reason('camera_opening', Level.WARN, f"waiting for the first frame of '{name}'")
    if isinstance(cause, TopicTypeError):
        return Reason('topic_type', Level.ERROR, f'nothing is published: {cause}')
    if seen.state is ReaderState.WAITING:
        return Reason('camera_waiting', Level.ERROR, f'waiting for the camera: {cause}')
    return Reason('camera_lost', Level.ERROR, f'nothing is published: {cause}')
