# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
The height and the footprint of an object from its silhouettes.

A camera at height H above its foot C sees an upright object of height h as its footprint, swept
away from C. Of a convex object, how far the silhouette reaches in a direction, counted from C, is

    the footprint's reach where that is negative: the side that faces the camera
    the footprint's reach / (1 - h / H) where it is positive: the far side, and the top

So each camera says of each direction how far the footprint reaches, and what it says is linear in
the height:

    footprint(h) = C + seen - h max(seen, 0) / H

The height at which the cameras agree is a least squares problem of a few numbers: the height, and
how far each camera's silhouettes are off as a whole, of which the calibrations give the
covariance. One camera alone needs to be told the height.

A camera may lack a part, as a white side on a white table. Directions in which the footprints stay
apart lose their weight, as in a fit with Cauchy's distribution, and the largest footprint counts.
"""

from dataclasses import dataclass
import math
from typing import NamedTuple, Optional, Sequence

from camera_to_base.coordinate_transform import CameraPlace
from camera_to_base.fusion.shape import (
    COUNT, DIRECTIONS, Extent, extent_of, Moments, moments_of, notch, outline_of, reach)
import numpy as np

# Standard deviation of an outline.
OUTLINE_PX = 0.3
# Where a pixel is 0.7 mm wide, and how exact the best outline is.
_OUTLINE_CM, _BEST_OUTLINE_CM = 0.02, 0.005
# Outlines are off alike in neighbouring directions: so many directions are independent.
_INDEPENDENT = 8.0
# The weights have settled after so many rounds, or once the height changes by less.
_ROUNDS, _SETTLED_CM = 12, 0.002
# Keeps a covariance of zeros, as of a simulated camera, invertible.
_LEAST_CM2 = 1e-8


class Viewpoint(NamedTuple):
    """
    Where a camera is.

    :param place: In the coordinate frame of the silhouettes.
    :param covariance: Of the foot point's x and y and of the height, shape (3, 3), in cm².
    """

    place: CameraPlace
    covariance: np.ndarray


class SeenOutline(NamedTuple):
    """
    What a camera sees of an object.

    :param corners: Its silhouette on the surface, side faces included, shape (n, 2), in cm.
    :param covariance: Of where it is as a whole, shape (2, 2), in cm²: calibration and picture.
    :param viewpoint: The camera's.
    :param noise_cm: Standard deviation of a part of the outline.
    """

    corners: np.ndarray
    covariance: np.ndarray
    viewpoint: Viewpoint
    noise_cm: float = _OUTLINE_CM


class KnownHeight(NamedTuple):
    """A height, in cm, and its standard deviation."""

    height_cm: float
    deviation_cm: float


@dataclass(frozen=True)
class Solution:
    """
    An object as the cameras see it together.

    :param height: With the standard deviation of what the cameras say about it.
    :param moments: Of its footprint.
    :param extent: Of its footprint.
    :param covariance: Of the footprint's centre, shape (2, 2), in cm².
    :param agreement: Share of the outline in which the cameras agree to within twice the noise.
    :param misfit_cm: How far two cameras' footprints are apart: the root of the mean square.
    :param notch_cm: How deep the silhouettes are notched, in the mean of the cameras.
    :param strain: How far each camera's silhouette had to be moved, as the square over its
        covariance; 4.6 and more for one in ten.
    :param cost: Twice the negative logarithm of how likely this is.
    """

    height: KnownHeight
    moments: Moments
    extent: Extent
    covariance: np.ndarray
    agreement: float
    misfit_cm: float
    notch_cm: float
    strain: np.ndarray
    cost: float


def solve(seen: Sequence[SeenOutline], known: Optional[KnownHeight] = None) -> Solution:
    """
    Find the height and the footprint of an object.

    :param seen: Its silhouettes, of one camera each.
    :param known: Its height, where it is known; one camera alone needs it.
    """
    problem = _Problem(seen)
    found = problem.solved(known)
    if found[0] < 0:  # No object is below the surface: what is seen is flat.
        deviation = math.sqrt(problem.covariance[0, 0])
        found = problem.solved(KnownHeight(0.0, 1e-3))
        return problem.solution(found, deviation)
    return problem.solution(found, math.sqrt(problem.covariance[0, 0]))


class _Problem:
    """
    The least squares problem: unknown are the height, and for each camera how far it is off.

    Directions in which the cameras cannot agree lose their weight: a part is missing there.
    `covariance` is that of the numbers that were found last.
    """

    def __init__(self, seen: Sequence[SeenOutline]) -> None:
        self._seen = seen
        self.count = len(seen)
        noises = [max(one.noise_cm, _BEST_OUTLINE_CM) for one in seen]
        self._noise = math.sqrt(sum(noise ** 2 for noise in noises) / self.count)
        self._reach, self._slopes = self._seen_along(DIRECTIONS)
        self._design = np.zeros((self.count, COUNT, 1 + 2 * self.count))
        self._design[:, :, 0] = self._slopes
        for number in range(self.count):
            self._design[number, :, 1 + 2 * number:3 + 2 * number] = DIRECTIONS
        self._rows = self._design - self._design.mean(axis=0)
        self._apart = self._reach - self._reach.mean(axis=0)
        self._weights, self._strain = np.ones(COUNT), np.zeros(self.count)
        self.covariance = np.eye(1 + 2 * self.count)

    def solved(self, known: Optional[KnownHeight]) -> np.ndarray:
        """Return the height and the cameras' errors: shape (1 + 2 cameras,), in cm."""
        before, self._weights = math.inf, np.ones(COUNT)
        found = self._solved(known, 0.0)
        for _ in range(_ROUNDS):
            if abs(found[0] - before) < _SETTLED_CM:
                break
            before = found[0]
            self._weights = self._trust(self._apart - self._rows @ found, self._noise)
            found = self._solved(known, max(before, 0.0))
        errors, height = found[1:].reshape(self.count, 2), max(float(found[0]), 0.0)
        self._strain = np.array([error @ np.linalg.solve(self._prior(one, height), error)
                                 for error, one in zip(errors, self._seen)])
        return found

    def solution(self, found: np.ndarray, height_deviation: float) -> Solution:
        """Make the footprint of the numbers that were found."""
        footprints = self._reach - self._design @ found
        reached = self._joined(footprints)
        moments = moments_of(outline_of(reached))
        # The centre moves with the height, with each camera's error, and with what one lacks.
        moves = np.column_stack([
            -2 / COUNT * (self._slopes.mean(axis=0) @ DIRECTIONS),
            *[-np.eye(2) / self.count] * self.count])
        lacking = 2 / COUNT * (reached - footprints.mean(axis=0)) @ DIRECTIONS
        covariance = moves @ self.covariance @ moves.T + np.eye(2) * (
            self._noise ** 2 / self.count) + np.outer(lacking, lacking)
        agreement = self._trust(footprints - footprints.mean(axis=0), 2 * self._noise).mean()
        misfit = math.sqrt(2 * footprints.var(axis=0).mean())
        return Solution(
            KnownHeight(float(found[0]), height_deviation), moments,
            extent_of(lambda directions: self._footprint(found, directions), moments),
            covariance, float(agreement), misfit,
            float(np.mean([notch(one.corners) for one in self._seen])), self._strain,
            float(self._strain.sum() - 2 * _INDEPENDENT * np.log(self._weights).mean()))

    def _solved(self, known: Optional[KnownHeight], height_cm: float) -> np.ndarray:
        weights = _INDEPENDENT / COUNT / self._noise ** 2 * self._weights
        rows = self._rows.reshape(-1, 1 + 2 * self.count)
        weighted = (self._rows * weights[:, None]).reshape(rows.shape)
        normal, right = weighted.T @ rows, weighted.T @ self._apart.ravel()
        seen = normal.copy()
        for number, one in enumerate(self._seen):
            own = slice(1 + 2 * number, 3 + 2 * number)
            normal[own, own] += np.linalg.inv(self._prior(one, height_cm))
        if known is not None:
            normal[0, 0] += known.deviation_cm ** -2
            right[0] += known.height_cm * known.deviation_cm ** -2
        inverse = np.linalg.inv(normal)
        # Twice the noise: corners are rounded and feet are in a shadow, in all outlines alike.
        self.covariance = inverse + inverse @ seen @ inverse
        return inverse @ right

    def _trust(self, apart: np.ndarray, noise_cm: float) -> np.ndarray:
        """
        Return how much each direction counts: half where the cameras are apart by their noise.

        :param apart: Each camera's footprint from their mean, shape (cameras, n), in cm.
        """
        squares = (apart ** 2).sum(axis=0) / max(self.count - 1, 1)
        return 1 / (1 + squares / noise_cm ** 2)

    def _joined(self, footprints: np.ndarray) -> np.ndarray:
        """Return how far the object reaches: where a camera lacks a part, as the others see it."""
        mean = footprints.mean(axis=0)
        trust = self._trust(footprints - mean, self._noise)
        return mean + (1 - trust) * (footprints.max(axis=0) - mean)

    def _prior(self, one: SeenOutline, height_cm: float) -> np.ndarray:
        """Return how far a camera's footprint may be off as a whole: (2, 2), in cm²."""
        place, covariance = one.viewpoint
        away = (one.corners.mean(axis=0) - place.foot_cm) / place.height_cm
        # The near side stays where it is seen, the far side moves with the camera.
        moves = height_cm / place.height_cm / 2 * np.column_stack([np.eye(2), away])
        return one.covariance + moves @ covariance @ moves.T + _LEAST_CM2 * np.eye(2)

    def _seen_along(self, directions: np.ndarray):
        """Return each camera's reach, and by how much less it is for a height of 1 cm."""
        reached = np.array([reach(one.corners, directions) for one in self._seen])
        places = [one.viewpoint.place for one in self._seen]
        feet = np.array([directions @ place.foot_cm for place in places])
        heights = np.array([[place.height_cm] for place in places])
        return reached, np.maximum(reached - feet, 0.0) / heights

    def _footprint(self, found: np.ndarray, directions: np.ndarray) -> np.ndarray:
        reached, slopes = self._seen_along(directions)
        errors = found[1:].reshape(self.count, 2) @ directions.T
        return self._joined(reached - slopes * found[0] - errors)
