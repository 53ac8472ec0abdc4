# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
What an upright object stands on, from its silhouette and the camera's place.

A camera at height H above its foot point C sees a point at height h farther from C by the factor
1 / (1 - h / H). An upright object of height h therefore covers, on each ray from C, what its
footprint covers and what that covers when it is moved outwards by this factor. If S is the
silhouette on the surface, side faces included and shadow not, the footprint is

    F = S ∩ (C + (S - C) (1 - h / H))

for every object with vertical sides that each ray enters once. Swept up to the height, F gives S
again, except on rays on which S is shorter than the sweep alone: no object of that height has such
a silhouette. The share of the silhouette's width, seen from the foot, that has a footprint is the
`fit`. It falls where the height is too large; a smaller height always fits.
"""

from dataclasses import dataclass
from typing import NamedTuple, Sequence

import cv2
import numpy as np

# Rays from the foot to a silhouette; closer together near its sides, where they touch it.
_RAYS = 64


@dataclass(frozen=True)
class Outline:
    """
    A polygon on the surface with its moments.

    :param corners: Shape (n, 2), x and y, in cm.
    :param area: In cm², 0 for none.
    :param centre: Shape (2,), the centroid, in cm.
    :param spread: Shape (2, 2), second central moments over the area, in cm².
    """

    corners: np.ndarray
    area: float
    centre: np.ndarray
    spread: np.ndarray

    @classmethod
    def of(cls, corners: np.ndarray) -> 'Outline':
        """Compute the moments of a polygon, shape (n, 2), in cm."""
        middle = corners.mean(axis=0)
        moments = cv2.moments((corners - middle).astype(np.float32))
        area = moments['m00']
        if not area > 0:
            return cls(corners, 0.0, middle, np.zeros((2, 2)))
        centre = middle + np.array([moments['m10'], moments['m01']]) / area
        mixed = moments['mu11']
        spread = np.array([[moments['mu20'], mixed], [mixed, moments['mu02']]]) / area
        return cls(corners, area, centre, spread)

    def size_along(self, angle: float) -> np.ndarray:
        """Return the extent along a direction, in rad, and across it: shape (2,), in cm."""
        along = np.array([np.cos(angle), np.sin(angle)])
        across = np.array([-along[1], along[0]])
        return np.ptp(self.corners @ np.column_stack([along, across]), axis=0)

    def narrowest_angle(self) -> float:
        """Return the direction of the length of the smallest rectangle around it, in rad."""
        _, (width, height), degrees = cv2.minAreaRect(
            (self.corners - self.centre).astype(np.float32))
        return float(np.deg2rad(degrees if width >= height else degrees + 90.0))


class Footprint(NamedTuple):
    """
    What an object of a height stands on.

    :param outline: On the surface.
    :param fit: The share of the silhouette's width that an object of the height can have, 0 to 1.
    """

    outline: Outline
    fit: float


class RayedSilhouette:
    """
    A silhouette on the surface, cut by rays from the camera's foot.

    :param corners: Shape (n, 2), x and y of its outline, in cm.
    :param foot_cm: The point of the surface below the camera, shape (2,), in cm.
    """

    def __init__(self, corners: np.ndarray, foot_cm: Sequence[float]) -> None:
        self._foot = np.asarray(foot_cm, float)
        offsets = corners - self._foot
        angles = np.unwrap(np.arctan2(offsets[:, 1], offsets[:, 0]), period=2 * np.pi)
        turn = angles[-1] - angles[0]
        turn += (angles[0] - angles[-1] + np.pi) % (2 * np.pi) - np.pi
        self._surrounds_foot = abs(turn) > np.pi
        if self._surrounds_foot:
            rays = 2 * np.pi * np.arange(_RAYS) / _RAYS
        else:
            low, high = angles.min(), angles.max()
            rays = (low + high) / 2 - (high - low) / 2 * np.cos(
                np.pi * (np.arange(_RAYS) + 0.5) / _RAYS)
        self._directions = np.column_stack([np.cos(rays), np.sin(rays)])
        self._near, self._far = self._cut(offsets)
        self._weights = np.gradient(rays) / np.gradient(rays).sum()

    def footprint(self, height_share: float) -> Footprint:
        """
        Return what an object of a height stands on.

        :param height_share: The object's height as a share of the camera's, 0 to below 1.
        """
        far = self._far * (1.0 - height_share)
        stands = far > self._near
        fit = float(self._weights[stands].sum())
        near, far = self._near[stands, None], far[stands, None]
        rays = self._directions[stands]
        if self._surrounds_foot:
            corners = far * rays
        else:
            corners = np.concatenate([far * rays, (near * rays)[::-1]])
        if len(corners) < 3:
            return Footprint(Outline(corners, 0.0, self._foot, np.zeros((2, 2))), fit)
        return Footprint(Outline.of(self._foot + corners), fit)

    def tallest(self, fit: float) -> float:
        """Return the largest height that fits at least so well, as a share of the camera's."""
        heights = 1.0 - self._near / self._far
        order = np.argsort(-heights)
        reached = np.searchsorted(np.cumsum(self._weights[order]), fit)
        return float(heights[order[min(reached, len(order) - 1)]])

    def near_rim(self, height_share: float) -> np.ndarray:
        """
        Return where the near rim of the top of an object of a height is seen.

        :param height_share: The object's height as a share of the camera's, 0 to below 1.
        :returns: Shape (3, n, 2), in cm, on the n rays that an object of the height can have:
            where each enters the silhouette, where it meets the rim, and where it leaves. There
            are none of an object above the camera's foot, whose sides are not seen.
        """
        rim = self._near / (1.0 - height_share)
        stands = (rim < self._far) & (self._near > 0.0)
        distances = np.stack([self._near, rim, self._far])[:, stands, None]
        return self._foot + distances * self._directions[stands]

    def near_foot(self, height_share: float) -> np.ndarray:
        """
        Return where the near side of an object of a height ends, if the silhouette is its top.

        :param height_share: The object's height as a share of the camera's, 0 to below 1.
        :returns: Shape (3, n, 2), in cm: a place before the side's lower end on each of n rays,
            that end, and where the ray enters the silhouette. There are none of an object above
            the camera's foot.
        """
        stands, below = self._near > 0.0, 1.0 - height_share
        distances = np.stack([self._near * below ** 2, self._near * below, self._near])
        return self._foot + distances[:, stands, None] * self._directions[stands]

    def _cut(self, offsets: np.ndarray) -> np.ndarray:
        """Return where each ray enters the silhouette and where it leaves: (2, rays), in cm."""
        (x, y), (c, s) = offsets.T, self._directions.T
        along, beside = np.outer(c, x) + np.outer(s, y), np.outer(c, y) - np.outer(s, x)
        next_along, next_beside = np.roll(along, -1, axis=1), np.roll(beside, -1, axis=1)
        crosses = (beside > 0) != (next_beside > 0)
        with np.errstate(divide='ignore', invalid='ignore'):
            distance = along + beside / (beside - next_beside) * (next_along - along)
        crosses &= distance > 0
        far = np.where(crosses, distance, 0.0).max(axis=1)
        if self._surrounds_foot:
            return np.stack([np.zeros(_RAYS), far])
        return np.stack([np.minimum(np.where(crosses, distance, np.inf).min(axis=1), far), far])
