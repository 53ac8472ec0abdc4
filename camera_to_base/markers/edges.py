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
The corners of a marker, to a few hundredths of a pixel: the crossings of lines along its edges.

Across an edge the light rises from the black border to the white margin. The step's place is taken
from the area below the profile, which blur does not move where the profile is of linear light: the
camera's gamma is undone. Of some dozens of places along an edge the line is fitted where the lens
has no distortion.
"""

from typing import Optional

from camera_to_base.markers.aruco import CELLS
from camera_to_base.surface import RadialDistortion
import cv2
import numpy as np

# Half the length of a profile: a share of a cell, within limits in px.
_PROFILE_SHARE, _LEAST_HALF_PX, _LARGEST_HALF_PX = 0.4, 1.5, 5.0
_STEP_PX = 0.5
# The ends of an edge are left out: there the profile shows the next edge.
_ALONG = np.linspace(0.1, 0.9, 40)
# A line through values along an edge, by least squares: values @ _SMOOTHER.
_LINE = np.vander(_ALONG, 2)
_SMOOTHER = (_LINE @ np.linalg.pinv(_LINE)).T
_MOST_ROUNDS, _STANDS_STILL_PX = 3, 0.2
# A place counts where it lies this near to its line, and an edge where most of its places count.
_OUTLIER, _LEAST_LIMIT_PX, _LARGEST_LIMIT_PX = 3.0, 0.08, 0.6
_LEAST_SHARE = 0.6
# Brightness of the margin minus that of the border, in grey levels.
_LEAST_CONTRAST = 15.0
# Of most cameras, and of sRGB.
_GAMMA = 2.2
_LIGHT = (np.arange(256) / 255) ** _GAMMA


def corners_by_edges(
    grey: np.ndarray, corners: np.ndarray, lens: RadialDistortion
) -> Optional[np.ndarray]:
    """
    Refine a marker's corners.

    :param grey: Shape (h, w), uint8.
    :param corners: Shape (4, 2), u and v, in px, a pixel or two off, clockwise as it is seen.
    :param lens: Edges are straight without its distortion.
    :returns: Shape (4, 2), in px; None if an edge is covered, or too faint.
    """
    edge_px = float(np.linalg.norm(corners - np.roll(corners, -1, axis=0), axis=1).min())
    half = min(max(_PROFILE_SHARE * edge_px / CELLS, _LEAST_HALF_PX), _LARGEST_HALF_PX)
    for _ in range(_MOST_ROUNDS):
        moved = _crossings(grey, corners, half, lens)
        if moved is None:
            return None
        step_px = float(np.linalg.norm(moved - corners, axis=1).max())
        if step_px > 2 * half:
            return None
        corners = moved
        if step_px < _STANDS_STILL_PX:
            break
    return corners


def _crossings(
    grey: np.ndarray, corners: np.ndarray, half: float, lens: RadialDistortion
) -> Optional[np.ndarray]:
    """Return where the lines along the edges cross, shape (4, 2), in px."""
    places = _step_places(grey, corners, half)
    if places is None:
        return None
    straight = lens.undistort(places.reshape(-1, 2)).reshape(places.shape)
    lines = _lines(straight)
    if lines is None:
        return None
    crossed = np.cross(np.roll(lines, 1, axis=0), lines)
    with np.errstate(all='ignore'):
        moved = lens.distort(crossed[:, :2] / crossed[:, 2:])
    return moved if np.isfinite(moved).all() else None


def _step_places(grey: np.ndarray, corners: np.ndarray, half: float) -> Optional[np.ndarray]:
    """Return where light rises across each edge, shape (4, n, 2), in px."""
    sides = np.roll(corners, -1, axis=0) - corners
    outwards = np.column_stack([sides[:, 1], -sides[:, 0]])
    outwards /= np.linalg.norm(sides, axis=1)[:, None]
    centres = corners[:, None] + _ALONG[:, None] * sides[:, None]
    steps = int(round(2 * half / _STEP_PX)) + 1
    offsets = np.linspace(-half, half, steps)
    profiles = _light(grey, centres[:, :, None] + offsets[:, None] * outwards[:, None, None])
    if profiles is None:
        return None
    ends = max(2, steps // 5)
    # Light changes little along an edge.
    dark = profiles[:, :, :ends].mean(axis=2) @ _SMOOTHER
    bright = profiles[:, :, -ends:].mean(axis=2) @ _SMOOTHER
    if (_grey_level(bright) - _grey_level(dark)).min() < _LEAST_CONTRAST:
        return None
    dark_share = (bright - profiles.mean(axis=2)) / (bright - dark)
    length = 2 * half * steps / (steps - 1)
    return centres + ((dark_share - 0.5) * length)[:, :, None] * outwards[:, None]


def _grey_level(light: np.ndarray) -> np.ndarray:
    return 255 * np.maximum(light, 0) ** (1 / _GAMMA)


def _light(grey: np.ndarray, places: np.ndarray) -> Optional[np.ndarray]:
    """Return the light at places (..., 2), 0 to 1; None if one is not in the picture."""
    flat = places.reshape(-1, 2)
    low, high = flat.min(axis=0), flat.max(axis=0)
    if not ((low >= 0).all() and (high <= np.subtract(grey.shape[::-1], 1)).all()):
        return None
    left, top = low.astype(int)
    right, bottom = high.astype(int) + 2
    part = _LIGHT[grey[top:bottom, left:right]].astype(np.float32)
    inside = (flat - (left, top)).astype(np.float32)
    # As rows of a picture that remap takes: fewer than 32,768 of each.
    found = cv2.remap(part, inside.reshape(places.shape[0], -1, 2), None, cv2.INTER_LINEAR,
                      borderMode=cv2.BORDER_REPLICATE)
    return found.reshape(places.shape[:-1]).astype(float)


def _lines(points: np.ndarray) -> Optional[np.ndarray]:
    """
    Fit a line to the points of each edge, without outliers.

    :param points: Shape (4, n, 2).
    :returns: Shape (4, 3), (a, b, c) with a x + b y + c = 0; None if points are in no line.
    """
    weights = np.ones(points.shape[:2])
    for _ in range(3):
        share = weights / weights.sum(axis=1)[:, None]
        centres = np.einsum('ij,ijk->ik', share, points)
        offsets = points - centres[:, None]
        xx, xy, yy = (np.einsum('ij,ij,ij->i', share, offsets[..., one], offsets[..., other])
                      for one, other in ((0, 0), (0, 1), (1, 1)))
        angles = np.arctan2(2 * xy, xx - yy) / 2
        normals = np.column_stack([-np.sin(angles), np.cos(angles)])
        away = np.abs(np.einsum('ijk,ik->ij', offsets, normals))
        limits = np.clip(_OUTLIER * 1.4826 * np.median(away, axis=1),
                         _LEAST_LIMIT_PX, _LARGEST_LIMIT_PX)
        weights = (away <= limits[:, None]).astype(float)
        if not (weights.mean(axis=1) >= _LEAST_SHARE).all():
            return None
    return np.column_stack([normals, -np.einsum('ik,ik->i', normals, centres)])
