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
"""Whether the picture stands still: no hand passes, and the camera is at rest."""

from typing import Optional

from camera_to_base.markers import Corners, LEAST_MARKERS
import cv2
import numpy as np

# Of the small picture: the mean of a block has little noise.
_SIZE = (64, 48)
# What noise and flicker do to the mean of a block, in grey levels.
_LARGEST_CHANGE = 8.0
# Corners at rest are seen to 0.02 to 0.1 px from frame to frame, see
# `calibration.markers.learning`.
_LARGEST_MOVE_PX = 0.5


class Stillness:
    """Measures how long the markers, and the picture in blocks, have not changed."""

    def __init__(self) -> None:
        self._blocks: Optional[np.ndarray] = None
        self._seen: Corners = {}
        self._since = 0.0

    def duration(self, frame: np.ndarray, seen: Corners, now: float) -> float:
        """
        Return for how long nothing has changed, in s.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param seen: Its markers, by number, shape (4, 2), in px.
        :param now: Its time, in s.
        """
        blocks = cv2.resize(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY), _SIZE,
                            interpolation=cv2.INTER_AREA).astype(np.float32)
        if not self._is_same(blocks, seen):
            self._blocks, self._seen, self._since = blocks, seen, now
        return now - self._since

    def _is_same(self, blocks: np.ndarray, seen: Corners) -> bool:
        both = set(seen) & set(self._seen)
        return (self._blocks is not None and len(both) >= LEAST_MARKERS and float(
            np.abs(blocks - self._blocks).max()) <= _LARGEST_CHANGE and all(
                np.abs(seen[number] - self._seen[number]).max() <= _LARGEST_MOVE_PX
                for number in both))
