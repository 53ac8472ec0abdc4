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

"""From frames to objects that may be published: background, detection, checks, gate."""

from collections import Counter
import math
import time
from typing import NamedTuple, Optional

from camera_to_base.detection import (
    BackgroundTaker, check_frame, check_same_size, DetectorSettings, ObjectLocator)
from camera_to_base.errors import CameraToBaseError, FrameSizeError
from camera_to_base.reason import Level, Reason
from camera_to_base.sources import SIMULATED, SourceKind
from camera_to_base.surface import Surface
from camera_to_base.trust.arms.arm_check import ArmCheck
from camera_to_base.trust.frame_uncertainty import FrameUncertainty
from camera_to_base.trust.gate import PositionGate
from camera_to_base.trust.held_back import HeldBack
from camera_to_base.trust.limits import Limits
from camera_to_base.trust.sighting import Sighting
from camera_to_base.trust.view.view_check import View
from camera_to_base.trust.view.view_watch import ViewWatch
from camera_to_base.uncertainty import FrameState, PositionUncertainty, ShiftMean
import numpy as np

# By how much a frame that was moved back may still be off, see the benchmark of the view.
_MOVED_BACK_PX = 0.1


class KeptBackground(NamedTuple):
    """A background that is being replaced, and when it was taken, by time.monotonic()."""

    picture: np.ndarray
    taken_at: float
    is_restored: bool


