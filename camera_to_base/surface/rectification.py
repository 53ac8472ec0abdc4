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

"""Rectify a picture: the work surface seen from straight above."""

from typing import Callable, Tuple

from camera_to_base.surface.matched_points import MatchedPoints
from camera_to_base.surface.models import Surface
import cv2
import numpy as np


def surface_extent(points: np.ndarray, margin_cm: float) -> np.ndarray:
    """
    Return the rectangle around points, including the origin if it is near.

    :param points: Shape (n, 2), in cm.
    :param margin_cm: Margin on each side, in cm.
    :returns: Shape (2, 2): the least x and y, and the greatest, in cm.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    if (low <= high - low).all() and (-high <= high - low).all():
        low, high = np.minimum(low, 0), np.maximum(high, 0)
    return np.array([low - margin_cm, high + margin_cm])


def top_view(
    image: np.ndarray, surface: Surface, matched: MatchedPoints, extent: np.ndarray, height: int
) -> Tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]:
    """
    Show a rectangle of the surface from above, not mirrored, from the camera's side.

    :param image: Shape (h, w, 3), uint8.
    :param surface: Anything with `pixels`.
    :param matched: Points with pixels, which say whether the camera frame's y turns left or right.
    :param extent: Shape (2, 2), see `surface_extent`.
    :param height: In px.
    :returns: The picture, shape (height, w, 3), with w at most 2 height; and the function from
        points in cm, shape (n, 2), to its pixels.
    """
    low, high = extent
    scale = min(height / (high - low)[1], 2 * height / (high - low)[0])
    width = max(int(round(scale * (high - low)[0])), height // 2)
    margin = (np.array([width, height]) - scale * (high - low)) / 2
    # y runs down the picture where the camera sees it clockwise from x, up where not.
    y_sign = 1.0 if sees_y_clockwise(matched) else -1.0
    corner = np.array([low[0], low[1] if y_sign > 0 else high[1]])
    axes = scale * np.array([1.0, y_sign])

    def project(points):
        return (np.asarray(points, float) - corner) * axes + margin - 0.5

    v, u = np.mgrid[:height, :width].astype(float)
    points = (np.stack([u, v], axis=-1).reshape(-1, 2) - margin + 0.5) / axes + corner
    source = surface.pixels(points).reshape(height, width, 2)
    source = np.where(np.isfinite(source), source, -1e4).clip(-1e4, 1e4).astype(np.float32)
    return cv2.remap(image, source[..., 0], source[..., 1], cv2.INTER_LINEAR), project


def sees_y_clockwise(matched: MatchedPoints) -> bool:
    """Tell whether the camera sees y a quarter turn clockwise from x, as u and v are."""
    points = matched.points - matched.points.mean(axis=0)
    pixels = matched.pixels - matched.pixels.mean(axis=0)
    affine = np.linalg.lstsq(points, pixels, rcond=None)[0]
    return bool(np.linalg.det(affine) > 0)
