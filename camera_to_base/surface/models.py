# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""From a pixel to the work surface: the models of a camera, and their parameters."""

import copy
from typing import Any, Mapping, Optional, Protocol, Sequence, TypeVar, Union

from camera_to_base.checks import (
    check_image_size, DEFAULT_IMAGE_SIZE, finite_numbers, ImageSize, LARGEST_SIDE)
from camera_to_base.coordinate_transform import CameraPlace, TUTORIAL_WIDTH_CM
from camera_to_base.errors import FrameSizeError, HorizonError, InvalidValueError
from camera_to_base.parameters import default_values, ParameterSpec
from camera_to_base.surface.distortion import LARGEST_COEFFICIENT, RadialDistortion
from camera_to_base.surface.lens import DISTORTION_MODELS, LensModel
import numpy as np

# An outline needs few.
MOST_CORNERS = 1000
SURFACE_MODELS = ('parallel', 'polynomial', 'homography', 'pinhole')
_CM_PER_PX = TUTORIAL_WIDTH_CM / DEFAULT_IMAGE_SIZE[0]
_CENTRE = [(side - 1) / 2 for side in DEFAULT_IMAGE_SIZE]

SURFACE_SPECS = [
    ParameterSpec('surface.model', 'parallel',
                  'How the camera looks at the surface.', choices=SURFACE_MODELS),
    ParameterSpec('surface.image_size', list(DEFAULT_IMAGE_SIZE),
                  'Width and height of the pictures that the calibration holds for; a camera '
                  'device is asked for it when it is opened.',
                  (1, LARGEST_SIDE), unit='px', lengths=(2,)),
    ParameterSpec('surface.hull', [],
                  'The area of the picture that the calibration was measured in, for an object '
                  'outside it the node warns: u and v of one corner after the other; empty for '
                  'everywhere.', unit='px',
                  constraints=f'u and v in turn, at most {MOST_CORNERS} corners'),
    ParameterSpec('surface.reject_outside_hull', False,
                  'Leave out objects outside surface.hull instead of warning of them.'),
    ParameterSpec('surface.parallel.width_cm', TUTORIAL_WIDTH_CM,
                  "parallel: what the picture's width sees of the surface.",
                  (0.001, 100000), unit='cm'),
    ParameterSpec('surface.polynomial.y_of_v', [0.00006, -0.0833, 25.848],
                  'polynomial: coefficients of v², v and 1 (v in px), for y in cm.', lengths=(3,)),
    ParameterSpec('surface.polynomial.px_per_cm_of_y', [0.0625, -1.6393, 29.071],
                  'polynomial: coefficients of y², y and 1 (y in cm), for the scale in px/cm.',
                  lengths=(3,)),
    ParameterSpec('surface.polynomial.centre_u', 292.0,
                  'polynomial: u of the line x = 0.', (-100000, 100000), unit='px'),
    ParameterSpec('surface.homography.surface_from_pixel',
                  [_CM_PER_PX, 0.0, 0.0, 0.0, _CM_PER_PX, 0.0, 0.0, 0.0, 1.0],
                  'homography: the 3 x 3 matrix from undistorted px to cm, row by row.',
                  lengths=(9,)),
    ParameterSpec('surface.homography.distortion_coefficient', 0.0,
                  "homography: the lens's radial distortion; an undistorted pixel lies at "
                  'centre + offset / (1 + coefficient r²), r being the distance to the centre in '
                  "halves of the picture's diagonal; 0 for none.",
                  (-LARGEST_COEFFICIENT, LARGEST_COEFFICIENT)),
    ParameterSpec('surface.homography.distortion_centre', _CENTRE,
                  'homography: the centre of the distortion, u and v.', unit='px', lengths=(2,)),
    ParameterSpec('surface.pinhole.camera_matrix',
                  [640.0, 0.0, _CENTRE[0], 0.0, 640.0, _CENTRE[1], 0.0, 0.0, 1.0],
                  "pinhole: the lens's 3 x 3 matrix, row by row, as k of camera_info.",
                  unit='px', lengths=(9,)),
    ParameterSpec('surface.pinhole.distortion_model', 'plumb_bob',
                  "pinhole: the lens's model of distortion, as in camera_info.",
                  choices=tuple(DISTORTION_MODELS)),
    ParameterSpec('surface.pinhole.distortion_coefficients', [],
                  "pinhole: the lens's distortion, as d of camera_info (plumb_bob: k1, k2, p1, "
                  'p2, k3); empty for none.', lengths=(0, 4, 5, 8)),
    ParameterSpec('surface.pinhole.rotation', [0.0, 0.0, 0.0],
                  'pinhole: rotation vector from the camera frame, on the surface, to the optical '
                  'frame of the lens (x right, y down, z along the view).', unit='rad',
                  lengths=(3,)),
    ParameterSpec('surface.pinhole.camera_position_cm', [0.0, 0.0, -50.0],
                  'pinhole: where the lens is in the camera frame: x and y of the foot point, and '
                  'the height above the surface, negative where z points away from the camera (y '
                  'then turns right of x as seen by it).', unit='cm', lengths=(3,)),
    ParameterSpec('surface.camera_height_cm', 0.0,
                  'How far above the surface the camera is; 0 for not known. pinhole knows it.',
                  (0, 100000), unit='cm'),
    ParameterSpec('surface.camera_foot_cm', [],
                  'The point of the surface below the camera, x and y, in the camera frame; empty '
                  "for not known: parallel then takes what the picture's centre looks at.",
                  unit='cm', lengths=(0, 2)),
]
SURFACE_DEFAULTS: Mapping[str, Any] = default_values(SURFACE_SPECS)

