# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The terms of a position's uncertainty: the warp, the centre, the height and the view.

Whatever the model of the surface is, its error is described as if the picture was warped before
it is mapped: by a homography close to the identity (eight numbers) and by a lens that differs from
the calibrated one (six: the coefficient of the division model, its centre, a radial term of the
fifth power, and two of a lens that is not centred). All numbers are without a unit: lengths are in
halves of the picture's diagonal, from its centre.

A pixel on the rim shows by its level how much of it the object covers. Noise makes this share
uncertain: noise / contrast, for each pixel of the rim. A blurred edge has more such pixels. The
centre is the mean over the whole area, so the error of a large object is small: for a disc of
20 px radius, 2 levels of noise and a contrast of 100 levels, 0.004 px. What light does (shade
beside the object, a highlight, a shining edge) is larger and does not follow from the picture:
for that there is a floor, a parameter.

All is about single objects, in floats: they are faster than arrays for so few numbers.

A camera at height H above its foot point sees a point at height h at `seen`, and the point is at
foot + (seen - foot) (1 - h / H): an error of the height moves the position along the line to the
foot point, by the tangent of the viewing angle, |seen - foot| / H.
"""

import math
from typing import Callable, NamedTuple, Optional, Protocol, Tuple

from camera_to_base.checks import ImageSize
from camera_to_base.coordinate_transform import CameraPlace
import numpy as np

HOMOGRAPHY_NUMBERS, WARP_NUMBERS = 8, 14

# A missing part may be as large as the object: its radius is twice the root of its second moment.
_MISSING_PART = 4.0
# Closing and median of the tutorial's method move the outline by this much, see the benchmark of
# detection.
TUTORIAL_FLOOR_PX = 1.5
# Where contrast or noise is not known.
_UNKNOWN_SHARE_NOISE = 0.1
# A direction that is not known is anywhere between -180 and 180 degrees.
UNKNOWN_ANGLE = math.pi ** 2 / 3

# Where the camera's height is not known, its lens is taken to see as far across as it is away from
# what it sees: 53 degrees, a usual webcam.
_FOCAL_WIDTHS = 1.0

# The mean is taken over about so many frames.
_FRAMES = 30.0


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


class Spread(NamedTuple):
    """A symmetric matrix of shape (2, 2), of u and v: second moments or a covariance, in px²."""

    uu: float
    uv: float
    vv: float


class Shape(NamedTuple):
    """
    What the picture tells of an object.

    :param pixel: Its centre, u and v, in px.
    :param area: In px².
    :param spread: Second central moments over the area.
    :param contrast: Difference to the surface, grey levels; NaN for not known.
    :param edge_width: From the surface's level to the object's, in px.
    :param is_cut_off: Whether a part may be missing.
    :param has_yaw: Whether it has a direction.
    :param height_cm: Its height; 0 for a flat object, whose face is at the height's tolerance.
    :param misfit_cm: Standard deviation of x and y because it is no upright object.
    :param doubt_px: Standard deviation of the centre because a part may be light or not be seen.
    """

    pixel: Tuple[float, float]
    area: float
    spread: Spread
    contrast: float = math.nan
    edge_width: float = 1.0
    is_cut_off: bool = False
    has_yaw: bool = False
    height_cm: float = 0.0
    misfit_cm: float = 0.0
    doubt_px: float = 0.0


def centre_covariance(shape: Shape, noise: float, floor_px: float) -> Spread:
    """
    Return the covariance of a centre.

    :param noise: Deviation of the sensor's noise, grey levels; NaN for not known.
    :param floor_px: Standard deviation of u and of v that light causes, in px.
    """
    uu, uv, vv = shape.spread
    # A rim pixel moves the centre by its offset / area; the offsets' second moment along the rim
    # is twice that over the area, as for a disc.
    rim_pixels = 2 * math.pi * math.sqrt(2 * max(uu + vv, 0.0)) * shape.edge_width
    factor = 2 * rim_pixels * (_share_noise(shape.contrast, noise) / max(shape.area, 1.0)) ** 2
    if shape.is_cut_off:
        factor += _MISSING_PART
    floor = floor_px * floor_px
    return Spread(factor * uu + floor, factor * uv, factor * vv + floor)


def yaw_variance(shape: Shape, covariance: Spread) -> float:
    """
    Return the variance of an object's direction in the picture.

    The error of an end is that of the centre, and its lever arm the root of the larger second
    moment. The rounder the object, the more a given error turns the axis.

    :param covariance: Of the centre.
    :returns: In rad²; pi²/3 for an object without a direction.
    """
    uu, uv, vv = shape.spread
    apart = math.hypot((uu - vv) / 2, uv)
    long = (uu + vv) / 2 + apart
    if not (shape.has_yaw and apart > 1e-6 * long > 0):
        return UNKNOWN_ANGLE
    error = (covariance.uu + covariance.vv) / 2
    return min(error / long * (long / (2 * apart)) ** 2, UNKNOWN_ANGLE)


def _share_noise(contrast: float, noise: float) -> float:
    if math.isfinite(contrast) and math.isfinite(noise) and contrast > 0:
        return min(noise / contrast, 1.0)
    return _UNKNOWN_SHARE_NOISE


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


class ShiftMean:
    """
    The mean square of the shifts that were measured and not corrected, over the last frames.

    The shift of a single frame says how far the picture has moved, not where to; a mean over
    frames says how large such shifts are.
    """

    def __init__(self) -> None:
        self._square = 0.0
        self._count = 0.0

    @property
    def deviation_px(self) -> float:
        """Standard deviation of each of u and v, in px; 0 before the first frame."""
        return (self._square / 2) ** 0.5

    def add(self, shift_px: float) -> None:
        """Add a frame's shift, in px."""
        self._count = min(self._count + 1, _FRAMES)
        self._square += (shift_px ** 2 - self._square) / self._count
