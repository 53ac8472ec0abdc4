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

from typing import List

from camera_to_base.trust.arms.cells import CellBackground, Cells, Light, medians
import numpy as np

# Gaps of 4 cells are closed: what reaches in differs within this many cells of the edge.
_DEPTH = 5
# Pixels that tell the light, along the picture's longer side.
_LIGHT_SAMPLES = 20


class PictureEdge:
    """
    Tells whether a frame differs from the background near its edge.

    :param picture: The background, shape (h, w, 3), uint8, BGR.
    :param cells: Its cells; `background` is its content.
    """

    def __init__(self, picture: np.ndarray, cells: Cells, background: CellBackground) -> None:
        rows, columns = (min(_DEPTH, count) for count in (cells.rows, cells.columns))
        self._cells = cells
        self._height, self._width = cells.rows * cells.scale, cells.columns * cells.scale
        self._deep, self._wide = rows * cells.scale, columns * cells.scale
        self._background = CellBackground(*(
            _joined(np.concatenate([part[:rows], part[-rows:]]),
                    np.concatenate([part[:, :columns], part[:, -columns:]], axis=1))
            for part in background))
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
        frame, sampled = frame[:self._height, :self._width], self._cells.sampled
        along = np.concatenate([sampled(frame[:self._deep]), sampled(frame[-self._deep:])])
        across = np.concatenate(
            [sampled(frame[:, :self._wide]), sampled(frame[:, -self._wide:])], axis=1)
        means = _joined(*map(self._cells.means_of_samples, (along, across)))
        return self._background.differs(means, light)


def _joined(*parts: np.ndarray) -> np.ndarray:
    return np.concatenate([part.reshape(1, -1, 3) for part in parts], axis=1)