class CameraPipeline:
    """
    Converts each frame to the objects that may be published.

    :param surface: Maps pixels to the work surface.
    :param detector: The detector's settings.
    :param background_frames: The first background is the median of this many frames.
    :param kind: The kind of source. Age and jumps are checked for live sources only, the view
        for all sources but recordings.
    """

    def __init__(
        self,
        surface: Surface,
        detector: DetectorSettings = DetectorSettings(),
        limits: Limits = Limits(),
        background_frames: int = 1,
        kind: SourceKind = SIMULATED,
    ) -> None:
        self._kind = kind
        self._gate = PositionGate(limits.max_frame_age_s, limits.confirm_jump_px)
        self._view: Optional[ViewWatch] = None
        self._held_back, self._shifts = HeldBack(), ShiftMean()
        self.counts: Counter = Counter()
        self._surface, self._detector = surface, detector
        self._limits = self._limits_here(limits)
        self._locator: Optional[ObjectLocator] = None
        self.background: Optional[np.ndarray] = None
        self.background_frame_count = 0
        self._replaced: Optional[KeptBackground] = None
        self.capture_background(background_frames)

    def configure(
        self, surface: Surface, detector: DetectorSettings, limits: Limits
    ) -> None:
        """
        Use new settings from the next frame on, with the same background.

        Parts whose settings have not changed keep their state, so that no frame is held back.
        """
        limits = self._limits_here(limits)
        if (surface, detector) != (self._surface, self._detector):
            self._surface, self._detector = surface, detector
            self._locator = None
            if self._view is not None:
                self._arms.forget_objects()
        if limits != self._limits:
            self._limits = limits
            self._gate.configure(limits.max_frame_age_s, limits.confirm_jump_px)
            if self._view is not None:
                self._view.configure(limits)

    def capture_background(self, frame_count: int) -> None:
        """
        Take a new background from the next frames; until then no objects are found.

        Fewer frames are taken if they would need too much memory, see :class:`BackgroundTaker`;
        `background_frame_count` is their number.
        """
        if self.background is not None:
            self._replaced = KeptBackground(
                self.background, self._background_taken_at, self.background_is_restored)
        self._taker: Optional[BackgroundTaker] = BackgroundTaker(frame_count)
        self.background = None

    def keep_background(self) -> bool:
        """
        Stop taking a new background, and use the previous one again.

        :returns: Whether there is one; otherwise the next good frames become the background.
        """
        if self.background is None and self._replaced is not None:
            picture, taken_at, is_restored = self._replaced
            self._use_background(
                picture, age_s=time.monotonic() - taken_at, is_restored=is_restored)
        return self.background is not None

    def restore_background(self, background: np.ndarray, age_s: float) -> None:
        """
        Use a saved background; the first frame's view is compared with it.

        :param background: Shape (h, w, 3), uint8, BGR.
        :param age_s: Its age.
        """
        self._use_background(background, age_s=age_s, is_restored=True)

    @property
    def background_age_s(self) -> float:
        """Age of the background, in s."""
        return time.monotonic() - self._background_taken_at

    @property
    def faintness(self) -> Optional[str]:
        """Say how faint an object may be with the noise of the frames; None for not known."""
        noise = None if self._locator is None else self._locator.noise
        return None if noise is None else self._detector.faintness(noise)

    def frame_uncertainty(
        self, frame: np.ndarray, uncertainty: PositionUncertainty
    ) -> FrameUncertainty:
        """Return the uncertainty of the positions on the last frame."""
        noise = None if self._locator is None else self._locator.noise
        return FrameUncertainty(uncertainty, frame, self.background, FrameState(
            (frame.shape[1], frame.shape[0]), math.nan if noise is None else noise,
            self._shifts.deviation_px))

    @property
    def view(self) -> Optional[View]:
        """Result of the last comparison of a frame's view with the background; None for none."""
        return None if self._view is None else self._view.view

    @property
    def reason(self) -> Optional[Reason]:
        """
        Why an object on the surface would not be published now; None if it would.

        A passing reason counts after a second, see :class:`HeldBack`.
        """
        return self._held_back.reason if self._taker is None else self._taker.reason

    def process(self, frame: np.ndarray, taken_at: Optional[float] = None) -> Sighting:
        """
        Find the objects on a frame.

        :param taken_at: Its capture time by time.monotonic(); None for now, and for a source that
            is not live.
        :returns: The objects, and the reason if they may not be published. A frame that cannot be
            used also gives a reason: no frame makes this method raise.
        """
        sighting = self._see(frame, taken_at)
        self._count(sighting)
        self._held_back.note(sighting.warning)
        return sighting

    def _limits_here(self, limits: Limits) -> Limits:
        return limits.for_recording if self._kind.ends else limits

    def _see(self, frame: np.ndarray, taken_at: Optional[float]) -> Sighting:
        # Each step runs the next check; the first reason that a check returns is kept.
        try:
            check_frame(frame)
            reason = self._background_reason(frame)
            if reason is not None:
                return Sighting([], reason)
            locator = self._current_locator()
            check_same_size(frame, self.background)
            reason = self._view.reason(frame)
            there = frame
            if self._detector.method == 'precise':
                frame = self._view.moved_back(frame)
            self._shifts.add(_MOVED_BACK_PX if frame is not there else self._view.shift_px)
            found = locator.find(frame)
        except CameraToBaseError as error:
            return Sighting([], self._frame_reason(error))
        if self._view.is_in_place and self._leaves_out_cut_off():
            found = self._arms.check(frame, found, self._time_of(taken_at), self._view.shift_px)
        seen = Sighting(found.objects, reason, found.left_out)
        return self._gate.judge(seen, taken_at) if self._kind.is_live else seen

    def _time_of(self, taken_at: Optional[float]) -> Optional[float]:
        # Each frame of a recording stands for itself.
        return None if self._kind.ends else time.monotonic() if taken_at is None else taken_at

    def _leaves_out_cut_off(self) -> bool:
        # An arm that reaches in is a cut-off object; it is an object if these are published.
        return self._detector.method == 'precise' and not self._detector.publish_cut_off

    def _background_reason(self, frame: np.ndarray) -> Optional[Reason]:
        if self._taker is None:
            return None
        background = self._taker.add(frame, confirm=self._kind.is_live)
        if background is None:
            return self._taker.reason
        self.background_frame_count = self._taker.taken_count
        self._use_background(background, witness=frame if self._kind.is_live else None)
        return None

    def _frame_reason(self, error: CameraToBaseError) -> Reason:
        if not isinstance(error, FrameSizeError):
            return Reason('frame_unusable', Level.ERROR, f'no position is published: {error}')
        # A new background does not change the picture size of the surface's calibration.
        cure = ', or clear the surface and call ~/capture_background' if self._locator else ''
        return Reason('frame_size', Level.ERROR, f'{error}{cure}')

    def _count(self, sighting: Sighting) -> None:
        self.counts['frames'] += 1
        if sighting.objects:
            self.counts['frames with an object'] += 1
        if sighting.reason is not None:
            self.counts[f'frames held back: {sighting.reason.kind}'] += 1

    def _use_background(
        self, background: np.ndarray, witness: Optional[np.ndarray] = None,
        age_s: float = 0.0, is_restored: bool = False,
    ) -> None:
        self.background, self.background_is_restored = background, is_restored
        self._background_taken_at = time.monotonic() - age_s
        self._view = ViewWatch(background, self._limits, witness)
        self._arms = ArmCheck(background)
        self._held_back, self._shifts = HeldBack(), ShiftMean()
        self._taker = self._locator = None

    def _current_locator(self) -> ObjectLocator:
        if self._locator is None:
            self._locator = ObjectLocator(self.background, self._surface, self._detector)
        return self._locator
