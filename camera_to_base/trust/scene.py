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

"""What the frames of a camera are compared with as long as it stands in one place."""

import math
from typing import Optional, Tuple

from camera_to_base.detection import DetectorSettings, Found, ObjectLocator
from camera_to_base.trust.arms.arm_check import ArmCheck
from camera_to_base.trust.correction.seen_background import SeenBackground
from camera_to_base.trust.frame_uncertainty import FrameUncertainty
from camera_to_base.trust.limits import Limits
from camera_to_base.trust.surface_in_force import SurfaceInForce
from camera_to_base.trust.view.view_watch import ViewWatch
from camera_to_base.uncertainty import FrameState, PositionUncertainty, ShiftMean
import numpy as np

# By how much a frame that was moved back may still be off, see the benchmark of the view.
_MOVED_BACK_PX = 0.1


class Scene:
    """
    The background as the camera sees it, and what is known of the frames since then.

    :param background: The background as the camera sees it.
    :param surface: Maps the camera's pixels to the work surface.
    :param limits: Of the view.

    `view` compares frames with the background, and `shifts` sums up what is not corrected.
    """

    def __init__(
        self, background: SeenBackground, surface: SurfaceInForce, limits: Limits
    ) -> None:
        self.background, self.surface = background, surface
        self.view = ViewWatch(background.picture, limits, background.witness)
        self.shifts = ShiftMean()
        self._arms = ArmCheck(background.picture, background.unknown)
        self._locator: Optional[ObjectLocator] = None
        self._uncertainty: Optional[Tuple[PositionUncertainty, PositionUncertainty]] = None

    @property
    def noise(self) -> Optional[float]:
        """The noise of a frame, in grey levels; None where it is not known."""
        return None if self._locator is None else self._locator.noise

    def use_surface(self, surface: SurfaceInForce) -> None:
        """Use another surface from the next frame on, with the same background."""
        self.surface, self._uncertainty = surface, None
        self.forget_objects()

    def forget_objects(self) -> None:
        """Forget which objects are known: their positions were those of other settings."""
        self._locator = None
        self._arms.forget_objects()

    def remember_arms(self, before: 'Scene') -> None:
        """Remember where something has reached in, before the camera was nudged."""
        self._arms.remember(before._arms)

    def frame_uncertainty(
        self, frame: np.ndarray, calibrated: PositionUncertainty
    ) -> FrameUncertainty:
        """
        Give the uncertainty of the positions on the last frame, by the surface in force.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param calibrated: That of the calibration.
        """
        noise = math.nan if self.noise is None else self.noise
        return FrameUncertainty(
            self._uncertainty_here(calibrated), frame, self.background.picture,
            FrameState((frame.shape[1], frame.shape[0]), noise, self.shifts.deviation_px))

    def _uncertainty_here(self, calibrated: PositionUncertainty) -> PositionUncertainty:
        if self._uncertainty is None or self._uncertainty[0] is not calibrated:
            self._uncertainty = calibrated, self.surface.uncertainty(calibrated)
        return self._uncertainty[1]

    @property
    def is_prepared(self) -> bool:
        """Whether the surface holds for the background's size, as far as that was asked."""
        return self._locator is not None

    def prepare(self, settings: DetectorSettings) -> None:
        """
        Make the detector, where there is none.

        :raises FrameSizeError: If the surface was calibrated for another picture size.
        """
        if self._locator is None:
            self._locator = ObjectLocator(
                self.background.picture, self.surface.surface, self.surface.detector(settings))

    def find(
        self, frame: np.ndarray, settings: DetectorSettings, taken_at: Optional[float]
    ) -> Found:
        """
        Find the objects on a frame.

        :param frame: The frame that `view` was asked of last.
        :param taken_at: In s; None for a recording, of which each frame stands for itself.
        """
        self.prepare(settings)
        there = frame
        if settings.method == 'precise':
            frame = self.view.moved_back(frame)
        self.shifts.add(_MOVED_BACK_PX if frame is not there else self.view.shift_px)
        found = self.background.without_unknown(self._locator.find(frame))
        if self.view.is_in_place and _leaves_out_cut_off(settings):
            found = self._arms.check(frame, found, taken_at, self.view.shift_px)
        return found


def _leaves_out_cut_off(settings: DetectorSettings) -> bool:
    # An arm that reaches in is a cut-off object; it is an object if these are published.
    return settings.method == 'precise' and not settings.publish_cut_off
