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

"""Four square markers on paper that lie on the simulated table."""

from typing import Dict, Tuple

from camera_to_base.markers import CELLS, marker_cells
from camera_to_base.simulation.view import BoardView
import numpy as np

MARKER_CM = 4.0
_PAPER_LEVEL, _INK_LEVEL = 225.0, 35.0
# Where the middles are, as shares of the picture's width and height.
_PLACES = ((0.14, 0.17), (0.86, 0.17), (0.86, 0.83), (0.14, 0.83))
# A cell of white paper around the black border.
_CELLS_WITH_PAPER = CELLS + 2
_PAPER_CM = MARKER_CM * _CELLS_WITH_PAPER / CELLS
_CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
# Each pixel is the mean of this many points along each edge, so that edges are smooth.
_FINE = 4


class PrintedMarkers:
    """
    The markers 0 to 3, near the corners of the picture.

    :param view: The camera's; the markers stay where they are if the camera is moved later.
    """

    def __init__(self, view: BoardView) -> None:
        size = np.array([view.width, view.height])
        self._middles = [np.array(view.point(size * place)) for place in _PLACES]

    @property
    def corners(self) -> Dict[int, np.ndarray]:
        """By the marker's number its corners, as printed, from the top left clockwise, in cm."""
        return {number: middle + MARKER_CM / 2 * _CORNERS
                for number, middle in enumerate(self._middles)}

    def paint(self, picture: np.ndarray, view: BoardView) -> None:
        """
        Lay the markers into a picture of the table.

        :param picture: Shape (h, w, 3), float32, BGR; it is changed.
        """
        for number, middle in enumerate(self._middles):
            rows, columns = view.box(view.pixels(middle + _PAPER_CM / 2 * _CORNERS))
            window = picture[rows, columns]
            if window.size > 0:
                points = view.points(_finely(rows), _finely(columns)) - middle
                inside, level = _marker_at(points, number)
                window *= 1 - _means(inside)[..., None]
                window += _means(level)[..., None]


def _marker_at(points: np.ndarray, number: int) -> Tuple[np.ndarray, np.ndarray]:
    # Whether points, from the marker's middle, lie on its paper, and the grey level there, else 0.
    cells = np.floor((points + _PAPER_CM / 2) * (CELLS / MARKER_CM)).astype(int)
    inside = ((cells >= 0) & (cells < _CELLS_WITH_PAPER)).all(axis=2)
    x, y = np.moveaxis(np.clip(cells, 0, _CELLS_WITH_PAPER - 1), 2, 0)
    ink = np.pad(marker_cells(number), 1)
    return inside, inside * np.where(ink[y, x], _INK_LEVEL, _PAPER_LEVEL)


def _finely(pixels: slice) -> slice:
    # Points of a pixel, evenly spread about its middle.
    first = 0.5 / _FINE - 0.5
    return slice(pixels.start + first, pixels.stop + first, 1 / _FINE)


def _means(fine: np.ndarray) -> np.ndarray:
    height, width = (length // _FINE for length in fine.shape)
    return fine.reshape(height, _FINE, width, _FINE).mean(axis=(1, 3)).astype(np.float32)
