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
"""Where a camera stands that was moved: its focal length is that of the calibrated view."""

from typing import List, Tuple

from camera_to_base.parameters import Values
from camera_to_base.surface import HomographySurface, Surface
import numpy as np

# Focal lengths that are tried, in widths of the picture: from fish-eyes to telephoto lenses.
_FOCAL = np.geomspace(0.3, 10, 300)
# The calibrated view shows the calibrated place to this share of the height, or the two do not
# belong together.
_LARGEST_MISS = 0.2
UNKNOWN: Tuple[List[float], float] = ([], 0.0)


def moved_place(
    values: Values, calibrated: Surface, moved: HomographySurface
) -> Tuple[List[float], float]:
    """
    Return where a camera stands after a move: the point below it, and its height, in cm.

    :param values: The calibration's parameters, by full name, with the camera's height.
    :param calibrated: The flat surface of these parameters.
    :param moved: The surface after the move.
    :returns: UNKNOWN where it cannot be computed.
    """
    if not isinstance(calibrated, HomographySurface) or not values['surface.camera_foot_cm']:
        return UNKNOWN
    known = np.array([*values['surface.camera_foot_cm'], values['surface.camera_height_cm']])
    width = moved.image_size[0]
    misses = [_miss(calibrated, factor * width, known) for factor in _FOCAL]
    best = int(np.argmin(misses))
    if misses[best] > _LARGEST_MISS * known[2]:
        return UNKNOWN
    fine = _FOCAL[best] * np.linspace(0.98, 1.02, 41)
    focal = width * min(fine, key=lambda factor: _miss(calibrated, factor * width, known))
    x, y, height_cm = _place(moved, focal).tolist()
    return [round(x, 4), round(y, 4)], round(height_cm, 4)


def _miss(surface: HomographySurface, focal_px: float, known: np.ndarray) -> float:
    return float(np.linalg.norm(_place(surface, focal_px) - known))


def _place(surface: HomographySurface, focal_px: float) -> np.ndarray:
    """Return x and y of the foot point, and the height, for a focal length."""
    homography = np.linalg.inv(surface.surface_from_pixel)
    u, v = surface.distortion.centre
    camera = np.array([[focal_px, 0, u], [0, focal_px, v], [0, 0, 1]])
    first, second, third = np.linalg.solve(camera, homography).T
    scale = np.sqrt(np.linalg.norm(first) * np.linalg.norm(second))
    along_x, along_y, displacement = first / scale, second / scale, third / scale
    normal = np.cross(along_x, along_y)
    return np.array([-along_x @ displacement, -along_y @ displacement,
                     abs(normal @ displacement)])
