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

"""Where the camera is above the work surface, from points on it and the lens's intrinsics."""

from dataclasses import dataclass
from typing import NamedTuple, Tuple

from camera_to_base.checks import finite_numbers
from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.image_size import check_image_size, ImageSize
from camera_to_base.surface.matched_points import check_spread, MatchedPoints
import cv2
import numpy as np

# Lengths of OpenCV's distortion: k1 k2 p1 p2, k3, k4 k5 k6, thin prism, tilted sensor.
COEFFICIENT_COUNTS = (4, 5, 8, 12, 14)


@dataclass(frozen=True)
class CameraIntrinsics:
    """
    Intrinsic parameters of a camera, in OpenCV's pinhole model.

    :param image_size: Width and height of the pictures that it holds for, in px.
    :param matrix: Shape (3, 3), [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], in px.
    :param distortion: Shape (4,), (5,), (8,), (12,) or (14,), in OpenCV's order.
    :raises InvalidValueError: If a value cannot be used.
    """

    image_size: ImageSize
    matrix: np.ndarray
    distortion: np.ndarray

    def __post_init__(self) -> None:
        """Check the values."""
        object.__setattr__(self, 'image_size', check_image_size(self.image_size))
        matrix = finite_numbers('camera_matrix', self.matrix, 3, 3)
        focal = np.diag(matrix)[:2]
        pinhole = np.diag([*focal, 1.0])
        pinhole[:2, 2] = matrix[:2, 2]
        if not (focal > 0).all() or not np.array_equal(matrix, pinhole):
            raise InvalidValueError(
                'camera_matrix must be [fx, 0, cx, 0, fy, cy, 0, 0, 1] with fx and fy above 0, '
                f'got {matrix.ravel().tolist()}')
        distortion = finite_numbers('distortion_coefficients', self.distortion, -1)
        if len(distortion) not in COEFFICIENT_COUNTS:
            raise InvalidValueError(
                f'distortion_coefficients must be {", ".join(map(str, COEFFICIENT_COUNTS))} '
                f'numbers, got {len(distortion)}')
        object.__setattr__(self, 'matrix', matrix)
        object.__setattr__(self, 'distortion', distortion)


class CameraPose(NamedTuple):
    """
    Position of a camera above the work surface.

    :param foot_cm: The point of the surface below it, x and y, in cm, in the camera frame.
    :param height_cm: How far above the surface it is, in cm.
    :param rms_px: Root mean square of the reprojection error, in px.
    """

    foot_cm: Tuple[float, float]
    height_cm: float
    rms_px: float


def camera_pose(matched: MatchedPoints, intrinsics: CameraIntrinsics) -> CameraPose:
    """
    Find where the camera is, by least squares in the picture.

    A plane seen with little perspective fits two tilts; both are refined, and the better one is
    returned.

    Source: T. Collins and A. Bartoli, Infinitesimal plane-based pose estimation, IJCV 2014.

    :param matched: Points on the surface, and pixels as the lens shows them, distorted.
    :raises CalibrationError: If the points do not determine it.
    """
    check_spread(matched)
    points = np.column_stack([matched.points, np.zeros(len(matched))])
    view = points, matched.pixels.copy(), intrinsics.matrix, intrinsics.distortion
    try:
        _, rotations, translations, _ = cv2.solvePnPGeneric(*view, flags=cv2.SOLVEPNP_IPPE)
        poses = [_refined(view, *start) for start in zip(rotations, translations)]
    except cv2.error:
        poses = []
    poses = [pose for pose in poses if np.isfinite([*pose.foot_cm, *pose[1:]]).all()]
    if not poses:
        raise CalibrationError('no camera with these intrinsics sees the points at these pixels: '
                               'are they those of this camera?')
    return min(poses, key=lambda pose: pose.rms_px)


def _refined(view, rotation, translation):
    rotation, translation = cv2.solvePnPRefineLM(*view, rotation, translation)
    points, pixels, matrix, distortion = view
    shown, _ = cv2.projectPoints(points, rotation, translation, matrix, distortion)
    with np.errstate(over='ignore', invalid='ignore'):
        rms_px = np.sqrt(np.mean(np.sum((shown[:, 0] - pixels) ** 2, axis=1)))
    x, y, z = (-cv2.Rodrigues(rotation)[0].T @ translation).ravel().tolist()
    # The surface's z points to the camera or away from it, depending on how x and y lie.
    return CameraPose((x, y), abs(z), float(rms_px))
