# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The simulated camera: a pinhole above the work surface, and how it is moved."""

import copy
import math
from typing import Any, Dict, NamedTuple, Sequence, Tuple

from camera_to_base.checks import check_image_size, finite_number, ImageSize
from camera_to_base.parameters import Values
from camera_to_base.simulation.specs import DISC, LARGEST_TILT_DEG, SIMULATION_DEFAULTS
from camera_to_base.surface import HomographySurface, LensModel, PinholeSurface
import cv2
import numpy as np

_CAMERA_DISTANCE_CM = 60.0

# By how far a bump moves the corner of the picture that it moves farthest, in px.
_BUMP_PX = 4.0, 15.0
# Standard deviations before the bump is scaled: px at VGA, degrees, degrees, factor.
_SHIFT, _TURN_DEG, _TILT_DEG, _ZOOM = 5.0, 0.4, 0.4, 0.008


class CameraMove(NamedTuple):
    """
    A camera's way from its first pose to another one; any pose can be reached.

    :param shift_px: The picture of the table moves to the right and down by this, at tilt 0.
    :param turn_deg: The picture turns clockwise about its middle by this.
    :param tilt_deg: The camera is tilted further about the point at its picture's middle: so that
        the top, and so that the left of the picture shows more distant points.
    :param zoom: The camera comes nearer by this factor.
    """

    shift_px: Tuple[float, float] = tuple(SIMULATION_DEFAULTS['camera_shift_px'])
    turn_deg: float = SIMULATION_DEFAULTS['camera_turn_deg']
    tilt_deg: Tuple[float, float] = tuple(SIMULATION_DEFAULTS['camera_tilt_deg'])
    zoom: float = SIMULATION_DEFAULTS['camera_zoom']

    def rotation(self, tilt: float) -> np.ndarray:
        """
        Return the rotation from the surface to the moved camera.

        :param tilt: The camera's before the move, in rad.
        :returns: Shape (3, 3).
        """
        about_u, about_v = np.deg2rad(self.tilt_deg)
        return (_about_axis(math.radians(self.turn_deg)) @ _about_u(tilt + about_u)
                @ _about_v(about_v))

    def times(self, factor: float) -> 'CameraMove':
        """Return a move of the same kind, larger by a factor, for small moves."""
        def scaled(pair: Tuple[float, float]) -> Tuple[float, float]:
            return pair[0] * factor, pair[1] * factor

        return CameraMove(scaled(self.shift_px), self.turn_deg * factor, scaled(self.tilt_deg),
                          1 + (self.zoom - 1) * factor)


def camera_move(values: Values) -> CameraMove:
    """Make the move of the parameters, named without 'simulated.'."""
    return CameraMove(tuple(values['camera_shift_px']), values['camera_turn_deg'],
                      tuple(values['camera_tilt_deg']), values['camera_zoom'])


def move_parameters(move: CameraMove) -> Dict[str, Any]:
    """Return the parameters of a move, by their full names."""
    return {'simulated.camera_shift_px': list(move.shift_px),
            'simulated.camera_turn_deg': move.turn_deg,
            'simulated.camera_tilt_deg': list(move.tilt_deg),
            'simulated.camera_zoom': move.zoom}


def _about_axis(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])


def _about_u(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, cos, sin], [0, -sin, cos]])


def _about_v(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])


