# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The stage that holds frames of another view back, corrects a nudge, and sets the pace of it."""

import time
from typing import Callable, Optional, Tuple

from camera_to_base.errors import Level, Reason
from camera_to_base.pipeline.place import SeenBackground
from camera_to_base.pipeline.sighting import Limits
from camera_to_base.pipeline.stage import FrameRecord, Stage
from camera_to_base.pipeline.standpoint import PerBackground, Standpoint
from camera_to_base.pipeline.view.correction import Corrector
from camera_to_base.pipeline.view.view_check import View
from camera_to_base.pipeline.view.view_watch import ViewWatch

# So many frames are compared in a row where a nudge may be corrected; later rows are shorter.
_FIRST_ROW, _LATER_ROW = 8, 2
# After a row no frame is compared for this many times what it took, for so many s at most. Where
# a nudge may be corrected, the camera may have been in motion up to now.
_REST_FACTOR, _LONGEST_REST_S, _LONGEST_REST_IN_MOTION_S = 3.0, 0.5, 0.1

# A movement that can be corrected is measured within this time after the camera has come to rest.
_MEASURED_WITHIN_S = 2.0


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


class ViewStage(Stage):
    """
    Tells whether a frame's view is that of the background, and corrects a nudge of the camera.

    `reason` is why the view of the last frame that was compared could not be believed; None where
    it could.

    :param limits: Of the view.
    :param is_paced: Whether only some frames in a row that are held back are compared in full, so
        that a live source is not delayed; see :class:`Pace`.
    """

    def __init__(self, limits: Limits, is_paced: bool = True) -> None:
        self.reason: Optional[Reason] = None
        self._moved_since: Optional[float] = None
        self._limits, self._pace, self._is_paced = limits, Pace(), is_paced
        self._watches: PerBackground[ViewWatch] = PerBackground(self._new_watch)
        self._corrector: Optional[Corrector] = None
        self._standpoint: Optional[Standpoint] = None

    def configure(self, limits: Limits) -> None:
        """Use other limits from the next frame on."""
        self._limits = limits
        self._pace.reset()
        for watch in self._watches.made():
            watch.configure(limits)

    def view(self, standpoint: Standpoint) -> Optional[View]:
        """Give the result of the last comparison at a standpoint; None for none."""
        background = standpoint.background
        return None if background is None else self._watches.of(background).view

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Compare the view; follow the camera where it was nudged."""
        self._follow(record.standpoint)
        standpoint, self.reason = self._compared(
            record, self._pace.begin(record.now if self._is_paced else None))
        watch = self._watch(standpoint)
        self._pace.end(
            is_held_back=self.reason is not None,
            may_be_corrected=self._may_correct and self._corrector.may_correct(
                watch.view.shift_px, self._limits))
        record = record._replace(standpoint=standpoint, motion=watch.motion)
        reason = self._explained(record.now, watch)
        return record if reason is None else record.held(reason)

    def _explained(self, now: Optional[float], watch: ViewWatch) -> Optional[Reason]:
        """Say of a moved view whether it is being measured, or why it is not corrected."""
        if not self._may_correct or self.reason is None or self.reason.kind != 'view_moved':
            self._moved_since = None
            return self.reason
        return (self._while_measured(now, watch.view.shift_px)
                or self._corrector.explained(self.reason))

    def _while_measured(self, now: Optional[float], shift_px: float) -> Optional[Reason]:
        # Until a movement could have been corrected, nobody has to do anything.
        if now is None or self._corrector.is_refused or not self._corrector.may_correct(
                shift_px, self._limits):
            return None
        self._moved_since = now if self._moved_since is None else self._moved_since
        if now - self._moved_since > _MEASURED_WITHIN_S:
            return None
        return self.reason._replace(level=Level.WARN, sentence=(
            f'the view has moved by {shift_px:.1f} px: no position is published until the '
            'movement is measured, to correct it'))

    def _follow(self, standpoint: Standpoint) -> None:
        if standpoint is self._standpoint:
            return
        before, self._standpoint = self._standpoint, standpoint
        here = standpoint.uncorrected
        if before is None or here.background is not before.uncorrected.background:
            self._pace.reset()
            self._corrector = Corrector(
                standpoint.taken.picture, here.surface.surface) if here.may_correct else None
        elif self._corrector is not None:
            self._corrector.use_surface(here.surface.surface)
        self._watches.keep(standpoint)

    def _compared(
        self, record: FrameRecord, in_full: bool
    ) -> Tuple[Standpoint, Optional[Reason]]:
        frame, standpoint = record.frame, record.standpoint
        reason = self._watch(standpoint).reason(frame, in_full)
        if not self._may_correct:
            return standpoint, reason
        if reason is not None and self._is_back(record, in_full):
            self._corrector.forget()
            standpoint, reason = standpoint.nudged(None, frame), None
        if reason is not None and not in_full:
            return standpoint, reason
        if self._corrector.has_changed(
                frame, self._limits, is_held_back=reason is not None,
                shift_px=self._watch(standpoint).motion.shift_px):
            standpoint = standpoint.nudged(self._corrector.correction, frame)
            reason = self._watch(standpoint).reason(frame)
        return standpoint, reason

    def _is_back(self, record: FrameRecord, in_full: bool) -> bool:
        # Whether a camera that was nudged stands where it stood before.
        standpoint = record.standpoint
        return standpoint.correction is not None and self._watch(
            standpoint.uncorrected).reason(record.frame, in_full) is None

    @property
    def _may_correct(self) -> bool:
        return self._corrector is not None and self._limits.may_correct

    def _watch(self, standpoint: Standpoint) -> ViewWatch:
        return self._watches.of(standpoint.background)

    def _new_watch(self, background: SeenBackground) -> ViewWatch:
        return ViewWatch(background.picture, self._limits, background.witness)
