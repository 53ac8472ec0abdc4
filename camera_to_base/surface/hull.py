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


"""The area of the picture in which a calibration was measured, and its figures hold."""

from typing import Sequence

from camera_to_base.checks import finite_numbers
from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np

# OpenCV computes with float32.
_LIMIT_PX = 1e6


class Hull:
    """
    The convex hull of pixels.

    :param pixels: Shape (n, 2), columns u and v, in px.
    :raises InvalidValueError: If they do not span an area.
    """

    def __init__(self, pixels: np.ndarray) -> None:
        pixels = finite_numbers('hull', pixels, -1, 2)
        if np.abs(pixels).max(initial=0) > _LIMIT_PX:
            raise InvalidValueError(
                f'expected a hull of pixels within {_LIMIT_PX:g} px, got {pixels.tolist()}')
        pixels = pixels.astype(np.float32)
        self._outline = cv2.convexHull(pixels) if len(pixels) else pixels
        self.area = cv2.contourArea(self._outline) if len(pixels) else 0.0
        if not self.area > 0:
            raise InvalidValueError(
                f'expected a hull of at least three pixels that are not on one line, got {pixels}')

    @property
    def corners(self) -> np.ndarray:
        """Corners in the order of the outline, shape (n, 2), in px."""
        return self._outline.reshape(-1, 2).astype(float)

    def contains(self, pixel: Sequence[float]) -> bool:
        """
        Tell whether a pixel lies inside, or on the edge.

        :param pixel: u and v, in px.
        """
        return cv2.pointPolygonTest(self._outline, (float(pixel[0]), float(pixel[1])), False) >= 0
