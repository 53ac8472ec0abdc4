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

"""
The height's term: a face that is higher than the calibration says is seen farther from the camera.

A camera at height H above its foot point sees a point at height h at `seen`, and the point is at
foot + (seen - foot) (1 - h / H): an error of the height moves the position along the line to the
foot point, by the tangent of the viewing angle, |seen - foot| / H.
"""

from typing import Callable, NamedTuple, Tuple

from camera_to_base.image_size import ImageSize
import numpy as np

# Where the camera's height is not known, its lens is taken to see as far across as it is away from
# what it sees: 53 degrees, a usual webcam.
_FOCAL_WIDTHS = 1.0


class CameraPlace(NamedTuple):
    """
    Where the camera is above the surface.

    :param foot_cm: The point of the surface below it, x and y, in the camera frame.
    :param height_cm: Its height above the surface.
    """

    foot_cm: Tuple[float, float]
    height_cm: float


def height_slopes(points: np.ndarray, camera: CameraPlace) -> np.ndarray:
    """
    Return how positions move if an object is higher by 1 cm.

    :param points: Shape (n, 2), in cm, in the camera frame.
    :returns: Shape (n, 2), in cm for each cm.
    """
    return (np.asarray(camera.foot_cm) - points) / camera.height_cm


def likely_place(
    locate: Callable[[np.ndarray], np.ndarray], image_size: ImageSize
) -> CameraPlace:
    """
    Estimate where the camera is, for a lens of the usual angle of view.

    :param locate: Maps pixels (n, 2) to the surface (n, 2), near the picture's centre.
    """
    width, height = image_size
    centre, step = np.subtract(image_size, 1) / 2, 0.1 * min(image_size)
    corners = step * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], float)
    view_from_surface = _homography(locate(centre + corners), corners / (_FOCAL_WIDTHS * width))
    across, along, origin = view_from_surface.T
    scale = np.sqrt(np.linalg.norm(across) * np.linalg.norm(along))
    axes = np.column_stack([across, along, np.cross(across, along) / scale]) / scale
    x, y, z = -np.linalg.solve(axes, origin / scale)
    return CameraPlace((float(x), float(y)), float(max(abs(z), 1e-3)))


def _homography(points: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the homography that takes four points to four places, both (4, 2), with det > 0."""
    rows = []
    middle, size = points.mean(axis=0), np.abs(points - points.mean(axis=0)).max()
    for (x, y), (u, v) in zip((points - middle) / size, places):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y, -u], [0, 0, 0, x, y, 1, -v * x, -v * y, -v]]
    matrix = np.linalg.svd(np.array(rows))[2][-1].reshape(3, 3)
    matrix = matrix @ np.array([[1 / size, 0, -middle[0] / size],
                                [0, 1 / size, -middle[1] / size], [0, 0, 1]])
    return matrix if matrix[2] @ [*middle, 1.0] > 0 else -matrix
