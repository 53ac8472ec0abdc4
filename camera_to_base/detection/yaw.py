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

"""The direction of an object on the work surface."""

from typing import Optional

from camera_to_base.detection.detection import Detection
from camera_to_base.detection.shape import principal_axes
from camera_to_base.errors import HorizonError
from camera_to_base.surface import Surface
import numpy as np

# A coin measures up to 1.02 times longer than wide (20 px, noise 10, tilt 50), plus the percentage
# by which the calibration is off. At this elongation an error of 0.02 turns the axis by 3 degrees.
_LEAST_ELONGATION = 1.2


def object_yaw(
    surface: Surface, detection: Detection, cm_per_px: np.ndarray, least_width: float = 0.0
) -> Optional[float]:
    """
    Return the direction of an object's length.

    An object is small compared with its distance, so its second moments are mapped from the
    picture to the surface with a constant scale.

    :param cm_per_px: The surface's scale at the object, see :class:`OnSurface`.
    :param least_width: The shape of a narrower object is not reliable, in px.
    :returns: About the camera frame's z, from x towards y, in rad, in (-pi/2, pi/2]; None if the
        object is about as wide as long, is too narrow, or has a part that is missing or beyond
        the horizon.
    """
    axes = principal_axes(cm_per_px @ detection.spread @ cm_per_px.T)
    if axes.elongation < _LEAST_ELONGATION or detection.cut_off:
        return None
    if principal_axes(detection.spread).width < least_width or not _seen(surface, detection):
        return None
    return axes.angle


def _seen(surface: Surface, detection: Detection) -> bool:
    try:
        surface.locate(detection.outline)
    except HorizonError:
        return False
    return True
