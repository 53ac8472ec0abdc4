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

"""Draws the areas in which objects count, or do not."""

from typing import List, Optional

from camera_to_base.detection import Area, Areas
from camera_to_base.errors import HorizonError
from camera_to_base.surface import Surface
import cv2
import numpy as np

_WORK_COLOUR, _IGNORED_COLOUR = (60, 180, 60), (60, 60, 200)
# The areas' outlines are found on a grid of places, in px, and smoothly between them.
_STEP = 8


class AreaOverlay:
    """
    Draws areas on frames; their outlines are computed once for each picture size.

    :param surface: Maps pixels to the work surface.
    """

    def __init__(self, surface: Surface, areas: Areas) -> None:
        self._surface, self._areas = surface, areas
        self._size: Optional[tuple] = None

    def use_surface(self, surface: Surface) -> None:
        """Draw the areas where the pixels of another surface show them, from now on."""
        if surface is not self._surface:
            self._surface, self._size = surface, None

    def draw(self, picture: np.ndarray) -> None:
        """Draw the areas' outlines on a picture of shape (h, w, 3), uint8, in place."""
        if self._areas == Areas():
            return
        if self._size != picture.shape[:2]:
            self._size = height, width = picture.shape[:2]
            self._located = self._surface.for_image_size((width, height))
            self._work = self._outlines([self._areas.work] if self._areas.work else [])
            self._ignored = self._outlines(list(self._areas.ignored))
        cv2.drawContours(picture, self._work, -1, _WORK_COLOUR, 2)
        cv2.drawContours(picture, self._ignored, -1, _IGNORED_COLOUR, 2)

    def _outlines(self, areas: List[Area]) -> List[np.ndarray]:
        height, width = self._size
        rows, columns = (np.linspace(0, length - 1, max(length // _STEP, 2))
                         for length in (height, width))
        points = [self._points(row, columns) for row in rows]
        outlines: List[np.ndarray] = []
        for area in areas:
            depths = np.array([[area.depth(point) for point in line] for line in points])
            depths = cv2.resize(depths.astype(np.float32), (width, height))
            found, _ = cv2.findContours(
                (depths > 0).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
            outlines.extend(found)
        return outlines

    def _points(self, row: float, columns: np.ndarray) -> np.ndarray:
        # What lies beyond the horizon is far away from every area.
        try:
            return self._located.locate(np.column_stack([columns, np.full(len(columns), row)]))
        except HorizonError:
            return np.full((len(columns), 2), 1e6)
