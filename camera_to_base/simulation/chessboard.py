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


"""A printed chessboard on the simulated work surface, to calibrate the simulated camera with."""

from typing import Tuple

from camera_to_base.checks import finite_number, whole_number
from camera_to_base.coordinate_transform import TUTORIAL_WIDTH_CM
from camera_to_base.image_size import DEFAULT_IMAGE_SIZE, ImageSize
from camera_to_base.simulation.view import BoardView
from camera_to_base.sources import SIMULATED
import numpy as np

_TABLE_COLOUR = np.array([196.0, 202.0, 208.0])
_PAPER_COLOUR = np.array([225.0, 225.0, 225.0])
_INK_COLOUR = np.array([35.0, 35.0, 35.0])
_NOISE = 2.0


class SimulatedChessboard:
    """
    Frames of a chessboard in the middle of the surface, seen as the simulated board is.

    Its dark end is on the left, so that its first corner is the top left one.

    :param columns: Inner corners along a row.
    :param rows: Inner corners along a column.
    :param square_cm: Edge of a square, in cm.
    :param image_size: Width and height, in px.
    :param tilt_deg: The camera's, see :class:`BoardView`.
    :param seed: Makes the noise; the same seed gives the same frames.
    :raises InvalidValueError: If a value cannot be used.
    """

    kind = SIMULATED._replace(frame_rate=10.0)

    def __init__(
        self,
        columns: int,
        rows: int,
        square_cm: float,
        *,
        image_size: ImageSize = DEFAULT_IMAGE_SIZE,
        tilt_deg: float = 0.0,
        seed: int = 0,
    ) -> None:
        self.view = BoardView(image_size, TUTORIAL_WIDTH_CM, tilt_deg)
        self._columns = whole_number('columns', columns, 1, 1000)
        self._rows = whole_number('rows', rows, 1, 1000)
        self._square_cm = finite_number('square_cm', square_cm, 0.001, 1e4)
        self._random = np.random.default_rng(seed)
        self._shift, self._yaw = np.zeros(2), 0.0
        self._picture = self._draw()

    def lay(self, pixel: Tuple[float, float], yaw_deg: float) -> None:
        """
        Lay the board elsewhere.

        :param pixel: What shows the board's middle, u and v, in px.
        :param yaw_deg: Its turn from x towards y.
        """
        u, v, w = self.view.surface_from_pixel @ [*pixel, 1.0]
        self._shift, self._yaw = np.array([u / w, v / w]) - self._middle, np.radians(yaw_deg)
        self._picture = self._draw()

    def free_place(self, number: int) -> Tuple[Tuple[float, float], float]:
        """
        Return where the whole board still lies in the picture: one corner after the other.

        :param number: 1 for the first place after the middle.
        :returns: The pixel of its middle, and its turn, see :meth:`lay`.
        """
        size = np.array([self.view.width, self.view.height])
        board_px = self._square_cm * np.array([self._columns + 3, self._rows + 3]) / (
            self.view.cm_per_px)
        free = np.maximum(size - board_px, 0) / 2
        side = np.array([(-1, -1), (1, 1), (-1, 1), (1, -1)][(number - 1) % 4])
        return tuple((size / 2 + side * free * 0.9).tolist()), 0.0

    @property
    def _middle(self) -> np.ndarray:
        return self.view.cm_per_px * np.array([self.view.width, self.view.height]) / 2

    @property
    def first_corner(self) -> np.ndarray:
        """Where the first inner corner is, x and y, in cm, in the simulated camera frame."""
        return self._middle - self._square_cm * np.array([self._columns - 1, self._rows - 1]) / 2

    def read(self) -> np.ndarray:
        """
        Render the next frame.

        :returns: Shape (h, w, 3), uint8, BGR.
        """
        noise = self._random.normal(0.0, _NOISE, self._picture.shape)
        return np.clip(np.rint(self._picture + noise), 0, 255).astype(np.uint8)

    def release(self) -> None:
        """Do nothing: there is no device to give back."""

    def _draw(self) -> np.ndarray:
        points = self.view.points(slice(0, self.view.height), slice(0, self.view.width))
        cos, sin = np.cos(self._yaw), np.sin(self._yaw)
        points = (points - self._shift - self._middle) @ [[cos, -sin], [sin, cos]] + self._middle
        x, y = np.moveaxis((points - self.first_corner) / self._square_cm, 2, 0)
        paper = (x > -2) & (x < self._columns + 1) & (y > -2) & (y < self._rows + 1)
        inked = (x > -1) & (x < self._columns) & (y > -1) & (y < self._rows)
        darkness = np.where(inked, 0.5 + 0.5 * _stripes(x) * _stripes(y), 0.0)[:, :, None]
        board = _PAPER_COLOUR + darkness * (_INK_COLOUR - _PAPER_COLOUR)
        return np.where(paper[:, :, None], board, _TABLE_COLOUR)


def _stripes(position: np.ndarray) -> np.ndarray:
    # 1 from 0 to 1, -1 from 1 to 2, and so on; over an edge it changes along one pixel's width.
    sign = np.where(np.floor(position) % 2 == 0, 1.0, -1.0)
    to_edge = 0.5 - np.abs(position % 1 - 0.5)
    slope = np.hypot(*np.gradient(position))
    return sign * np.clip(2 * to_edge / np.maximum(slope, 1e-9), 0, 1)
