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

"""A work surface with a coin moving over it, rendered: a frame source that knows the truth."""

import math
from typing import Optional, Tuple

from camera_to_base.checks import finite_number, whole_number
from camera_to_base.surface import check_image_size, HomographySurface, ImageSize
import numpy as np

_CAMERA_DISTANCE_CM = 60.0
_TABLE_COLOUR = np.array([196.0, 202.0, 208.0], np.float32)
_COIN_COLOUR = np.array([52.0, 60.0, 70.0], np.float32)
_COIN_DIAMETER_CM = 2.4
_GRID_CM = 4.5
_GRID_DEPTH = 10.0
# One round of the coin's path takes this long; 2 and 3 rounds in x and y make a closed figure.
_ROUND_S = 60.0


class SimulatedBoard:
    """
    Frames of a coin that moves over a board, seen by a pinhole camera.

    The camera frame is that of a camera at tilt 0: its origin is where the top-left pixel looks
    at, x to the right, y down. A tilt turns the camera about the surface point that the
    picture's centre looks at, so that the picture's top looks farther. The first frame shows
    the empty board.

    :param image_size: Width and height, in px.
    :param width_cm: What the picture's width sees of the surface at tilt 0, in cm.
    :param tilt_deg: 0 looks straight down; up to 60, in degrees.
    :param noise: Standard deviation of the sensor's noise, in grey levels.
    :param seed: Makes the noise; the same seed gives the same frames.
    :param frame_rate: Frames per second of the coin's time.
    :raises InvalidValueError: If a value cannot be used.
    :raises HorizonError: If the picture would reach the horizon.
    """

    def __init__(
        self,
        *,
        image_size: ImageSize = (640, 480),
        width_cm: float = 36.0,
        tilt_deg: float = 0.0,
        noise: float = 2.0,
        seed: int = 0,
        frame_rate: float = 10.0,
    ) -> None:
        self._width, self._height = check_image_size(image_size)
        tilt_deg = finite_number('tilt_deg', tilt_deg, 0.0, 60.0)
        width_cm = finite_number('width_cm', width_cm, 1.0, 1000.0)
        self._noise = finite_number('noise', noise, 0.0, 100.0)
        self._seed = whole_number('seed', seed, 0, 2**31 - 1)
        self.frame_rate = finite_number('frame_rate', frame_rate, 0.1, 1000.0)
        self._cm_per_px = width_cm / self._width
        self._pixel_from_surface = self._project(math.radians(tilt_deg))
        self._refuse_horizon()
        self._board = self._draw_board()
        self._frame_count = 0
        self.true_point: Optional[Tuple[float, float]] = None

    @property
    def pixel_from_surface(self) -> np.ndarray:
        """Homography from cm in the camera frame to px, shape (3, 3)."""
        return self._pixel_from_surface.copy()

    @property
    def surface_from_pixel(self) -> np.ndarray:
        """Homography from px to cm in the camera frame, shape (3, 3): what calibration finds."""
        inverse = np.linalg.inv(self._pixel_from_surface)
        return inverse / inverse[2, 2]

    def read(self) -> np.ndarray:
        """
        Render the next frame; from then on `true_point` is the coin's position on it.

        :returns: Shape (h, w, 3), uint8, BGR.
        """
        number = self._frame_count
        self._frame_count += 1
        self.true_point = self.coin_point(number)
        picture = self._board.copy()
        if self.true_point is not None:
            self._draw_coin(picture, self.true_point)
        if self._noise > 0:
            noise = np.random.default_rng((self._seed, number)).standard_normal(
                picture.shape, dtype=np.float32)
            picture += noise * np.float32(self._noise)
        return np.clip(np.rint(picture), 0, 255).astype(np.uint8)

    def release(self) -> None:
        """Do nothing: there is no device to give back."""

    def coin_point(self, number: int) -> Optional[Tuple[float, float]]:
        """
        Tell where the coin is.

        :param number: The frame's, from 0.
        :returns: x and y, in cm, in the camera frame; None on the first frame.
        """
        if number == 0:
            return None
        angle = 2 * math.pi * number / self.frame_rate / _ROUND_S
        return (self._cm_per_px * self._width * (0.5 + 0.3 * math.sin(2 * angle)),
                self._cm_per_px * self._height * (0.5 + 0.25 * math.sin(3 * angle)))

    def _project(self, tilt: float) -> np.ndarray:
        # Hartley and Zisserman, Multiple View Geometry, 8.1: a plane's points project by
        # K [r1 r2 t]; here the plane's origin is moved to where the picture's centre looks.
        centre = self._width / 2, self._height / 2
        focal = _CAMERA_DISTANCE_CM / self._cm_per_px
        camera = np.array([[focal, 0, centre[0]], [0, focal, centre[1]], [0, 0, 1]])
        pose = np.array([[1, 0, 0],
                         [0, math.cos(tilt), 0],
                         [0, -math.sin(tilt), _CAMERA_DISTANCE_CM]])
        to_centre = np.array([[1, 0, -centre[0] * self._cm_per_px],
                              [0, 1, -centre[1] * self._cm_per_px],
                              [0, 0, 1]])
        return camera @ pose @ to_centre

    def _refuse_horizon(self) -> None:
        right, bottom = self._width - 1, self._height - 1
        size = self._width, self._height
        HomographySurface(self.surface_from_pixel, size).locate(
            [[0, 0], [right, 0], [0, bottom], [right, bottom]])

    def _draw_board(self) -> np.ndarray:
        # Faint lines every few cm let the eye see the tilt; the detector does not see them.
        points = self._surface_points(slice(0, self._height), slice(0, self._width))
        to_line = np.abs((points + _GRID_CM / 2) % _GRID_CM - _GRID_CM / 2).min(axis=2)
        line = np.clip(1 - to_line / self._cm_per_px, 0, 1)[:, :, None]
        return (_TABLE_COLOUR - _GRID_DEPTH * line).astype(np.float32)

    def _draw_coin(self, picture: np.ndarray, point: Tuple[float, float]) -> None:
        rows, columns = self._window(point)
        if rows.stop <= rows.start or columns.stop <= columns.start:
            return
        coverage = self._coverage(point, rows, columns)[:, :, None].astype(np.float32)
        window = picture[rows, columns]
        window += coverage * (_COIN_COLOUR - window)

    def _window(self, point: Tuple[float, float]) -> Tuple[slice, slice]:
        reach = 0.75 * _COIN_DIAMETER_CM
        corners = np.array([[point[0] + dx, point[1] + dy, 1.0]
                            for dx in (-reach, reach) for dy in (-reach, reach)])
        projected = corners @ self._pixel_from_surface.T
        pixels = projected[:, :2] / projected[:, 2:]
        left, top = np.floor(pixels.min(axis=0)).astype(int)
        right, bottom = np.ceil(pixels.max(axis=0)).astype(int) + 1
        return (slice(max(top, 0), min(bottom, self._height)),
                slice(max(left, 0), min(right, self._width)))

    def _coverage(
        self, point: Tuple[float, float], rows: slice, columns: slice
    ) -> np.ndarray:
        # A pixel is covered in proportion to how far the edge has passed over it. The distance
        # to the edge in px is, to first order, the implicit function over its gradient.
        x, y = np.moveaxis(self._surface_points(rows, columns) - point, 2, 0)
        beyond_edge = np.hypot(x, y) - _COIN_DIAMETER_CM / 2
        slope = np.hypot(*np.gradient(beyond_edge)) if min(x.shape) > 1 else self._cm_per_px
        return np.clip(0.5 - beyond_edge / np.maximum(slope, 1e-9), 0.0, 1.0)

    def _surface_points(self, rows: slice, columns: slice) -> np.ndarray:
        # Shape (rows, columns, 2): x and y, in cm, of what each pixel looks at.
        v, u = np.mgrid[rows, columns].astype(float)
        scaled = np.stack([u, v, np.ones_like(u)], axis=2) @ self.surface_from_pixel.T
        return scaled[:, :, :2] / scaled[:, :, 2:]
