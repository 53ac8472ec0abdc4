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

"""Draws how uncertain positions are: an ellipse that contains 95 % of all errors."""

from typing import Iterable, Tuple

from camera_to_base.detection import Pixel
from camera_to_base.drawing.labels import line_width
from camera_to_base.uncertainty import error_ellipse, Spread
import cv2
import numpy as np

_SHARE = 0.95
_COLOUR = (0, 140, 255)
# A smaller ellipse lies within the mark of the centre.
_SMALLEST_PX = 1.0
# OpenCV draws with a resolution of 1 / 2^4 px.
_SHIFT = 4


def draw_ellipses(picture: np.ndarray, centres: Iterable[Tuple[Pixel, Spread]]) -> None:
    """
    Draw the ellipses of centres that are larger than a pixel.

    :param picture: Shape (h, w, 3), uint8, BGR; it is drawn on.
    :param centres: With their covariances, in px².
    """
    largest = float(np.hypot(*picture.shape[:2]))
    for (u, v), (uu, uv, vv) in centres:
        ellipse = error_ellipse(np.array([[uu, uv], [uv, vv]]), _SHARE)
        if not _SMALLEST_PX < ellipse.long < largest:
            continue
        centre, axes = (tuple(round(value * 2 ** _SHIFT) for value in pair)
                        for pair in ((u, v), (ellipse.long, ellipse.short)))
        cv2.ellipse(picture, centre, axes, np.degrees(ellipse.angle), 0, 360, _COLOUR,
                    line_width(picture), cv2.LINE_AA, _SHIFT)
