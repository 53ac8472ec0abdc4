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

from typing import Dict

from camera_to_base.simulation.view import BoardView
import numpy as np

MARKER_CM = 4.0
# The bits of the markers 0 to 3 of DICT_4X4_50, row by row from the top left, 1 for white:
# OpenCV, modules/objdetect/src/aruco/predefined_dictionaries.hpp.
_BITS = (0xB532, 0x0F9A, 0x332D, 0x9946)
_PAPER_LEVEL, _INK_LEVEL = 225.0, 35.0
# Where the middles are, as shares of the picture's width and height.
_PLACES = ((0.14, 0.17), (0.86, 0.17), (0.86, 0.83), (0.14, 0.83))
# A cell of white paper around the black border.
_CELLS_WITH_PAPER = 8
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
        square = MARKER_CM / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        return {number: middle + square for number, middle in enumerate(self._middles)}

    def paint(self, picture: np.ndarray, view: BoardView) -> None:
        """
        Lay the markers into a picture of the table.

        :param picture: Shape (h, w, 3), float32, BGR; it is changed.
        """
        for number, middle in enumerate(self._middles):
            paper = _paper(number)
            half = MARKER_CM / 6 * _CELLS_WITH_PAPER / 2
            corners = view.pixels(middle + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]))
            rows, columns = view.box(corners)
            if picture[rows, columns].size == 0:
                continue
            points = view.points(_finely(rows), _finely(columns))
            cells = np.floor((points - middle + half) * 6 / MARKER_CM).astype(int)
            inside = ((cells >= 0) & (cells < _CELLS_WITH_PAPER)).all(axis=2)
            x, y = np.moveaxis(np.clip(cells, 0, _CELLS_WITH_PAPER - 1), 2, 0)
            window = picture[rows, columns]
            window *= 1 - _means(inside)[..., None]
            window += _means(np.where(inside, paper[y, x], 0.0))[..., None]


def marker_is_white(number: int) -> np.ndarray:
    """Return the cells of a marker, its border included: shape (6, 6), whether it is white."""
    white = np.zeros((6, 6), bool)
    white[1:5, 1:5] = np.reshape([_BITS[number] >> shift & 1 for shift in range(15, -1, -1)],
                                 (4, 4))
    return white


def _paper(number: int) -> np.ndarray:
    white = np.pad(marker_is_white(number), 1, constant_values=True)
    return np.where(white, _PAPER_LEVEL, _INK_LEVEL)


def _finely(pixels: slice) -> slice:
    # Points of a pixel, evenly spread about its middle.
    first = 0.5 / _FINE - 0.5
    return slice(pixels.start + first, pixels.stop + first, 1 / _FINE)


def _means(fine: np.ndarray) -> np.ndarray:
    height, width = (length // _FINE for length in fine.shape)
    return fine.reshape(height, _FINE, width, _FINE).mean(axis=(1, 3)).astype(np.float32)
