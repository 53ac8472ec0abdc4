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

"""How uncertain the positions on a frame are, computed where it is asked for."""

from typing import NamedTuple, Optional

from camera_to_base.detection import LocatedObject, object_shape
from camera_to_base.uncertainty import (
    FrameState, PositionCovariance, PositionUncertainty, Shape, Spread)
import numpy as np


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

    def in_picture(self, found: LocatedObject) -> Spread:
        """Return the covariance of an object's centre in the picture, the calibration included."""
        return self.uncertainty.pixel_covariance(self._shape(found), self.state)

    def _shape(self, found: LocatedObject) -> Shape:
        return object_shape(found, self.frame, self.background)
