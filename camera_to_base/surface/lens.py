# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The lens of a pinhole camera, with the distortion models of sensor_msgs/CameraInfo."""

from dataclasses import dataclass
from functools import cached_property
from typing import Sequence, Tuple

from camera_to_base.checks import check_image_size, finite_numbers, ImageSize
from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np

# How many coefficients each model of sensor_msgs/distortion_models has.
DISTORTION_MODELS = {'plumb_bob': (4, 5), 'rational_polynomial': (8,), 'equidistant': (4,)}

# Until the pixel moves by less than 1e-9 of the focal length; a usual lens needs 5 to 15 steps.
_UNTIL = cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-10
# A pixel that does not come back to this many px has no answer.
_CLOSE_PX = 0.01
# Where a lens stops being one-to-one is looked for up to this tangent of the viewing angle.
_TANGENTS = np.linspace(0.0, 5.0, 2001)[1:]


@dataclass(frozen=True)
class LensModel:
    """
    A pinhole with distortion, as ROS and OpenCV describe it.

    Source: OpenCV, Camera Calibration and 3D Reconstruction; sensor_msgs/CameraInfo.

    :param image_size: Width and height of the pictures that it holds for, in px.
    :param focal: fx and fy, in px.
    :param centre: cx and cy, the principal point, in px.
    :param coefficients: In OpenCV's order: k1 k2 p1 p2 k3 for plumb_bob, k1 k2 p1 p2 k3 k4 k5 k6
        for rational_polynomial, k1 k2 k3 k4 for equidistant; () for a lens without distortion.
    :param model: One of `DISTORTION_MODELS`.
    :raises InvalidValueError: If a value describes no lens.
    """

    image_size: ImageSize
    focal: Tuple[float, float]
    centre: Tuple[float, float]
    coefficients: Tuple[float, ...] = ()
    model: str = 'plumb_bob'

    def __post_init__(self) -> None:
        """Check the values, and make them tuples of floats."""
        object.__setattr__(self, 'image_size', check_image_size(self.image_size))
        for name, length in (('focal', 2), ('centre', 2), ('coefficients', -1)):
            numbers = finite_numbers(name, getattr(self, name), length)
            object.__setattr__(self, name, tuple(numbers.tolist()))
        if not min(self.focal) > 0:
            raise InvalidValueError(
                f'a camera_matrix needs fx and fy above 0, got {list(self.focal)}')
        counts = DISTORTION_MODELS.get(self.model)
        if counts is None:
            raise InvalidValueError(
                f'distortion_model must be one of {", ".join(DISTORTION_MODELS)}, got '
                f'{self.model!r}')
        if self.coefficients and len(self.coefficients) not in counts:
            raise InvalidValueError(
                f'{self.model} has {" or ".join(map(str, counts))} distortion_coefficients, got '
                f'{len(self.coefficients)}')

    @classmethod
    def of_matrix(
        cls, image_size: ImageSize, matrix: np.ndarray, coefficients: Sequence[float] = (),
        model: str = 'plumb_bob',
    ) -> 'LensModel':
        """
        Make the lens of a camera matrix.

        :param matrix: Shape (3, 3), [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], in px.
        :raises InvalidValueError: If the matrix has another form, or a value describes no lens.
        """
        matrix = finite_numbers('camera_matrix', matrix, 3, 3)
        (fx, _, cx), (_, fy, cy), _ = matrix
        lens = cls(image_size, (fx, fy), (cx, cy), coefficients, model)
        if not np.array_equal(matrix, lens.matrix):
            raise InvalidValueError('camera_matrix must be [fx, 0, cx, 0, fy, cy, 0, 0, 1], got '
                                    f'{matrix.ravel().tolist()}')
        return lens

    @property
    def matrix(self) -> np.ndarray:
        """The camera matrix, shape (3, 3), in px."""
        (fx, fy), (cx, cy) = self.focal, self.centre
        return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])

    @cached_property
    def coefficient(self) -> float:
        """The coefficient of `RadialDistortion` that comes closest near the centre; no unit."""
        first = self.coefficients[0] if self.coefficients else 0.0
        if self.model == 'equidistant':
            first -= 1 / 3
        elif len(self.coefficients) == 8:
            first -= self.coefficients[5]
        return first * (np.hypot(*self.image_size) / 2) ** 2 / (self.focal[0] * self.focal[1])

    def undistort(self, pixels: np.ndarray) -> np.ndarray:
        """
        Map pixels of the picture to those of a lens without distortion.

        :param pixels: Shape (n, 2), columns u and v, in px.
        :returns: Shape (n, 2), in px; NaN where the lens shows nothing.
        """
        pixels = np.asarray(pixels, float)
        if not self._is_distorted or not len(pixels):
            return pixels
        straight = self._straight(pixels)
        with np.errstate(invalid='ignore'):
            back = np.abs(self.distort(straight) - pixels).max(axis=1, keepdims=True)
            return np.where(back < _CLOSE_PX, straight, np.nan)

    def distort(self, pixels: np.ndarray) -> np.ndarray:
        """
        Map pixels of a lens without distortion to those of the picture.

        :param pixels: Shape (n, 2), columns u and v, in px.
        :returns: Shape (n, 2), in px; NaN where the lens shows nothing.
        """
        pixels = np.asarray(pixels, float)
        if not self._is_distorted or not len(pixels):
            return pixels
        rays = (pixels - self.centre) / self.focal
        with np.errstate(invalid='ignore'):
            seen = (np.einsum('ij,ij->i', rays, rays) < self._limit ** 2)[:, None]
        rays = np.where(seen, rays, 0.0)
        return np.where(seen, self._shown(rays), np.nan)

    def rays(self, pixels: np.ndarray) -> np.ndarray:
        """
        Return where pixels look.

        :param pixels: Shape (n, 2), columns u and v, in px.
        :returns: Shape (n, 2), x / z and y / z in the optical frame; NaN as in `undistort`.
        """
        return (self.undistort(pixels) - self.centre) / self.focal

    def project(self, points: np.ndarray) -> np.ndarray:
        """
        Return the pixels that show points.

        :param points: Shape (n, 3), in the optical frame, in any unit.
        :returns: Shape (n, 2), in px; NaN for a point behind the camera or out of its sight.
        """
        points = np.asarray(points, float)
        depth = np.where(points[:, 2:] > 0, points[:, 2:], np.nan)
        return self.distort(points[:, :2] / depth * self.focal + self.centre)

    @cached_property
    def _is_distorted(self) -> bool:
        return self.model == 'equidistant' or any(self.coefficients)

    @cached_property
    def _numbers(self) -> np.ndarray:
        return np.array(self.coefficients or (0.0,) * 4)

    @cached_property
    def _limit(self) -> float:
        """The tangent of the viewing angle up to which pixels move outwards with the angle."""
        offsets = np.column_stack([_TANGENTS, np.zeros(len(_TANGENTS))])
        with np.errstate(over='ignore', invalid='ignore'):
            inwards = np.diff(self._shown(offsets)[:, 0], prepend=self.centre[0]) <= 0
        return float(_TANGENTS[np.argmax(inwards)]) if inwards.any() else np.inf

    def _shown(self, rays: np.ndarray) -> np.ndarray:
        if self.model == 'equidistant':
            return cv2.fisheye.distortPoints(rays[None], self.matrix, self._numbers)[0]
        points = np.column_stack([rays, np.ones(len(rays))])
        nothing = np.zeros(3)
        return cv2.projectPoints(points, nothing, nothing, self.matrix, self._numbers)[0][:, 0]

    def _straight(self, pixels: np.ndarray) -> np.ndarray:
        matrix, given = self.matrix, (pixels[:, None], self.matrix, self._numbers)
        if self.model == 'equidistant':
            return cv2.fisheye.undistortPoints(*given, P=matrix)[:, 0]
        if hasattr(cv2, 'undistortPointsIter'):  # OpenCV 4
            return cv2.undistortPointsIter(*given, None, matrix, _UNTIL)[:, 0]
        return cv2.undistortPoints(*given, P=matrix, criteria=_UNTIL)[:, 0]
