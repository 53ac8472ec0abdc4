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

"""A surface as the homography that the parameters can hold, and whether two surfaces are one."""

from typing import Optional, Tuple

from camera_to_base.errors import HorizonError
from camera_to_base.image_size import ImageSize
from camera_to_base.surface.distortion import RadialDistortion
from camera_to_base.surface.models import HomographySurface, Surface
import cv2
import numpy as np

# Surfaces are compared at so many places of the picture, and are the same to this many cm.
_PLACES, _SAME_CM = 5, 1e-4
# Where the picture shows the horizon, the places lie closer to its centre, by halves.
_SHARES = 1.0, 0.5, 0.25, 0.125


def as_homography(surface: Surface, size: ImageSize) -> Optional[HomographySurface]:
    """
    Give a surface as a homography with the surface's lens.

    :param surface: For objects without a height.
    :param size: Width and height of the pictures, in px.
    :returns: None where it is none, as the polynomial.
    :raises FrameSizeError: If the surface does not hold for that size.
    """
    surface = surface.for_image_size(size)
    pixels, points = _located(surface, size)
    lens = surface.distortion or RadialDistortion.of_picture(size)
    if not len(pixels):
        return None
    matrix, _ = cv2.findHomography(lens.undistort(pixels), points)
    if matrix is None:
        return None
    found = HomographySurface(matrix, size, lens)
    return found if _agree(found.locate(pixels), points) else None


def is_same_surface(one: Surface, other: Surface, size: ImageSize) -> bool:
    """
    Tell whether two surfaces give the same points.

    :param size: Width and height of the pictures, in px.
    :raises FrameSizeError: If one does not hold for that size.
    """
    pixels, points = _located(one.for_image_size(size), size)
    try:
        return len(pixels) > 0 and _agree(other.for_image_size(size).locate(pixels), points)
    except HorizonError:
        return False


def _located(surface: Surface, size: ImageSize) -> Tuple[np.ndarray, np.ndarray]:
    # Places of the picture that show the surface, and their points; none where none do.
    centre = (np.array(size, float) - 1) / 2
    lines = np.linspace(-1, 1, _PLACES)
    offsets = np.stack(np.meshgrid(lines, lines), axis=2).reshape(-1, 2) * centre
    for share in _SHARES:
        try:
            return centre + share * offsets, surface.locate(centre + share * offsets)
        except HorizonError:
            continue
    return np.empty((0, 2)), np.empty((0, 2))


def _agree(points: np.ndarray, others: np.ndarray) -> bool:
    return bool(np.abs(points - others).max() <= _SAME_CM)
