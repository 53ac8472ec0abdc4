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
"""Objects that are markers: they are never published, wherever they lie."""

import math
from typing import List, Sequence, Tuple

from camera_to_base.detection import Area, LeftOut, LocatedObject, Pixel
from camera_to_base.markers import Corners, paper_corners
from camera_to_base.reason import Level, Reason
import cv2
import numpy as np

_ON_MARKER = Reason('on_marker', Level.OK, 'it lies on a marker', is_passing=True)
# Of a marker's own area in the picture.
_LEAST_SHARE, _LARGEST_SHARE = 0.3, 4.0
# An object closer than this to a place of the last look is the one that was there, in px.
_SAME_PX = 5.0


class MarkerPlaces:
    """
    Where the last look has seen markers.

    :param seen: By number, shape (4, 2), in px.
    """

    def __init__(self, seen: Corners) -> None:
        self._areas: List[Area] = [Area(paper_corners(corners)) for corners in seen.values()]
        self._marker_px2 = max(
            (cv2.contourArea(corners.astype(np.float32)) for corners in seen.values()),
            default=0.0)
        self._noted: List[Pixel] = []

    def note(self, objects: Sequence[LocatedObject]) -> None:
        """Remember the objects of the frame that was looked at."""
        self._noted = [found.detection.centre for found in objects]

    def has_new(self, objects: Sequence[LocatedObject]) -> bool:
        """Return whether an object about as large as a marker was not there at the last look."""
        return any(
            _LEAST_SHARE * self._marker_px2 < found.detection.area
            < _LARGEST_SHARE * self._marker_px2
            and not any(math.dist(found.detection.centre, noted) < _SAME_PX
                        for noted in self._noted) for found in objects)

    def split(
        self, objects: Sequence[LocatedObject]
    ) -> Tuple[List[LocatedObject], Tuple[LeftOut, ...]]:
        """Divide objects into those that are none of the markers, and the markers."""
        others, markers = [], []
        for found in objects:
            is_marker = any(area.contains(found.detection.centre) for area in self._areas)
            (markers if is_marker else others).append(found)
        return others, tuple(LeftOut(found.detection, _ON_MARKER) for found in markers)
