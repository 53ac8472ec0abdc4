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
"""The markers that a picture of the work surface shows, with exact corners."""

from typing import Collection, Dict, NamedTuple, Optional

from camera_to_base.markers.aruco import search_markers
from camera_to_base.markers.edges import corners_by_edges
from camera_to_base.surface import RadialDistortion
import cv2
import numpy as np

# The numbers of markers that may lie on a table: a ChArUco board has those from 10 on.
TABLE_MARKERS = range(10)


class SeenMarkers(NamedTuple):
    """
    Markers in a picture.

    :param corners: By the marker's number, shape (4, 2), u and v, in px, as it is printed from
        the top left clockwise.
    """

    corners: Dict[int, np.ndarray]


def see_markers(
    image: np.ndarray, lens: RadialDistortion, expected: Optional[Collection[int]] = None
) -> SeenMarkers:
    """
    Find the markers of a table.

    :param image: Shape (h, w, 3), uint8, BGR.
    :param lens: Of the camera; edges are straight without its distortion.
    :param expected: If all of these are found soon, no others are searched for; None for all.
    :raises CalibrationError: If OpenCV has no module aruco.
    """
    grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    refined = {number: corners_by_edges(grey, corners, lens)
               for number, corners in search_markers(grey, expected).items()
               if number in TABLE_MARKERS}
    return SeenMarkers({number: corners for number, corners in refined.items()
                        if corners is not None})
