# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The stages that prepare and find the objects, and how uncertain their positions are."""

from dataclasses import replace
import math
from typing import Callable, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.checks import check_same_size
from camera_to_base.detection import DetectorSettings, LocatedObject, object_shape, ObjectLocator
from camera_to_base.errors import Level, Reason
from camera_to_base.pipeline.place import SurfaceInForce
from camera_to_base.pipeline.stage import FrameRecord, Stage
from camera_to_base.pipeline.standpoint import PerBackground, Standpoint
from camera_to_base.uncertainty import (
    FrameState, PositionCovariance, PositionUncertainty, Shape, ShiftMean, Spread)
import numpy as np

# By how much a frame that was moved back may still be off, see the benchmark of the view.
_MOVED_BACK_PX = 0.1


class FrameUncertainty(NamedTuple):
    """
    The uncertainty of the positions on a frame.

    :param uncertainty: Made of the parameters.
    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape; None where there is none.
    :param state: What the frame tells beside its objects.
    """

    uncertainty: PositionUncertainty
    frame: np.ndarray
    background: Optional[np.ndarray]
    state: FrameState

    def of(self, found: LocatedObject) -> PositionCovariance:
        """Return the covariance of an object's position, in the camera frame."""
        return self.uncertainty.covariance(self._shape(found), self.state)

    @property
    def camera_covariance(self) -> np.ndarray:
        """The covariance of the camera's foot point and height: shape (3, 3), in cm²."""
        return self.uncertainty.place_covariance

    def of_silhouette(self, found: LocatedObject) -> PositionCovariance:
        """Return how far an object's silhouette may be off as a whole, whatever its height is."""
        flat = replace(self.uncertainty, height_tolerance_cm=0.0)
        shape = self._shape(found)._replace(height_cm=0.0, misfit_cm=0.0)
        return flat.covariance(shape, self.state)

    def in_picture(self, found: LocatedObject) -> Spread:
        """Return the covariance of an object's centre in the picture, the calibration included."""
        return self.uncertainty.pixel_covariance(self._shape(found), self.state)

    def _shape(self, found: LocatedObject) -> Shape:
        return object_shape(found, self.frame, self.background)


class SizeCheck(Stage):
    """
    Whether the frame, the background and the calibration have one picture size.

    :param prepare: Prepares the detection for a standpoint; raises where that cannot be done.
    """

    def __init__(self, prepare: Callable[[Standpoint], None]) -> None:
        self._prepare = prepare

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Check the sizes; where they differ, an error says which."""
        self._prepare(record.standpoint)
        check_same_size(record.frame, record.standpoint.background.picture)
        return record


class DetectionStage(Stage):
    """
    Finds the objects on a frame.

    `doubt` is why objects of the last frame are published with a warning, or None.

    :param settings: The detector's settings.
    """

    def __init__(self, settings: DetectorSettings) -> None:
        self._settings = settings
        self._standpoint: Optional[Standpoint] = None
        self._locator: Optional[ObjectLocator] = None
        self.doubt: Optional[Reason] = None
        # Sum up what of the view's motion is not corrected.
        self._shifts: PerBackground[ShiftMean] = PerBackground(lambda _: ShiftMean())
        self._uncertainty: Optional[
            Tuple[PositionUncertainty, SurfaceInForce, PositionUncertainty]] = None

    def configure(self, settings: DetectorSettings) -> None:
        """Use other settings from the next frame on."""
        if settings != self._settings:
            self._settings, self._locator = settings, None

    def prepare(self, standpoint: Standpoint) -> None:
        """
        Make the detector for a standpoint, where there is none.

        :raises FrameSizeError: If the surface was calibrated for another picture size.
        :raises InvalidValueError: If the background cannot be used.
        """
        if self.is_prepared(standpoint):
            return
        self._locator, self._standpoint = None, standpoint
        self._shifts.keep(standpoint)
        surface = standpoint.surface
        self._locator = ObjectLocator(
            standpoint.background.picture, surface.surface, surface.detector(self._settings))

    def is_prepared(self, standpoint: Standpoint) -> bool:
        """Return whether there is a detector for a standpoint."""
        return self._locator is not None and self._standpoint is standpoint

    def faintness(self, standpoint: Standpoint) -> Optional[str]:
        """Say how faint an object may be with the noise of the frames; None for not known."""
        noise = self._noise(standpoint)
        return None if noise is None else self._settings.faintness(noise)

    def frame_uncertainty(
        self, frame: np.ndarray, standpoint: Standpoint, calibrated: PositionUncertainty
    ) -> FrameUncertainty:
        """
        Give the uncertainty of the positions on the last frame, by the surface in force.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param calibrated: That of the calibration.
        """
        size = frame.shape[1], frame.shape[0]
        if standpoint.background is None:
            return FrameUncertainty(calibrated, frame, None, FrameState(size))
        noise = self._noise(standpoint)
        return FrameUncertainty(
            self._uncertainty_by(standpoint.surface, calibrated), frame,
            standpoint.background.picture, FrameState(
                size, math.nan if noise is None else noise,
                self._shifts.of(standpoint.background).deviation_px))

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Find the objects."""
        standpoint, motion, frame = record.standpoint, record.motion, record.frame
        self.prepare(standpoint)
        if self._settings.method == 'precise':
            frame = motion.moved_back(frame)
        self._shifts.of(standpoint.background).add(
            _MOVED_BACK_PX if frame is not record.frame else motion.shift_px)
        found = standpoint.background.without_unknown(self._locator.find(frame))
        self.doubt = _doubt(found.objects, self._settings)
        return record._replace(aligned=frame, objects=found.objects, left_out=found.left_out)

    def _noise(self, standpoint: Standpoint) -> Optional[float]:
        return self._locator.noise if self.is_prepared(standpoint) else None

    def _uncertainty_by(
        self, surface: SurfaceInForce, calibrated: PositionUncertainty
    ) -> PositionUncertainty:
        known = self._uncertainty
        if known is None or known[0] is not calibrated or known[1] is not surface:
            known = self._uncertainty = calibrated, surface, surface.uncertainty(calibrated)
        return known[2]


def _doubt(objects: Sequence[LocatedObject], settings: DetectorSettings) -> Optional[Reason]:
    pixels = [one.detection.centre for one in objects if one.detection.may_be_light]
    if not pixels or settings.light_or_thing == 'publish':
        return None
    return Reason(
        'may_be_light', Level.WARN,
        f'an object at ({pixels[0].u:.0f}, {pixels[0].v:.0f}) px may be light or shade: neither '
        'it nor the surface has a colour or a texture, so that only its sharp edge tells; use a '
        'surface of another colour, or set detector.light_or_thing to leave_out_all, or to '
        'publish if it is an object', is_passing=True)
