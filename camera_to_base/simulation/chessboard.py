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
from camera_to_base.simulation.table import RenderedBoard
from camera_to_base.simulation.view import BoardView
from camera_to_base.sources import SIMULATED
import numpy as np

_TABLE_COLOUR = np.array([196.0, 202.0, 208.0])
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
        self._board = RenderedBoard(
            whole_number('columns', columns, 1, 1000), whole_number('rows', rows, 1, 1000),
            finite_number('square_cm', square_cm, 0.001, 1e4), tuple(self.view.size_cm / 2))
        self._first_corner = self._board.middle - self._board.half_cm
        self._random = np.random.default_rng(seed)
        self._picture = self._board.paint(_TABLE_COLOUR, self.view)

    def lay(self, pixel: Tuple[float, float], yaw_deg: float) -> None:
        """
        Lay the board elsewhere.

        :param pixel: What shows the board's middle, u and v, in px.
        :param yaw_deg: Its turn from x towards y.
        """
        self._board = self._board._replace(
            middle=self.view.point(pixel), yaw=np.radians(yaw_deg))
        self._picture = self._board.paint(_TABLE_COLOUR, self.view)

    def free_place(self, number: int) -> Tuple[Tuple[float, float], float]:
        """
        Return where the whole board still lies in the picture: one corner after the other.

        :param number: 1 for the first place after the middle.
        :returns: The pixel of its middle, and its turn, see :meth:`lay`.
        """
        size = np.array([self.view.width, self.view.height])
        paper_cm = 2 * self._board.half_cm + 4 * self._board.square_cm
        board_px = paper_cm / self.view.cm_per_px
        free = np.maximum(size - board_px, 0) / 2
        side = np.array([(-1, -1), (1, 1), (-1, 1), (1, -1)][(number - 1) % 4])
        return tuple((size / 2 + side * free * 0.9).tolist()), 0.0

    @property
    def first_corner(self) -> np.ndarray:
        """Where the first inner corner is at the start, x and y, in cm, in the camera frame."""
        return self._first_corner.copy()

    def read(self) -> np.ndarray:
        """
        Render the next frame.

        :returns: Shape (h, w, 3), uint8, BGR.
        """
        noise = self._random.normal(0.0, _NOISE, self._picture.shape)
        return np.clip(np.rint(self._picture + noise), 0, 255).astype(np.uint8)

    def release(self) -> None:
        """Do nothing: there is no device to give back."""
