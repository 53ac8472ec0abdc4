# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""From frames to objects that may be published: the stages, in order."""

import time
from typing import Optional, Tuple

from camera_to_base.detection import DetectorSettings, median_of
from camera_to_base.errors import CameraToBaseError, Reason
from camera_to_base.pipeline.arms import ArmStage
from camera_to_base.pipeline.background import BackgroundKeeper
from camera_to_base.pipeline.damage import DamageCheck, FrameCheck
from camera_to_base.pipeline.detection_stage import DetectionStage, FrameUncertainty, SizeCheck
from camera_to_base.pipeline.gate import PositionGate
from camera_to_base.pipeline.in_place import InPlaceStage
from camera_to_base.pipeline.markers import MarkerSettings, MarkerWatch
from camera_to_base.pipeline.own_camera import OwnCamera
from camera_to_base.pipeline.sighting import (
    FrameCounts, HeldBack, Limits, Sighting, unusable_reason)
from camera_to_base.pipeline.stage import FrameRecord, Stage
from camera_to_base.pipeline.standpoint import Background, Standpoint
from camera_to_base.pipeline.surroundings import SurroundingsStage
from camera_to_base.pipeline.view.view_check import View
from camera_to_base.pipeline.view.view_stage import ViewStage
from camera_to_base.sources import SIMULATED, SourceKind
from camera_to_base.surface import Surface
from camera_to_base.uncertainty import PositionUncertainty
import numpy as np


