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
The error of a calibration as a small warp of the picture.

Whatever the model of the surface is, its error is described as if the picture was warped before
it is mapped: by a homography close to the identity (eight numbers) and by a lens that differs from
the calibrated one (six: the coefficient of the division model, its centre, a radial term of the
fifth power, and two of a lens that is not centred). All numbers are without a unit: lengths are in
halves of the picture's diagonal, from its centre.
"""

from typing import Optional, Protocol, Tuple

from camera_to_base.image_size import ImageSize
import numpy as np

HOMOGRAPHY_NUMBERS, WARP_NUMBERS = 8, 14


class Lens(Protocol):
    """
    The calibrated lens, in the division model: a `RadialDistortion` of the room `surface`.

    `coefficient` is that of surface.homography.distortion_coefficient, 0 for none; `centre` is u
    and v, in px.
    """

    coefficient: float
    centre: Tuple[float, float]


def picture_radius(image_size: ImageSize) -> float:
    """Return half the picture's diagonal, in px."""
    return float(np.hypot(*image_size) / 2)


def warp_design(
    pixels: np.ndarray, image_size: ImageSize, lens: Optional[Lens]
) -> np.ndarray:
    """
    Return how each number of the warp moves pixels.

    :param pixels: Shape (n, 2), columns u and v, in px, as the lens shows them.
    :param lens: None for one without distortion.
    :returns: Shape (n, 2, 14), in px.
    """
    picture_centre = np.subtract(image_size, 1) / 2
    coefficient, centre = (
        (0.0, picture_centre) if lens is None else (lens.coefficient, lens.centre))
    radius = picture_radius(image_size)
    offsets = (np.asarray(pixels, float) - centre) / radius
    squares = np.einsum('ij,ij->i', offsets, offsets)[:, None]
    scale = 1 / (1 + coefficient * squares)
    # Derivative of the undistorted pixel by the pixel.
    slope = (scale[:, :, None] * _UNIT
             - 2 * coefficient * (scale ** 2 * offsets)[:, :, None] * offsets[:, None])
    middle = (picture_centre - centre) / radius
    design = np.empty((len(pixels), 2, WARP_NUMBERS))
    _fill_homography(design, offsets * scale - middle)
    design[:, :, 8] = -offsets * scale ** 2 * squares
    design[:, :, 9:11] = _UNIT - slope
    design[:, :, 11] = offsets * squares ** 2
    design[:, :, 12:] = squares[:, :, None] * _UNIT + 2 * offsets[:, :, None] * offsets[:, None]
    return radius * np.linalg.solve(slope, design)


_UNIT = np.eye(2)


def _fill_homography(design: np.ndarray, places: np.ndarray) -> None:
    """Write how a homography close to the identity moves places (n, 2), in the columns 0 to 7."""
    design[:, 0, 0:2], design[:, 0, 2], design[:, 0, 3:6] = places, 1.0, 0.0
    design[:, 1, 3:5], design[:, 1, 5], design[:, 1, 0:3] = places, 1.0, 0.0
    design[:, :, 6:8] = -places[:, :, None] * places[:, None]