# A pixel whose ray meets the surface a hundred times farther away than the centre's covers ten
# thousand times the length along the ray: it says nothing about a position.
_HORIZON = 0.01


Lens = Union[RadialDistortion, LensModel]
Model = TypeVar('Model', bound='CalibratedSurface')


class Surface(Protocol):
    """
    Maps pixels to the work surface.

    `distortion` is that of the lens, None for a lens without; `camera_place` is where the camera
    is, None for not known; `pinhole` is the surface as a pinhole camera with a known pose, None
    for another model.
    """

    distortion: Optional[Lens]
    camera_place: Optional[CameraPlace]
    pinhole: Optional['CalibratedSurface']

    def locate(self, pixels: np.ndarray) -> np.ndarray:
        """
        Map pixels to the work surface.

        :param pixels: Shape (n, 2), columns u and v, in px.
        :returns: Shape (n, 2), columns x and y, in cm, in the camera frame.
        :raises HorizonError: If a pixel lies near the horizon or beyond it.
        :raises InvalidValueError: If the shape is another, or a number is not finite.
        """

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """
        Map points of the work surface to pixels.

        :param points: Shape (n, 2), columns x and y, in cm, in the camera frame.
        :returns: Shape (n, 2), columns u and v, in px; NaN for a point without a pixel.
        """

    def for_image_size(self, image_size: ImageSize) -> 'Surface':
        """
        Give the model for pictures of a size.

        :param image_size: Width and height, in px.
        :raises FrameSizeError: If the model does not hold for that size.
        """


class CalibratedSurface:
    """A surface of which a ruler may have told where the camera is."""

    _height_cm: float = 0.0
    _foot_cm: Optional[Sequence[float]] = None

    def seen_from(
        self: Model, height_cm: float, foot_cm: Optional[Sequence[float]] = None
    ) -> Model:
        """
        Give the same surface with the camera's place.

        :param height_cm: How far above the surface the camera is, in cm; 0 for not known.
        :param foot_cm: The point below it, x and y, in cm; None for not known.
        """
        surface = copy.copy(self)
        surface._height_cm, surface._foot_cm = height_cm, foot_cm
        return surface

    @property
    def camera_place(self) -> Optional[CameraPlace]:
        """Where the camera is above the surface; None for not known."""
        foot_cm = self._likely_foot_cm() if self._foot_cm is None else self._foot_cm
        if not self._height_cm or foot_cm is None:
            return None
        return CameraPlace(tuple(foot_cm), self._height_cm)

    @property
    def pinhole(self) -> Optional['CalibratedSurface']:
        """The surface as a pinhole camera with a known pose; None for another model."""
        return None

    def _likely_foot_cm(self) -> Optional[Sequence[float]]:
        return None


