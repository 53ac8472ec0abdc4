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

"""What a frame tells about how well an object's centre is known."""

import math
from typing import Optional

from camera_to_base.detection.detection import Box, Detection
from camera_to_base.detection.locator import LocatedObject
from camera_to_base.uncertainty import Shape, Spread
import cv2
import numpy as np

# In a larger box the noise of the rim moves the centre by next to nothing.
_LARGEST_BOX_PX = 40000
_MARGIN_PX = 2


def object_shape(
    found: LocatedObject, frame: np.ndarray, background: Optional[np.ndarray]
) -> Shape:
    """
    Return what the uncertainty of an object needs.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape; None where there is none.
    """
    detection = found.detection
    moments = detection.moments or cv2.moments(detection.outline)
    area = moments['m00'] or 1.0
    contrast, edge_width = math.nan, 1.0
    box = detection.box
    if background is not None and background.shape == frame.shape and (
            box.width * box.height <= _LARGEST_BOX_PX):
        contrast, edge_width = _contrast_and_edge(frame, background, detection)
    return Shape(
        detection.centre, max(detection.area, 1.0),
        Spread(moments['mu20'] / area, moments['mu11'] / area, moments['mu02'] / area),
        contrast, edge_width, detection.cut_off, found.yaw is not None)


def _contrast_and_edge(frame: np.ndarray, background: np.ndarray, detection: Detection):
    """Return the mean difference to the background, and over how many px it comes about."""
    part = _grown(detection.box)
    seen, table = frame[part], background[part]
    change = cv2.absdiff(seen, table)
    contrast = sum(cv2.sumElems(change)) / 3 / max(detection.area, 1.0)
    # Differences of the next but one pixels.
    steepest = max(cv2.norm(cv2.Sobel(change, cv2.CV_16S, 1, 0, ksize=1), cv2.NORM_INF),
                   cv2.norm(cv2.Sobel(change, cv2.CV_16S, 0, 1, ksize=1), cv2.NORM_INF)) / 2
    return contrast, max(1.0, contrast / max(steepest, 1.0))


def _grown(box: Box) -> tuple:
    return (slice(max(box.y - _MARGIN_PX, 0), box.y + box.height + _MARGIN_PX),
            slice(max(box.x - _MARGIN_PX, 0), box.x + box.width + _MARGIN_PX))
