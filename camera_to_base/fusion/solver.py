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
"""

from dataclasses import dataclass
import math
from typing import NamedTuple, Optional, Sequence

from camera_to_base.coordinate_transform import CameraPlace
from camera_to_base.fusion.shape import (
    COUNT, DIRECTIONS, Extent, extent_of, Moments, moments_of, outline_of, reach)
import numpy as np

# Standard deviation of an outline that was found to about 0.3 px. Larger where cameras disagree.
LEAST_OUTLINE_CM = 0.02
# Outlines are off alike in neighbouring directions: so many directions are independent.
_INDEPENDENT = 4.0
# Outlines that disagree by more than this lack a part, or belong to no upright object: in rendered
# cells the error grows faster than the misfit then.
_SOUND_MISFIT_CM = 0.03
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
    """

    corners: np.ndarray
    covariance: np.ndarray
    viewpoint: Viewpoint


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
    :param misfit_cm: How far the cameras' footprints are apart: the root of the mean square, after
        each was moved as a whole.
    :param strain: How far each camera's silhouette had to be moved, as the square over its
        covariance; 4.6 and more for one in ten.
    """

    height: KnownHeight
    moments: Moments
    extent: Extent
    covariance: np.ndarray
    misfit_cm: float
    strain: np.ndarray


def solve(seen: Sequence[SeenOutline], known: Optional[KnownHeight] = None) -> Solution:
    """
    Find the height and the footprint of an object.

    :param seen: Its silhouettes, of one camera each.
    :param known: Its height, where it is known; one camera alone needs it.
    """
    problem = _Problem(seen)
    found = problem.solved(known)
    if found[0] < 0:  # No object is below the surface: what is seen is flat.
        deviation = math.sqrt(problem.inverse[0, 0])
        found = problem.solved(KnownHeight(0.0, 1e-3))
        return problem.solution(found, deviation)
    return problem.solution(found, math.sqrt(problem.inverse[0, 0]))


class _Problem:
    """
    The least squares problem: unknown are the height, and for each camera how far it is off.

    `inverse` is the covariance of the numbers that were found last.
    """

    def __init__(self, seen: Sequence[SeenOutline]) -> None:
        self._seen = seen
        self.count = len(seen)
        self._reach, self._slopes = self._seen_along(DIRECTIONS)
        self._design = np.zeros((self.count, COUNT, 1 + 2 * self.count))
        self._design[:, :, 0] = self._slopes
        for number in range(self.count):
            self._design[number, :, 1 + 2 * number:3 + 2 * number] = DIRECTIONS
        rows = (self._design - self._design.mean(axis=0)).reshape(-1, 1 + 2 * self.count)
        self._rows, self._apart = rows, (self._reach - self._reach.mean(axis=0)).ravel()
        self._normal, self._right = rows.T @ rows, rows.T @ self._apart
        self._noise, self._strain = LEAST_OUTLINE_CM, np.zeros(self.count)
        self.inverse = np.eye(1 + 2 * self.count)

    def solved(self, known: Optional[KnownHeight]) -> np.ndarray:
        """Return the height and the cameras' errors: shape (1 + 2 cameras,), in cm."""
        found = self._solved(known, LEAST_OUTLINE_CM, 0.0)
        errors = found[1:].reshape(self.count, 2)
        self._strain = np.array([error @ np.linalg.solve(self._prior(one, 0.0), error)
                                 for error, one in zip(errors, self._seen)])
        # What the outlines do not agree about, and what the cameras' places do, is known now.
        misfit = self.misfit(found)
        self._noise = max(LEAST_OUTLINE_CM, misfit, misfit ** 2 / _SOUND_MISFIT_CM)
        return self._solved(known, self._noise, max(float(found[0]), 0.0))

    def misfit(self, found: np.ndarray) -> float:
        """Return how far the footprints are apart, see `Solution`."""
        rest = self._apart - self._rows @ found
        return math.sqrt(float(rest @ rest) / (COUNT * max(self.count - 1, 1)))

    def solution(self, found: np.ndarray, height_deviation: float) -> Solution:
        """Make the footprint of the numbers that were found."""
        reached = (self._reach - self._design @ found).mean(axis=0)
        moments = moments_of(outline_of(reached))
        # The centre moves with the height, and with each camera's error.
        moves = np.column_stack([
            -2 / COUNT * (self._slopes.mean(axis=0) @ DIRECTIONS),
            *[-np.eye(2) / self.count] * self.count])
        covariance = moves @ self.inverse @ moves.T + np.eye(2) * (
            2 * self._noise ** 2 / (_INDEPENDENT * self.count))
        return Solution(
            KnownHeight(float(found[0]), height_deviation), moments,
            extent_of(lambda directions: self._footprint(found, directions), moments),
            covariance, self.misfit(found), self._strain)

    def _solved(
        self, known: Optional[KnownHeight], noise: float, height_cm: float
    ) -> np.ndarray:
        weight = _INDEPENDENT / COUNT / noise ** 2
        normal, right = weight * self._normal, weight * self._right
        for number, one in enumerate(self._seen):
            own = slice(1 + 2 * number, 3 + 2 * number)
            normal[own, own] += np.linalg.inv(self._prior(one, height_cm))
        if known is not None:
            normal[0, 0] += known.deviation_cm ** -2
            right[0] += known.height_cm * known.deviation_cm ** -2
        self.inverse = np.linalg.inv(normal)
        return self.inverse @ right

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
        return (reached - slopes * found[0] - errors).mean(axis=0)