class ParallelSurface(CalibratedSurface):
    """
    The camera's lens is parallel to the surface: one factor from px to cm.

    The field of view stays as wide when the picture has more pixels, so the same width in cm
    serves every picture size.

    :param width_cm: What the picture's width sees of the surface, in cm, above 0.
    :param image_width: The picture's width, in px, at least 1.
    """

    def __init__(
        self,
        width_cm: float = SURFACE_DEFAULTS['surface.parallel.width_cm'],
        image_width: int = DEFAULT_IMAGE_SIZE[0],
    ) -> None:
        self.distortion = None
        self._width_cm = width_cm
        self._image_width = image_width
        self._image_height = image_width * DEFAULT_IMAGE_SIZE[1] / DEFAULT_IMAGE_SIZE[0]

    def locate(self, pixels: np.ndarray) -> np.ndarray:
        """Map pixels to the work surface, see :meth:`Surface.locate`; there is no horizon."""
        pixels = finite_numbers('pixels', pixels, -1, 2)
        with np.errstate(over='ignore'):
            return _points(pixels * (self._width_cm / self._image_width))

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """
        Map points of the work surface to pixels.

        :param points: Shape (n, 2), columns x and y, in cm, in the camera frame.
        :returns: Shape (n, 2), columns u and v, in px.
        """
        with np.errstate(over='ignore'):
            return finite_numbers('points', points, -1, 2) * (self._image_width / self._width_cm)

    def for_image_size(self, image_size: ImageSize) -> 'ParallelSurface':
        """Give the model for pictures of a size: the same width in cm, in that many pixels."""
        surface = copy.copy(self)
        surface._image_width, surface._image_height = image_size
        return surface

    def _likely_foot_cm(self) -> Sequence[float]:
        # A camera that looks straight down stands above the picture's centre.
        centre = np.subtract([self._image_width, self._image_height], 1) / 2
        return self.locate([centre])[0].tolist()


class PolynomialSurface(CalibratedSurface):
    """
    The tutorial's model of a tilted camera: two quadratics and a centre line.

    y = y_of_v(v), px per cm = px_per_cm_of_y(y), x = (u - centre_u) / px per cm.

    :param y_of_v: Coefficients of v², v and 1, for y in cm.
    :param px_per_cm_of_y: Coefficients of y², y and 1, for the scale in px/cm.
    :param centre_u: u of the line x = 0, in px.
    :param image_size: Width and height of the pictures it was measured on, in px.
    """

    def __init__(
        self,
        y_of_v: Sequence[float] = SURFACE_DEFAULTS['surface.polynomial.y_of_v'],
        px_per_cm_of_y: Sequence[float] = SURFACE_DEFAULTS['surface.polynomial.px_per_cm_of_y'],
        centre_u: float = SURFACE_DEFAULTS['surface.polynomial.centre_u'],
        image_size: ImageSize = DEFAULT_IMAGE_SIZE,
    ) -> None:
        self.distortion = None
        self.y_of_v = finite_numbers('y_of_v', y_of_v, 3)
        self.px_per_cm_of_y = finite_numbers('px_per_cm_of_y', px_per_cm_of_y, 3)
        self.centre_u = float(finite_numbers('centre_u', centre_u))
        self.image_size = check_image_size(image_size)

    def locate(self, pixels: np.ndarray) -> np.ndarray:
        """Map pixels to the work surface, see :meth:`Surface.locate`."""
        u, v = finite_numbers('pixels', pixels, -1, 2).T
        with np.errstate(over='ignore', invalid='ignore', divide='ignore'):
            y = np.polyval(self.y_of_v, v)
            px_per_cm = np.polyval(self.px_per_cm_of_y, y)
            _refuse_beyond_horizon(np.column_stack([u, v]), px_per_cm > 0)
            return _points(np.column_stack([(u - self.centre_u) / px_per_cm, y]))

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """
        Map points of the work surface to pixels, for drawing.

        Two rows have the same y; the result is the one on the side of the parabola with v = 0.

        :param points: Shape (n, 2), columns x and y, in cm, in the camera frame.
        :returns: Shape (n, 2), columns u and v, in px; NaN for a point without a pixel.
        """
        x, y = finite_numbers('points', points, -1, 2).T
        a, b, c = self.y_of_v[0], self.y_of_v[1], self.y_of_v[2] - y
        root = b * b - 4 * a * c
        px_per_cm = np.polyval(self.px_per_cm_of_y, y)
        seen = (root >= 0) & (px_per_cm > 0)
        # The root that stays finite where a vanishes (the numerically stable form).
        v = 2 * c / (-b - np.copysign(np.sqrt(np.where(seen, root, np.nan)), b))
        return np.column_stack([np.where(seen, self.centre_u + x * px_per_cm, np.nan), v])

    def for_image_size(self, image_size: ImageSize) -> 'PolynomialSurface':
        """Give the model for pictures of a size: only the one it was measured on."""
        _check_same_size(image_size, self.image_size)
        return self


