# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Matched points, and what follows from them: the hull, and the view from above."""

from dataclasses import dataclass
from typing import Callable, Sequence, Tuple

from camera_to_base.checks import finite_numbers, ImageSize
from camera_to_base.errors import CalibrationError, InvalidValueError
from camera_to_base.surface.models import Surface
import cv2
import numpy as np

# Points whose spread across a line is below this share of their spread along it lie on one line:
# for a table that is 300 px wide, 0.3 px.
LINE_TOLERANCE = 1e-3

# OpenCV computes with float32.
_LIMIT_PX = 1e6


@dataclass(frozen=True)
class MatchedPoints:
    """
    Positions on the surface with the pixels that show them.

    :param points: Shape (n, 2), columns x and y, in cm, in the camera frame.
    :param pixels: Shape (n, 2), columns u and v, in px.
    :param rows: What messages call the n points; 1 to n by default.
    :raises InvalidValueError: If shapes do not match, a value is not finite, or a point is there
        twice.
    """

    points: np.ndarray
    pixels: np.ndarray
    rows: Tuple[int, ...] = ()

    def __post_init__(self):
        for name in ('points', 'pixels'):
            object.__setattr__(self, name, _frozen(name, getattr(self, name), 2))
        if len(self.points) != len(self.pixels):
            raise InvalidValueError(f'expected as many points as pixels, got {len(self.points)} '
                                    f'points and {len(self.pixels)} pixels')
        object.__setattr__(self, 'rows', _checked_rows(self.rows, len(self.points)))
        refuse_duplicates(self.points, self.rows, 'position (x, y)')
        refuse_duplicates(self.pixels, self.rows, 'pixel (u, v)')

    def __len__(self):
        return len(self.points)

    def take(self, indices: Sequence[int]) -> 'MatchedPoints':
        """Return some of the points."""
        rows = tuple(self.rows[index] for index in indices)
        return MatchedPoints(self.points[indices], self.pixels[indices], rows)


@dataclass(frozen=True)
class PointPairs:
    """
    Points that the camera saw and the robot touched.

    :param camera_points: Shape (n, 3), in cm, in the camera frame.
    :param base_points: Shape (n, 3), in cm, in the base frame.
    :param rows: What messages call the n pairs; 1 to n by default.
    :raises InvalidValueError: If shapes do not match, a value is not finite, or a point is there
        twice.
    """

    camera_points: np.ndarray
    base_points: np.ndarray
    rows: Tuple[int, ...] = ()

    def __post_init__(self):
        for name in ('camera_points', 'base_points'):
            object.__setattr__(self, name, _frozen(name, getattr(self, name), 3))
        if len(self.camera_points) != len(self.base_points):
            raise InvalidValueError(
                f'expected pairs, got {len(self.camera_points)} points in the camera frame and '
                f'{len(self.base_points)} in the base frame')
        object.__setattr__(self, 'rows', _checked_rows(self.rows, len(self.base_points)))
        refuse_duplicates(self.camera_points, self.rows, 'camera point')
        refuse_duplicates(self.base_points, self.rows, 'base point')

    def __len__(self):
        return len(self.base_points)


def check_inside(matched: MatchedPoints, image_size: ImageSize) -> None:
    """
    Refuse pixels that a picture of this size does not have.

    :param image_size: Width and height, in px.
    :raises InvalidValueError: Naming the first row that lies outside.
    """
    width, height = image_size
    # A click on the picture's rim may be half a pixel outside the last pixel's centre.
    inside = ((matched.pixels >= -0.5) & (matched.pixels <= np.array([width, height]) - 0.5))
    outside = ~inside.all(axis=1)
    if outside.any():
        index = int(np.argmax(outside))
        u, v = matched.pixels[index]
        raise InvalidValueError(
            f'row {matched.rows[index]}: pixel ({u:g}, {v:g}) lies outside a picture of '
            f'{width} x {height} px: is that the size of the picture it was measured in?')


