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

"""Where the camera stands: the surface and the background that hold there."""

from typing import Optional

from camera_to_base.image_size import ImageSize
from camera_to_base.reason import Level, Reason
from camera_to_base.surface import flat_surface, is_same_surface, NudgedSurface, Surface
from camera_to_base.trust.background import Background
from camera_to_base.trust.correction.correction import corrected_surface, Correction
from camera_to_base.trust.correction.corrector import Corrector
from camera_to_base.trust.correction.seen_background import SeenBackground
from camera_to_base.trust.limits import Limits
from camera_to_base.trust.scene import Scene
from camera_to_base.trust.surface_in_force import SurfaceInForce
from camera_to_base.trust.view.pace import Pace
from camera_to_base.trust.view.view_check import View
import numpy as np

# A movement that can be corrected is measured within this time after the camera has come to rest.
_MEASURED_WITHIN_S = 2.0


class Standpoint:
    """
    Follows the camera where it is nudged: keeps the surface and the background that hold there.

    :param surface: As calibrated.

    `scene` is what frames are compared with, `background` is the background as it was taken, and
    `background_as_calibrated` is the background as the camera sees it from where it was
    calibrated; all are None before the first background.
    """

    def __init__(self, surface: Surface, limits: Limits) -> None:
        self._surface, self._limits = surface, limits
        # What the camera's pixels mean where the background was taken.
        self._base = SurfaceInForce(surface)
        self.background: Optional[Background] = None
        self.background_as_calibrated: Optional[SeenBackground] = None
        self._corrector: Optional[Corrector] = None
        self._reason: Optional[Reason] = None
        self._moved_since: Optional[float] = None
        self._pace = Pace()
        self.scene: Optional[Scene] = None
        self._uncorrected: Optional[Scene] = None

    @property
    def surface(self) -> SurfaceInForce:
        """What the pixels of the last frame mean."""
        return self._base if self.scene is None else self.scene.surface

    @property
    def correction(self) -> Optional[Correction]:
        """How the camera was nudged since the background was taken; None for not at all."""
        return None if self._corrector is None else self._corrector.correction

    @property
    def view(self) -> Optional[View]:
        """Result of the last comparison of a frame's view with the background; None for none."""
        return None if self.scene is None else self.scene.view.view

    def configure(self, surface: Surface, limits: Limits) -> None:
        """
        Use a new calibration and new limits from the next frame on.

        Another calibration ends a correction: where the camera stood for it is not known. One that
        says what the correction says makes it needless.
        """
        if surface != self._surface:
            if self.surface.reason is not None and self._is_in_force(surface):
                self._keep(surface)
            else:
                self._recalibrate(surface)
        self._limits = limits
        self._pace.reset()
        if self.scene is not None:
            self.scene.view.configure(limits)
            self._uncorrected.view.configure(limits)
        if not limits.may_correct:
            self._end_correction()

    def use_background(self, background: Background, may_correct: bool = True) -> None:
        """
        Use a background that the camera has taken from where it stands now.

        :param may_correct: Whether its pixels are those that the surface in force maps.
        """
        self._base, self.background = self.surface, background
        self._corrector = Corrector(
            background.picture, self._base.surface) if may_correct else None
        self.background_as_calibrated = self._taken.as_calibrated(
            self._base.frame_from_calibrated, self.background_as_calibrated)
        self._begin()

    def use_surface(self, surface: Optional[SurfaceInForce]) -> None:
        """
        Use another surface from the next frame on: the camera stands elsewhere.

        Frames are held back until there is a background of the new place, and the movement from
        the old one is not corrected.

        :param surface: None for the calibrated one.
        """
        self._base = SurfaceInForce(self._surface) if surface is None else surface
        self._corrector = None
        if self.background is not None:
            self._begin()

    def stand_at(self, surface: SurfaceInForce) -> None:
        """Use another surface for the place where the background was taken, and frames are."""
        self.use_surface(surface)
        self.use_background(self.background)

    def reason(self, frame: np.ndarray, now: Optional[float]) -> Optional[Reason]:
        """
        Tell why the view of a frame cannot be believed, and correct a nudge.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :param now: The frame's time, in s; None for a recording, of which each frame stands for
            itself.
        """
        self._reason = self._judged(frame, self._pace.begin(now))
        may_correct = self._may_correct
        self._pace.end(
            is_held_back=self._reason is not None,
            may_be_corrected=may_correct and self._corrector.may_correct(
                self.view.shift_px, self._limits))
        if not may_correct or self._reason is None or self._reason.kind != 'view_moved':
            self._moved_since = None
            return self._reason
        return self._while_measured(now) or self._corrector.explained(self._reason)

    def _while_measured(self, now: Optional[float]) -> Optional[Reason]:
        # Until a movement could have been corrected, nobody has to do anything.
        shift_px = self.view.shift_px
        if now is None or self._corrector.is_refused or not self._corrector.may_correct(
                shift_px, self._limits):
            return None
        self._moved_since = now if self._moved_since is None else self._moved_since
        if now - self._moved_since > _MEASURED_WITHIN_S:
            return None
        return self._reason._replace(level=Level.WARN, sentence=(
            f'the view has moved by {shift_px:.1f} px: no position is published until the '
            'movement is measured, to correct it'))

    @property
    def _may_correct(self) -> bool:
        return self._corrector is not None and self._limits.may_correct

    def _judged(self, frame: np.ndarray, in_full: bool) -> Optional[Reason]:
        reason = self.scene.view.reason(frame, in_full)
        if not self._may_correct:
            return reason
        if reason is not None and self._is_back(frame, in_full):
            reason = None
        if reason is not None and not in_full:
            return reason
        if self._corrector.has_changed(
                frame, self._limits, is_held_back=reason is not None,
                shift_px=self.scene.view.shift_px):
            self._correct(frame)
            return self.scene.view.reason(frame)
        return reason

    def _end_correction(self) -> None:
        # A surface by markers is measured, not corrected.
        if self._base.replaces and self.correction is not None:
            self.use_surface(self._base)
        elif not self._base.replaces and self.surface.frame_from_calibrated is not None:
            self.use_surface(None)

    def _recalibrate(self, surface: Surface) -> None:
        is_same = flat_surface(surface) is flat_surface(self._surface)
        before, self._surface = self.surface, surface
        moved = self._base.frame_from_calibrated
        if before.reason is None and (is_same or self._reason is None):
            self._base = SurfaceInForce(surface)
        elif is_same and not before.replaces:
            self._base = self._base._replace(surface=surface if moved is None else NudgedSurface(
                surface, moved.inverse, self._size))
        else:
            self.use_surface(None)
            return
        if self._corrector is not None:
            self._corrector.use_surface(self._base.surface)
        if self.scene is not None:
            self._uncorrected.use_surface(self._base)
            self.scene.use_surface(self._surface_here())

    def _is_in_force(self, surface: Surface) -> bool:
        return self.scene is not None and is_same_surface(
            flat_surface(surface), flat_surface(self.surface.surface), self._size)

    def _keep(self, surface: Surface) -> None:
        # The background as the camera sees it is one that was taken from here.
        before, self._surface = self.scene, surface
        before.use_surface(SurfaceInForce(surface))
        self.use_background(self.background._replace(**before.background._asdict()))
        self.scene.remember_arms(before)

    def _begin(self) -> None:
        self.scene = self._uncorrected = Scene(self._taken, self._base, self._limits)
        self._pace.reset()

    @property
    def _taken(self) -> SeenBackground:
        taken = self.background
        return SeenBackground(taken.picture, taken.witness, taken.unknown)

    def _correct(self, frame: np.ndarray) -> None:
        # The background as the camera sees it from where it stands.
        before = self.scene
        if self.correction is None:
            self.scene = self._uncorrected
            self.scene.forget_objects()
            self.scene.remember_arms(before)
            return
        seen = self._uncorrected.background.seen_after(
            self.correction.nudge.frame_from_background, frame)
        self.scene = Scene(seen, self._surface_here(), self._limits)
        self.scene.remember_arms(before)

    def _is_back(self, frame: np.ndarray, in_full: bool) -> bool:
        # Whether a camera that was nudged stands where it stood before.
        if self.correction is None or self._uncorrected.view.reason(frame, in_full) is not None:
            return False
        self._corrector.forget()
        self._correct(frame)
        return True

    @property
    def _size(self) -> ImageSize:
        height, width = self.background.picture.shape[:2]
        return width, height

    def _surface_here(self) -> SurfaceInForce:
        correction = self.correction
        return self._base if correction is None else corrected_surface(
            correction, self._base, self._size)