class Oval(NamedTuple):
    """
    An ellipse on the surface, or what stands on it.

    :param point: Its centre, x and y, in cm.
    :param half_length: In cm.
    :param half_width: In cm.
    :param yaw: The direction of its length, from x towards y, in rad.
    :param shape: One of `specs.SHAPES`: the ellipse, or a box or hexagon of its length and width.
    :param height_cm: Of the object that stands there; 0 for a flat one.
    """

    point: Tuple[float, float]
    half_length: float
    half_width: float
    yaw: float
    shape: str = DISC
    height_cm: float = 0.0

    @property
    def is_flat_disc(self) -> bool:
        """Whether it is an ellipse that lies on the surface."""
        return self.shape == DISC and self.height_cm == 0


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

    def of_plane(self, surface_from_plane: np.ndarray) -> 'BoardView':
        """
        Return the view of another plane, whose points are then those of the surface.

        :param surface_from_plane: Shape (3, 3), in cm: where the surface shows the plane's points.
        """
        view = copy.copy(self)
        view.pixel_from_surface = self.pixel_from_surface @ surface_from_plane
        inverse = np.linalg.inv(view.pixel_from_surface)
        view.surface_from_pixel = inverse / inverse[2, 2]
        return view

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

    def pixels_above(self, points: np.ndarray) -> np.ndarray:
        """
        Map points above the surface to the picture.

        :param points: Shape (n, 3), x, y and the height, in cm.
        :returns: Shape (n, 2), u and v, in px.
        """
        flat = np.column_stack([points[:, :2], np.ones(len(points))]) @ self.pixel_from_surface.T
        scaled = flat + points[:, 2:] * self._pixel_per_height
        return scaled[:, :2] / scaled[:, 2:]

    @property
    def camera_cm(self) -> np.ndarray:
        """Where the camera is: x and y of the surface below it, and its height, in cm."""
        x, y, w = np.linalg.solve(
            np.column_stack([self.pixel_from_surface[:, :2], self._pixel_per_height]),
            -self.pixel_from_surface[:, 2])
        return np.array([x, y, w])

    @property
    def pinhole(self) -> PinholeSurface:
        """The surface that a perfect calibration of this camera finds."""
        focal = _CAMERA_DISTANCE_CM / self.cm_per_px
        lens = LensModel((self.width, self.height), (focal, focal),
                         (self.width / 2, self.height / 2))
        return PinholeSurface(
            lens, cv2.Rodrigues(self._rotation)[0].ravel(), self.camera_cm * [1, 1, -1])

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
        self._rotation = move.rotation(tilt)
        # The height is counted against the camera frame's z.
        self._pixel_per_height = -camera @ self._rotation[:, 2]
        pose = self._rotation.copy()
        pose[:, 2] = 0, 0, _CAMERA_DISTANCE_CM / move.zoom
        to_centre = np.array([[1, 0, (move.shift_px[0] - centre[0]) * self.cm_per_px],
                              [0, 1, (move.shift_px[1] - centre[1]) * self.cm_per_px],
                              [0, 0, 1]])
        return camera @ pose @ to_centre


def largest_shift_px(view: BoardView, moved: BoardView) -> float:
    """Return how far a move takes the picture's corner that it takes farthest, in px."""
    right, bottom = view.width - 1.0, view.height - 1.0
    corners = np.array([[0, 0], [right, 0], [0, bottom], [right, bottom]])
    points = np.array([view.point(corner) for corner in corners])
    return float(np.hypot(*(moved.pixels(points) - corners).T).max())


def random_bump(random: np.random.Generator, view: BoardView) -> CameraMove:
    """Draw a bump of a camera: shift, turn, tilt and zoom at once, a few px in all."""
    unscaled = CameraMove(
        tuple(random.normal(0, _SHIFT, 2)), random.normal(0, _TURN_DEG),
        tuple(random.normal(0, _TILT_DEG, 2)), 1 + random.normal(0, _ZOOM))
    return _rounded(unscaled.times(
        random.uniform(*_BUMP_PX) / largest_shift_px(view, view.moved(unscaled))))


def _rounded(move: CameraMove) -> CameraMove:
    # As a person would write it; plain floats, as parameters take them.
    def pair(numbers: tuple) -> tuple:
        return tuple(round(float(number), 2) for number in numbers)

    return CameraMove(pair(move.shift_px), round(float(move.turn_deg), 3), pair(move.tilt_deg),
                      round(float(move.zoom), 5))