class CameraPipeline:
    """
    Converts each frame to the objects that may be published.

    :param surface: Maps pixels to the work surface.
    :param detector: The detector's settings.
    :param background_frames: The first background is the median of this many frames.
    :param kind: The kind of source. Age and jumps are checked for live sources only.
    :param markers: The markers on the surface; None for none.
    :param own_camera: Compares the camera with the one that was calibrated.
    :param damage: Finds damaged frames; None where a reader does that, see :class:`FrameCheck`.

    `backgrounds` knows the background in use and takes new ones, `standpoint` is where the camera
    stood for the last frame, and `counts` counts the frames.
    """

    def __init__(
        self,
        surface: Surface,
        detector: DetectorSettings = DetectorSettings(),
        limits: Limits = Limits(),
        background_frames: int = 1,
        kind: SourceKind = SIMULATED,
        markers: Optional[MarkerSettings] = None,
        own_camera: Optional[OwnCamera] = None,
        damage: Optional[DamageCheck] = None,
    ) -> None:
        self._kind = kind
        self._held_back = HeldBack()
        self.counts = FrameCounts()
        self.standpoint = Standpoint.as_calibrated(surface)
        self._damage = FrameCheck(damage)
        self.backgrounds = BackgroundKeeper(confirm=kind.is_live)
        # How much of a recording is compared must not depend on the computer's speed.
        self._view = ViewStage(limits, is_paced=not kind.ends)
        self._detection = DetectionStage(detector)
        self._sizes = SizeCheck(self._detection.prepare)
        self._arms = ArmStage(detector)
        self._surroundings, self._in_place = SurroundingsStage(), InPlaceStage()
        self._gate = PositionGate(limits.max_frame_age_s, limits.confirm_jump_px)
        self._markers = MarkerWatch(markers)
        self._own_camera = own_camera or OwnCamera()
        self.capture_background(background_frames)

    def configure(
        self, surface: Surface, detector: DetectorSettings, limits: Limits,
        markers: Optional[MarkerSettings] = None, own_camera: Optional[OwnCamera] = None,
    ) -> None:
        """
        Use new settings from the next frame on, with the same background.

        Parts whose settings have not changed keep their state, so that no frame is held back.

        :param own_camera: None for the one before.
        """
        self._detection.configure(detector)
        self._arms.configure(detector)
        self._gate.configure(limits.max_frame_age_s, limits.confirm_jump_px)
        self.standpoint = self.standpoint.recalibrated(
            surface, is_held_back=self._view.reason is not None)
        self._view.configure(limits)
        if not limits.may_correct:
            self.standpoint = self.standpoint.without_correction()
        if self.backgrounds.current is not None:
            self.backgrounds.use(self.standpoint.taken)
        self._markers.configure(markers)
        self._own_camera = own_camera or self._own_camera

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
        self._use_background(restored, may_correct)

    def use_background(self, *frames: np.ndarray) -> None:
        """
        Use frames of the empty surface as the background, from the next frame on.

        :param frames: Each of shape (h, w, 3), uint8, BGR; their median is the background.
        :raises InvalidValueError: If there is none, or one of them is no such frame.
        """
        self._use_background(Background(
            median_of(frames), time.monotonic(), frames[-1] if len(frames) > 1 else None))

    @property
    def background(self) -> Optional[np.ndarray]:
        """The background as it was taken, shape (h, w, 3); None while one is taken."""
        current = self.backgrounds.current
        return None if current is None else current.picture

    @property
    def view(self) -> Optional[View]:
        """Result of the last comparison of a frame's view with the background; None for none."""
        return self._view.view(self.standpoint)

    @property
    def doubt(self) -> Optional[Reason]:
        """Why positions are published with a warning: another camera, a nudge...; or None."""
        return (self._own_reason(is_strict=False) or self._markers.doubt
                or self.standpoint.surface.reason or self._in_place.doubt
                or self._arms.doubt(self.standpoint) or self._detection.doubt
                or self._surroundings.doubt(self.standpoint))

    @property
    def faintness(self) -> Optional[str]:
        """Say how faint an object may be with the noise of the frames; None for not known."""
        return self._detection.faintness(self.standpoint)

    def frame_uncertainty(
        self, frame: np.ndarray, uncertainty: PositionUncertainty
    ) -> FrameUncertainty:
        """Return that of the positions on the last frame; `uncertainty` is the calibration's."""
        return self._detection.frame_uncertainty(frame, self.standpoint, uncertainty)

    @property
    def reason(self) -> Optional[Reason]:
        """
        Why an object on the surface would not be published now; None if it would.

        A passing reason counts after a second, see :class:`HeldBack`.
        """
        return (self.backgrounds.reason or self._own_reason(is_strict=True)
                or self._held_back.reason)

    def process(self, frame: np.ndarray, taken_at: Optional[float] = None) -> Sighting:
        """
        Find the objects on a frame.

        :param taken_at: Its capture time by time.monotonic(), or by the clock of a recording, in
            s; None for now, and for a picture that stands for itself.
        :returns: The objects, and the reason if they may not be published. A frame that cannot be
            used also gives a reason: no frame makes this method raise.
        """
        record = FrameRecord(frame, self.standpoint, taken_at, self._time_of(taken_at))
        for stage in self._stages:
            if record.reason is None or stage.sees_held_back:
                try:
                    record = stage.judge(record)
                except CameraToBaseError as error:
                    record = record.held(self._unusable(error, record.standpoint))
        self._stand_at(record.standpoint)
        if record.retaken:
            self.capture_background(record.retaken)
        sighting = record.sighting
        self.counts.add(sighting)
        self._held_back.note(sighting.warning)
        return sighting

    @property
    def _stages(self) -> Tuple[Stage, ...]:
        # Frames of a recording do not age, and are not damaged.
        gate = (self._gate,) if self._kind.is_live else ()
        return (self._damage, self.backgrounds, self._sizes, self._view, self._detection,
                self._in_place, self._arms, self._surroundings, *gate, self._markers,
                self._own_camera)

    def _unusable(self, error: CameraToBaseError, standpoint: Standpoint) -> Reason:
        # A new background does not change the picture size of the surface's calibration.
        return unusable_reason(error, may_retake=self._detection.is_prepared(standpoint))

    def _own_reason(self, is_strict: bool) -> Optional[Reason]:
        # Frame by frame it may be hidden behind a reason that passes.
        own = self._own_camera
        return own.reason(self.background) if own.is_strict == is_strict else None

    def _time_of(self, taken_at: Optional[float]) -> Optional[float]:
        # A frame of a recording without a time stands for itself.
        return time.monotonic() if taken_at is None and not self._kind.ends else taken_at

    def _use_background(self, background: Background, may_correct: bool = True) -> None:
        self.backgrounds.use(background)
        self._stand_at(self.standpoint.with_background(background, may_correct))

    def _stand_at(self, standpoint: Standpoint) -> None:
        if standpoint.taken is not self.standpoint.taken:
            self._held_back = HeldBack()
        self.standpoint = standpoint
