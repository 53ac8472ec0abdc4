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

"""Geometry of the simulated board: a pinhole camera above a work surface."""

import math
from typing import NamedTuple, Sequence, Tuple

from camera_to_base.checks import finite_number
from camera_to_base.image_size import check_image_size, ImageSize
from camera_to_base.simulation.camera_move import CameraMove
from camera_to_base.simulation.specs import LARGEST_TILT_DEG
from camera_to_base.surface import HomographySurface
import numpy as np

_CAMERA_DISTANCE_CM = 60.0


class Oval(NamedTuple):
    """
    An ellipse on the surface.

    :param point: Its centre, x and y, in cm.
    :param half_length: In cm.
    :param half_width: In cm.
    :param yaw: The direction of its length, from x towards y, in rad.
    """

    point: Tuple[float, float]
    half_length: float
    half_width: float
    yaw: float


class SeenEllipse(NamedTuple):
    """
    The image of an oval.

    :param centre: u and v, in px.
    :param half: Half of the width and height of the upright box around it, in px.
    :param radius: Radius of a disc of the same area, in px.
    """

    centre: np.ndarray
    half: np.ndarray
    radius: float


class BoardView:
    """
    A pinhole camera over a board.

    The camera frame is that of a camera at tilt 0: its origin is the surface point that the
    top-left pixel shows, x to the right, y down. A tilt turns the camera about the surface point
    at the picture's centre, so that the top of the picture shows more distant points.

    :param image_size: Width and height, in px.
    :param width_cm: What the picture's width sees of the surface at tilt 0, in cm.
    :param tilt_deg: 0 looks straight down; up to 60, in degrees.
    :param move: How the camera was moved since; the camera frame stays on the surface.
    :raises InvalidValueError: If a value cannot be used.
    :raises HorizonError: If the picture would reach the horizon.
    """

    def __init__(
        self, image_size: ImageSize, width_cm: float, tilt_deg: float,
        move: CameraMove = CameraMove(),
    ) -> None:
        self._from = image_size, width_cm, tilt_deg
        self.width, self.height = check_image_size(image_size)
        self.cm_per_px = finite_number('width_cm', width_cm, 1.0, 1000.0) / self.width
        tilt = math.radians(finite_number('tilt_deg', tilt_deg, 0.0, LARGEST_TILT_DEG))
        self.pixel_from_surface = self._project(tilt, move)
        inverse = np.linalg.inv(self.pixel_from_surface)
        self.surface_from_pixel = inverse / inverse[2, 2]
        right, bottom = self.width - 1, self.height - 1
        HomographySurface(self.surface_from_pixel, image_size).locate(
            [[0, 0], [right, 0], [0, bottom], [right, bottom]])

    def moved(self, move: CameraMove) -> 'BoardView':
        """
        Return the view of this camera after a move; this view is not to be a moved one.

        :raises HorizonError: If the picture would reach the horizon.
        """
        return BoardView(*self._from, move)

    def points(self, rows: slice, columns: slice) -> np.ndarray:
        """
        Return the surface points that the pixels of a window show.

        :returns: Shape (rows, columns, 2): x and y on the surface, in cm.
        """
        v, u = np.mgrid[rows, columns].astype(float)
        scaled = np.stack([u, v, np.ones_like(u)], axis=2) @ self.surface_from_pixel.T
        return scaled[:, :, :2] / scaled[:, :, 2:]

    def point(self, pixel: Sequence[float]) -> Tuple[float, float]:
        """Return the surface point that a pixel, u and v, shows: x and y, in cm."""
        x, y, w = self.surface_from_pixel @ [*pixel, 1.0]
        return float(x / w), float(y / w)

    def ellipse(self, oval: Oval) -> SeenEllipse:
        """
        Project an oval.

        Source: Hartley and Zisserman, Multiple View Geometry, 2.2.3. With the dual conic
        C* = P C* P', the centre of an oval's picture is the pole of the line at infinity, the
        last column; the tangents u = const and v = const follow from the diagonal.
        """
        cos, sin = math.cos(oval.yaw), math.sin(oval.yaw)
        placed = np.array([[cos, -sin, oval.point[0]], [sin, cos, oval.point[1]], [0, 0, 1]])
        to_pixel = self.pixel_from_surface @ placed
        dual = to_pixel @ np.diag(
            [oval.half_length ** 2, oval.half_width ** 2, -1.0]) @ to_pixel.T
        dual /= dual[2, 2]
        centre = dual[:2, 2]
        spread = np.outer(centre, centre) - dual[:2, :2]
        return SeenEllipse(centre, np.sqrt(np.diag(spread)), float(np.linalg.det(spread)) ** 0.25)

    def window(self, ellipse: SeenEllipse) -> Tuple[slice, slice]:
        """Return the rows and columns of the picture that an ellipse touches."""
        return self._clipped(ellipse.centre - ellipse.half, ellipse.centre + ellipse.half)

    def box(self, pixels: np.ndarray) -> Tuple[slice, slice]:
        """
        Return the rows and columns of the picture that a polygon touches.

        :param pixels: Its corners, shape (n, 2), u and v.
        """
        return self._clipped(pixels.min(axis=0), pixels.max(axis=0))

    def coverage(self, oval: Oval, rows: slice, columns: slice) -> np.ndarray:
        """
        Return the share of each pixel of a window that an oval covers.

        The share grows linearly with the signed distance to the edge, which to first order is the
        implicit function divided by its gradient, in px.

        :returns: Shape (rows, columns), 0..1.
        """
        x, y = np.moveaxis(self.points(rows, columns) - oval.point, 2, 0)
        cos, sin = math.cos(oval.yaw), math.sin(oval.yaw)
        across = (cos * y - sin * x) * (oval.half_length / oval.half_width)
        beyond_edge = np.hypot(cos * x + sin * y, across) - oval.half_length
        slope = np.hypot(*np.gradient(beyond_edge)) if min(x.shape) > 1 else self.cm_per_px
        return np.clip(0.5 - beyond_edge / np.maximum(slope, 1e-9), 0.0, 1.0)

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """
        Map points of the surface to the picture.

        :param points: Shape (n, 2), x and y, in cm.
        :returns: Shape (n, 2), u and v, in px.
        """
        scaled = np.column_stack([points, np.ones(len(points))]) @ self.pixel_from_surface.T
        return scaled[:, :2] / scaled[:, 2:]

    @property
    def size_cm(self) -> np.ndarray:
        """Width and height of what the camera sees of the surface at tilt 0, in cm."""
        return self.cm_per_px * np.array([self.width, self.height])

    def _clipped(self, first: np.ndarray, last: np.ndarray) -> Tuple[slice, slice]:
        left, top = np.clip(np.floor(first).astype(int) - 1, 0, None)
        right, bottom = np.clip(np.ceil(last).astype(int) + 2, 0, [self.width, self.height])
        return slice(top, bottom), slice(left, right)

    def _project(self, tilt: float, move: CameraMove) -> np.ndarray:
        # Hartley and Zisserman, Multiple View Geometry, 8.1: a plane's points project by
        # K [r1 r2 t]; here the plane's origin is moved to where the picture's centre looks.
        centre = self.width / 2, self.height / 2
        focal = _CAMERA_DISTANCE_CM / self.cm_per_px
        camera = np.array([[focal, 0, centre[0]], [0, focal, centre[1]], [0, 0, 1]])
        pose = move.rotation(tilt)
        pose[:, 2] = 0, 0, _CAMERA_DISTANCE_CM / move.zoom
        to_centre = np.array([[1, 0, (move.shift_px[0] - centre[0]) * self.cm_per_px],
                              [0, 1, (move.shift_px[1] - centre[1]) * self.cm_per_px],
                              [0, 0, 1]])
        return camera @ pose @ to_centre
