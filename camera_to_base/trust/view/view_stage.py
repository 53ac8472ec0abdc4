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

"""The stage that compares views, and follows the camera where it is nudged."""

from typing import Optional, Tuple

from camera_to_base.reason import Level, Reason
from camera_to_base.trust.correction.corrector import Corrector
from camera_to_base.trust.correction.seen_background import SeenBackground
from camera_to_base.trust.limits import Limits
from camera_to_base.trust.stage import FrameRecord, Stage
from camera_to_base.trust.standpoint import PerBackground, Standpoint
from camera_to_base.trust.view.pace import Pace
from camera_to_base.trust.view.view_check import View
from camera_to_base.trust.view.view_watch import ViewWatch

# A movement that can be corrected is measured within this time after the camera has come to rest.
_MEASURED_WITHIN_S = 2.0


class ViewStage(Stage):
    """
    Tells whether a frame's view is that of the background, and corrects a nudge of the camera.

    `reason` is why the view of the last frame that was compared could not be believed; None where
    it could.

    :param limits: Of the view.
    """

    def __init__(self, limits: Limits) -> None:
        self.reason: Optional[Reason] = None
        self._moved_since: Optional[float] = None
        self._limits, self._pace = limits, Pace()
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
        standpoint, self.reason = self._compared(record, self._pace.begin(record.now))
        watch = self._watch(standpoint)
        self._pace.end(
            is_held_back=self.reason is not None,
            may_be_corrected=self._may_correct and self._corrector.may_correct(
                watch.view.shift_px, self._limits))
        record = record._replace(standpoint=standpoint, motion=watch.motion)
        reason = self._explained(record.now, watch.view.shift_px)
        return record if reason is None else record.held(reason)

    def _explained(self, now: Optional[float], shift_px: float) -> Optional[Reason]:
        """Say of a moved view whether it is being measured, or why it is not corrected."""
        if not self._may_correct or self.reason is None or self.reason.kind != 'view_moved':
            self._moved_since = None
            return self.reason
        return self._while_measured(now, shift_px) or self._corrector.explained(self.reason)

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