def check_spread(matched: MatchedPoints) -> None:
    """
    Refuse points that do not determine a homography: fewer than four, or all but one on a line.

    :raises CalibrationError: Saying which it is.
    """
    if len(matched) < 4:
        raise CalibrationError(f'{len(matched)} points are too few: give at least 4, no three of '
                               'them on one line, and 8 or more to correct the lens')
    for values, where in ((matched.points, 'surface'), (matched.pixels, 'picture')):
        if on_one_line(values):
            raise CalibrationError(f'all {len(values)} points lie on one line of the {where}: '
                                   'add points to both sides of it')
        alone = _others_on_one_line(values)
        if alone.any():
            raise CalibrationError(
                f'all points but row {matched.rows[int(np.argmax(alone))]} lie on one line of the '
                f'{where}: add a second point off that line')


def on_one_line(values: np.ndarray) -> bool:
    """
    Tell whether points lie on one line, or on one point.

    :param values: Shape (n, d).
    """
    spread = np.linalg.svd(values - values.mean(axis=0), compute_uv=False)
    return bool(spread[1] <= LINE_TOLERANCE * spread[0])


def _others_on_one_line(values):
    """Tell for each of n points (n, 2) whether all others lie on one line."""
    count, offsets = len(values), values - values.mean(axis=0)
    # The scatter of the others, about their own mean, from that of all: one pass for all n.
    scatter = offsets.T @ offsets - count / (count - 1) * offsets[:, :, None] * offsets[:, None]
    least, most = np.linalg.eigvalsh(scatter).T
    return least <= LINE_TOLERANCE ** 2 * most


def refuse_duplicates(values: np.ndarray, rows: Tuple[int, ...], name: str) -> None:
    """
    Refuse values that are there twice.

    :param values: Shape (n, d).
    :raises InvalidValueError: Naming the two rows and the value.
    """
    seen = {}
    for row, value in zip(rows, map(tuple, values.tolist())):
        if value in seen:
            shown = ', '.join(f'{number:g}' for number in value)
            raise InvalidValueError(f'rows {seen[value]} and {row} have the same {name} '
                                    f'({shown}): remove one of them')
        seen[value] = row


def _frozen(name, values, width):
    numbers = finite_numbers(name, values, -1, width)
    numbers.setflags(write=False)
    return numbers


def _checked_rows(rows, count):
    if rows and len(rows) != count:
        raise InvalidValueError(f'expected {count} row names, got {len(rows)}')
    return tuple(rows) or tuple(range(1, count + 1))


class Hull:
    """
    The convex hull of pixels.

    :param pixels: Shape (n, 2), columns u and v, in px.
    :raises InvalidValueError: If they do not span an area.
    """

    def __init__(self, pixels: np.ndarray) -> None:
        pixels = finite_numbers('hull', pixels, -1, 2)
        if np.abs(pixels).max(initial=0) > _LIMIT_PX:
            raise InvalidValueError(
                f'expected a hull of pixels within {_LIMIT_PX:g} px, got {pixels.tolist()}')
        pixels = pixels.astype(np.float32)
        self._outline = cv2.convexHull(pixels) if len(pixels) else pixels
        self.area = cv2.contourArea(self._outline) if len(pixels) else 0.0
        if not self.area > 0:
            raise InvalidValueError(
                f'expected a hull of at least three pixels that are not on one line, got {pixels}')

    @property
    def corners(self) -> np.ndarray:
        """Corners in the order of the outline, shape (n, 2), in px."""
        return self._outline.reshape(-1, 2).astype(float)

    def contains(self, pixel: Sequence[float]) -> bool:
        """
        Tell whether a pixel lies inside, or on the edge.

        :param pixel: u and v, in px.
        """
        return cv2.pointPolygonTest(self._outline, (float(pixel[0]), float(pixel[1])), False) >= 0


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
