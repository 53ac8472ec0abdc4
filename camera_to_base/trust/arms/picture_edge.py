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

"""Looks at a picture's edge: most frames differ from the background nowhere there."""

from typing import Iterable, List, Sequence

from camera_to_base.trust.arms.cells import CellBackground, Cells, Light, medians
import cv2
import numpy as np

# Pixels that tell the light, along the picture's longer side.
_LIGHT_SAMPLES = 20


class PictureEdge:
    """
    Tells whether a frame differs from the background near its edge.

    :param picture: The background, shape (h, w, 3), uint8, BGR.
    :param cells: Its cells; `background` is its content.
    :param depth: How many cells from the edge count.
    """

    def __init__(
        self, picture: np.ndarray, cells: Cells, background: CellBackground, depth: int
    ) -> None:
        self._cells, self._depth = cells, min(depth, cells.rows, cells.columns)
        self._height, self._width = cells.rows * cells.scale, cells.columns * cells.scale
        self._background = CellBackground(*(
            _joined(_sides(part, self._depth)) for part in background))
        step = max(1, max(picture.shape) // _LIGHT_SAMPLES)
        self._grid = tuple(
            slice(min(step, length) // 2, None, step) for length in picture.shape[:2])
        self._light = np.maximum(picture[self._grid], 1).astype(np.float32)

    def gains(self, frame: np.ndarray) -> List[float]:
        """Tell how much brighter each channel of a frame is."""
        return medians((frame[self._grid] / self._light).reshape(-1, 3))

    def differs(self, frame: np.ndarray, light: Light) -> bool:
        """
        Tell whether anything differs there.

        :param frame: Shape (h, w, 3), uint8, BGR.
        """
        whole = frame[:self._height, :self._width]
        sides = _sides(whole, self._depth * self._cells.scale)
        means = self._cells.means_of_samples(_joined(map(self._cells.sampled, sides)))
        return cv2.norm(self._background.excess(means, light), cv2.NORM_INF) > 0


def _sides(picture: np.ndarray, depth: int) -> Sequence[np.ndarray]:
    return picture[:depth], picture[-depth:], picture[:, :depth], picture[:, -depth:]


def _joined(sides: Iterable[np.ndarray]) -> np.ndarray:
    # To a long picture, the left and the right side turned: each call costs more than its pixels.
    top, bottom, left, right = sides
    return cv2.hconcat([top, bottom, cv2.transpose(left), cv2.transpose(right)])
