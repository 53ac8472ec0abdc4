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

import time
from typing import Optional

from camera_to_base.detection import check_frame, check_same_size, DetectorSettings
from camera_to_base.errors import CameraToBaseError
from camera_to_base.reason import Reason
from camera_to_base.sources import SIMULATED, SourceKind
from camera_to_base.surface import Surface
from camera_to_base.trust.background import Background, BackgroundKeeper
from camera_to_base.trust.frame_uncertainty import FrameUncertainty
from camera_to_base.trust.gate import PositionGate
from camera_to_base.trust.held_back import HeldBack
from camera_to_base.trust.limits import Limits
from camera_to_base.trust.markers.marker_view import MarkerSettings, MarkerView
from camera_to_base.trust.markers.marker_watch import MarkerWatch
from camera_to_base.trust.sighting import FrameCounts, Sighting, unusable_reason
from camera_to_base.trust.standpoint import Standpoint
from camera_to_base.uncertainty import FrameState, PositionUncertainty
import numpy as np


class CameraPipeline:
    """
    Converts each frame to the objects that may be published.

    :param surface: Maps pixels to the work surface.
    :param detector: The detector's settings.
    :param background_frames: The first background is the median of this many frames.
    :param kind: The kind of source. Age and jumps are checked for live sources only, the view
        for all sources but recordings.
    :param markers: The markers on the surface; None for none.

    `backgrounds` knows the background in use and takes new ones, `standpoint` knows what the
    pixels of the last frame mean and how the camera was nudged, and `counts` counts the frames.
    """

    def __init__(
        self,
        surface: Surface,
        detector: DetectorSettings = DetectorSettings(),
        limits: Limits = Limits(),
        background_frames: int = 1,
        kind: SourceKind = SIMULATED,
        markers: Optional[MarkerSettings] = None,
    ) -> None:
        self._kind = kind
        self._gate = PositionGate(limits.max_frame_age_s, limits.confirm_jump_px)
        self._held_back = HeldBack()
        self.counts = FrameCounts()
        self._detector, self._limits = detector, self._limits_here(limits)
        self.backgrounds = BackgroundKeeper(confirm=kind.is_live)
        self.standpoint = Standpoint(surface, self._limits)
        self._markers = MarkerWatch(markers) if markers is not None else None
        self.capture_background(background_frames)

    def configure(
        self, surface: Surface, detector: DetectorSettings, limits: Limits,
        markers: Optional[MarkerSettings] = None,
    ) -> None:
        """
        Use new settings from the next frame on, with the same background.

        Parts whose settings have not changed keep their state, so that no frame is held back.
        """
        if detector != self._detector:
            self._detector = detector
            if self.standpoint.scene is not None:
                self.standpoint.scene.forget_objects()
        self._limits = self._limits_here(limits)
        self._gate.configure(self._limits.max_frame_age_s, self._limits.confirm_jump_px)
        self.standpoint.configure(surface, self._limits)
        if self.backgrounds.current is not None:
            self.backgrounds.use(self.standpoint.background)
        if markers is None or self._markers is None:
            self._markers = MarkerWatch(markers) if markers is not None else None
        else:
            self._markers.configure(markers)

    def capture_background(self, frame_count: int) -> None:
        """
        Take a new background from the next frames; until then no objects are found.

        Fewer frames are taken if they would need too much memory, see :class:`BackgroundTaker`;
        `backgrounds.frame_count` is their number.
        """
        self.backgrounds.take(frame_count)

    def restore_background(
        self, background: np.ndarray, age_s: float, may_correct: bool = True,
        unknown: Optional[np.ndarray] = None,
    ) -> None:
        """
        Use a saved background; the first frame's view is compared with it.

        :param background: Shape (h, w, 3), uint8, BGR.
        :param age_s: Its age.
        :param may_correct: Whether the camera stood for it where it was calibrated.
        :param unknown: What it does not show, shape (h, w), uint8, 255 there; None for nothing.
        """
        restored = Background(
            background, time.monotonic() - age_s, is_restored=True, unknown=unknown)
        self.backgrounds.use(restored)
        self._use_background(restored, may_correct)

    @property
    def background(self) -> Optional[np.ndarray]:
        """The background as it was taken, shape (h, w, 3); None while one is taken."""
        current = self.backgrounds.current
        return None if current is None else current.picture

    @property
    def doubt(self) -> Optional[Reason]:
        """Why positions are published with a warning: other surface, moved marker; or None."""
        marker_doubt = None if self._markers is None else self._markers.doubt
        return marker_doubt or self.standpoint.surface.reason

    @property
    def faintness(self) -> Optional[str]:
        """Say how faint an object may be with the noise of the frames; None for not known."""
        noise = None if self.standpoint.scene is None else self.standpoint.scene.noise
        return None if noise is None else self._detector.faintness(noise)

    def frame_uncertainty(
        self, frame: np.ndarray, uncertainty: PositionUncertainty
    ) -> FrameUncertainty:
        """Return that of the positions on the last frame; `uncertainty` is the calibration's."""
        if self.standpoint.scene is not None:
            return self.standpoint.scene.frame_uncertainty(frame, uncertainty)
        return FrameUncertainty(uncertainty, frame, None, FrameState(frame.shape[1::-1]))

    @property
    def reason(self) -> Optional[Reason]:
        """
        Why an object on the surface would not be published now; None if it would.

        A passing reason counts after a second, see :class:`HeldBack`.
        """
        return self.backgrounds.reason or self._held_back.reason

    def process(self, frame: np.ndarray, taken_at: Optional[float] = None) -> Sighting:
        """
        Find the objects on a frame.

        :param taken_at: Its capture time by time.monotonic(); None for now, and for a source that
            is not live.
        :returns: The objects, and the reason if they may not be published. A frame that cannot be
            used also gives a reason: no frame makes this method raise.
        """
        sighting = self._by_markers(frame, self._see(frame, taken_at), taken_at)
        self.counts.add(sighting)
        self._held_back.note(sighting.warning)
        return sighting

    def _limits_here(self, limits: Limits) -> Limits:
        return limits.for_recording if self._kind.ends else limits

    def _see(self, frame: np.ndarray, taken_at: Optional[float]) -> Sighting:
        # Each step runs the next check; the first reason that a check returns is kept.
        try:
            check_frame(frame)
            now = self._time_of(taken_at)
            reason = self._background_reason(frame, now)
            if reason is not None:
                return Sighting([], reason)
            self.standpoint.scene.prepare(self._detector)
            check_same_size(frame, self.background)
            reason = self.standpoint.reason(frame, now)
            if reason is not None:
                return Sighting([], reason)
            found = self.standpoint.scene.find(frame, self._detector, now)
        except CameraToBaseError as error:
            # A new background does not change the picture size of the surface's calibration.
            may_retake = self.standpoint.scene is not None and self.standpoint.scene.is_prepared
            return Sighting([], unusable_reason(error, may_retake))
        seen = Sighting(found.objects, left_out=found.left_out)
        return self._gate.judge(seen, taken_at) if self._kind.is_live else seen

    def _by_markers(
        self, frame: np.ndarray, sighting: Sighting, taken_at: Optional[float]
    ) -> Sighting:
        background = self.backgrounds.current
        if self._markers is None or background is None:
            return sighting
        now = time.monotonic() if taken_at is None else taken_at
        scene = self.standpoint.scene
        step = self._markers.step(frame, sighting, MarkerView(
            background, scene.background, self.standpoint.surface,
            self.standpoint.correction is not None, scene.view.shift_px), now)
        if step.surface is not None:
            self.standpoint.stand_at(step.surface)
        if step.retakes:
            self.capture_background(self._markers.background_frames)
        return step.sighting

    def _time_of(self, taken_at: Optional[float]) -> Optional[float]:
        # Each frame of a recording stands for itself.
        return None if self._kind.ends else time.monotonic() if taken_at is None else taken_at

    def _background_reason(self, frame: np.ndarray, now: Optional[float]) -> Optional[Reason]:
        if self.backgrounds.current is None:
            taken = self.backgrounds.add(frame, now)
            if taken is not None:
                self._use_background(taken)
        return self.backgrounds.reason

    def _use_background(self, background: Background, may_correct: bool = True) -> None:
        self.standpoint.use_background(background, may_correct)
        self._held_back = HeldBack()
