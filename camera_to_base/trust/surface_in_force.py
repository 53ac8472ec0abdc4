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

"""The surface that the camera's pixels are located with, where that is not the calibrated one."""

from dataclasses import replace
from typing import NamedTuple, Optional

from camera_to_base.detection import DetectorSettings
from camera_to_base.reason import Reason
from camera_to_base.surface import Hull, PictureMap, Surface
from camera_to_base.uncertainty import PositionUncertainty
import numpy as np


class SurfaceInForce(NamedTuple):
    """
    What the pixels of the camera mean, at the place where it stands.

    :param surface: Maps the frame's pixels to the work surface.
    :param covariance: Of a warp of the frame, shape (14, 14), see the room `uncertainty`; None for
        no more than the calibration's own.
    :param reason: Why it is not the calibrated surface; None where it is.
    :param replaces: Whether the covariance is used in place of the calibration's, not added to it.
    :param frame_from_calibrated: Maps the pixels of the calibrated camera to those of the frame;
        None for the same, or where that is not known.
    """

    surface: Surface
    covariance: Optional[np.ndarray] = None
    reason: Optional[Reason] = None
    replaces: bool = False
    frame_from_calibrated: Optional[PictureMap] = None

    def uncertainty(self, calibrated: PositionUncertainty) -> PositionUncertainty:
        """
        Give the uncertainty of positions.

        :param calibrated: That of the calibration.
        """
        if self.covariance is None:
            return calibrated
        covariance = self.covariance + (0 if self.replaces else calibrated.warp_covariance)
        return replace(calibrated, surface=self.surface, warp_covariance=covariance, _places={})

    def detector(self, settings: DetectorSettings) -> DetectorSettings:
        """Give the detector's settings with the area of the calibration where the frame has it."""
        if settings.area is None or self.frame_from_calibrated is None:
            return settings
        return replace(settings, area=self.moved(settings.area))

    def moved(self, hull: Hull) -> Hull:
        """Give an area of the calibrated picture as the frame shows it."""
        if self.frame_from_calibrated is None:
            return hull
        return Hull(self.frame_from_calibrated.pixels(hull.corners))
