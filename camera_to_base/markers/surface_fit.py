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
The surface computed anew from markers whose corners on it are known; the lens is kept.

Blur and the camera's gamma make all markers of a picture look smaller by the same fraction of a
pixel: that inset is fitted, too.
"""

from typing import Dict, NamedTuple, Tuple

from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.surface import HomographySurface, ImageSize, RadialDistortion
from camera_to_base.uncertainty import HOMOGRAPHY_NUMBERS, pooled_variance, warp_design
import cv2
import numpy as np

# The usual error of a corner's coordinate, that of the lens's model included, in pictures of this
# width; and how many residuals it is worth.
_EXPECTED_PX, _USUAL_WIDTH, _EXPECTED_WORTH = 0.1, 1280, 10.0
_ROUNDS = 3

Corners = Dict[int, np.ndarray]


class MarkerFit(NamedTuple):
    """
    A surface fitted to markers.

    :param surface: With the lens that was given.
    :param numbers: The markers that it was fitted to, n of them.
    :param pixels: Shape (4 n, 2), their corners in the picture, without the inset, in px.
    :param points: Shape (4 n, 2), their corners on the surface, in cm.
    :param gain: Shape (8, 8 n), how corners in px move the homography's numbers of the warp.
    :param rms_px: Root of the mean squared residual of a coordinate.
    :param variance: Of a corner's coordinate, in px².
    """

    surface: HomographySurface
    numbers: Tuple[int, ...]
    pixels: np.ndarray
    points: np.ndarray
    gain: np.ndarray
    rms_px: float
    variance: float


def fit_markers(
    known: Corners, seen: Corners, image_size: ImageSize, lens: RadialDistortion
) -> MarkerFit:
    """
    Fit a surface to the markers that are both known and seen.

    :param known: By number, shape (4, 2), x and y, in cm, in the camera frame.
    :param seen: By number, shape (4, 2), u and v, in px.
    :raises CalibrationError: If no camera sees the markers so.
    """
    numbers = tuple(sorted(set(known) & set(seen)))
    points = np.concatenate([known[number] for number in numbers])
    pixels = np.concatenate([seen[number] for number in numbers])
    outwards = outward_moves(pixels)
    design = warp_design(pixels, image_size, lens)[:, :, :HOMOGRAPHY_NUMBERS]
    columns = np.concatenate([design, outwards[:, :, None]], axis=2)
    gain = np.linalg.pinv(columns.reshape(-1, HOMOGRAPHY_NUMBERS + 1))
    inset = 0.0
    for _ in range(_ROUNDS):
        surface = _surface(points, lens.undistort(pixels + inset * outwards), image_size, lens)
        residuals = surface.pixels(points) - pixels - inset * outwards
        inset += float(gain[-1] @ residuals.ravel())
    freedom = max(residuals.size - HOMOGRAPHY_NUMBERS - 1, 1)
    squares = float(np.sum(residuals ** 2))
    expected = _EXPECTED_PX * scale_of(image_size)
    return MarkerFit(surface, numbers, pixels + inset * outwards, points, gain[:-1],
                     float(np.sqrt(squares / freedom)),
                     pooled_variance(squares, freedom, expected, _EXPECTED_WORTH))


def scale_of(image_size: ImageSize) -> float:
    """Return how much larger a length in px is than in a picture of the usual width."""
    return max(image_size[0] / _USUAL_WIDTH, 0.5)


def outward_moves(pixels: np.ndarray) -> np.ndarray:
    """
    Return how the corners of markers move if all their edges move outwards by 1 px.

    :param pixels: Shape (4 n, 2), clockwise as they are seen.
    :returns: The same shape.
    """
    quads = pixels.reshape(-1, 4, 2)
    sides = np.roll(quads, -1, axis=1) - quads
    normals = np.stack([sides[..., 1], -sides[..., 0]], axis=-1)
    normals /= np.linalg.norm(sides, axis=-1, keepdims=True)
    pairs = np.stack([np.roll(normals, 1, axis=1), normals], axis=-2)
    return np.linalg.solve(pairs, np.ones((*pairs.shape[:-1], 1)))[..., 0].reshape(-1, 2)


def _surface(
    points: np.ndarray, straight: np.ndarray, image_size: ImageSize, lens: RadialDistortion
) -> HomographySurface:
    homography, _ = cv2.findHomography(points, straight)
    try:
        surface = HomographySurface(np.linalg.inv(homography), image_size, lens)
        is_seen = bool(np.isfinite(surface.pixels(points)).all())
    except (TypeError, InvalidValueError, np.linalg.LinAlgError):
        is_seen = False  # findHomography returns None where there is none
    if not is_seen:
        raise CalibrationError('no camera sees the markers where they are in the picture')
    return surface
