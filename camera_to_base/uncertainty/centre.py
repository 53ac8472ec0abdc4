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
The detection's term: how far an object's centre in the picture is off.

A pixel on the rim shows by its level how much of it the object covers. Noise makes this share
uncertain: noise / contrast, for each pixel of the rim. A blurred edge has more such pixels. The
centre is the mean over the whole area, so the error of a large object is small: for a disc of
20 px radius, 2 levels of noise and a contrast of 100 levels, 0.004 px. What light does (shade
beside the object, a highlight, a shining edge) is larger and does not follow from the picture:
for that there is a floor, a parameter.

All is about single objects, in floats: they are faster than arrays for so few numbers.
"""

import math
from typing import NamedTuple, Tuple

# A missing part may be as large as the object: its radius is twice the root of its second moment.
_MISSING_PART = 4.0
# Closing and median of the tutorial's method move the outline by this much, see the benchmark of
# detection.
TUTORIAL_FLOOR_PX = 1.5
# Where contrast or noise is not known.
_UNKNOWN_SHARE_NOISE = 0.1
# A direction that is not known is anywhere between -180 and 180 degrees.
UNKNOWN_ANGLE = math.pi ** 2 / 3


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
    """

    pixel: Tuple[float, float]
    area: float
    spread: Spread
    contrast: float = math.nan
    edge_width: float = 1.0
    is_cut_off: bool = False
    has_yaw: bool = False


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