class HomographySurface(CalibratedSurface):
    """
    A pinhole camera at any tilt: undistort in closed form, then a projective map to the surface.

    Source: Hartley and Zisserman, Multiple View Geometry, 2nd edition, section 2.3.

    The picture's centre must look at the surface: it tells which side of the horizon is seen.

    :param surface_from_pixel: Shape (3, 3), px to cm: (x w, y w, w) = matrix @ (u, v, 1).
    :param image_size: Width and height of the pictures it was measured on, in px.
    :param distortion: The lens; None for one without distortion.
    """

    def __init__(
        self,
        surface_from_pixel: np.ndarray,
        image_size: ImageSize = DEFAULT_IMAGE_SIZE,
        distortion: Optional[Lens] = None,
    ) -> None:
        matrix = finite_numbers('surface_from_pixel', surface_from_pixel, 3, 3)
        self.image_size = check_image_size(image_size)
        self.distortion = distortion or RadialDistortion.of_picture(self.image_size)
        centre = self.distortion.undistort(np.array([self.image_size]) / 2)
        with np.errstate(over='ignore', invalid='ignore', divide='ignore'):
            centre_depth = homogeneous(matrix, centre)[0, 2]
            usable = abs(centre_depth) > 1e-6 * np.abs(matrix[2]).max() and _has_inverse(matrix)
        if not usable:
            raise InvalidValueError(
                "surface_from_pixel must be a homography with an inverse, and the picture's "
                f'centre must not lie on its horizon, got {matrix.tolist()}')
        self.surface_from_pixel = matrix / centre_depth
        self.surface_from_pixel.setflags(write=False)

    def locate(self, pixels: np.ndarray) -> np.ndarray:
        """Map pixels to the work surface, see :meth:`Surface.locate`."""
        pixels = finite_numbers('pixels', pixels, -1, 2)
        with np.errstate(over='ignore', invalid='ignore', divide='ignore'):
            scaled = homogeneous(self.surface_from_pixel, self.distortion.undistort(pixels))
            nearness = scaled[:, 2]
            _refuse_beyond_horizon(pixels, nearness > _HORIZON)
            return _points(scaled[:, :2] / nearness[:, None])

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """
        Map points of the work surface to pixels, for drawing.

        :param points: Shape (n, 2), columns x and y, in cm, in the camera frame.
        :returns: Shape (n, 2), columns u and v, in px; NaN for a point without a pixel.
        """
        points = finite_numbers('points', points, -1, 2)
        scaled = homogeneous(np.linalg.inv(self.surface_from_pixel), points)
        # This is 1 / nearness of the pixel that shows the point.
        distance = scaled[:, 2:]
        seen = (distance > 0) & (distance < 1 / _HORIZON)
        return self.distortion.distort(scaled[:, :2] / np.where(seen, distance, np.nan))

    def for_image_size(self, image_size: ImageSize) -> 'HomographySurface':
        """Give the model for pictures of a size: only the one it was measured on."""
        _check_same_size(image_size, self.image_size)
        return self


def homogeneous(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    """
    Apply a homography and leave the result homogeneous.

    :param matrix: Shape (3, 3).
    :param points: Shape (n, 2).
    :returns: Shape (n, 3).
    """
    # A product with the transpose's copy takes half the time.
    return points @ np.ascontiguousarray(matrix[:, :2].T) + matrix[:, 2]


def _check_same_size(image_size: ImageSize, calibrated_size: ImageSize) -> None:
    if tuple(image_size) != calibrated_size:
        raise FrameSizeError(
            f'the frame is {image_size[0]} x {image_size[1]} px, but the surface was calibrated '
            f'for {calibrated_size[0]} x {calibrated_size[1]} px: set the camera to that size, '
            'or calibrate again')


def _refuse_beyond_horizon(pixels: np.ndarray, on_surface: np.ndarray) -> None:
    if not on_surface.all():
        u, v = pixels[~on_surface][0]
        raise HorizonError(
            f'pixel ({u:g}, {v:g}) does not look at the work surface: it lies near the horizon or '
            'beyond it; tilt the camera down, or check the calibration')


def _points(points: np.ndarray) -> np.ndarray:
    # Finite pixels can still overflow on their way.
    return finite_numbers('the points that the pixels look at', points, -1, 2)


def _has_inverse(matrix: np.ndarray) -> bool:
    # Rows in px and in cm differ by orders of magnitude: compare after each is made a unit.
    norms = np.linalg.norm(matrix, axis=1, keepdims=True)
    return bool((norms > 0).all()) and abs(np.linalg.det(matrix / norms)) > 1e-15
