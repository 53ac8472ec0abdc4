# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The motion on which the patches' shifts agree, and how much of the structure agrees on it."""

from typing import NamedTuple, Tuple

import cv2
import numpy as np

# Patches tell a number of the similarity that they give to this many px.
_TOLD_PX = 0.2

# A similarity has four numbers: shift along u and v, growth and turn. A tilt has two more: growth
# that increases along u and along v. All are in px, but for the shift at half of the diagonal.
SIMILARITY, TILTED = 4, 6
# The camera is taken to stand still, to this many px, as long as nothing says otherwise.
_PRIOR_PX = 1.0
# At most so many rounds, until a round changes the numbers by less than this.
_ROUNDS, _SETTLED_PX = 4, 0.005
# Squared deviation from the similarity, in variances: half the weight, and no agreement.
_HALF_WEIGHT, _DISAGREES = 4.0, 9.0
# The same from rest: such a patch tells nothing of a camera that stands still.
_FAR_FROM_REST = 25.0


class Structure:
    """
    What patches of the surface tell of the camera's motion.

    :param total: Their information on its numbers, shape (n, n), in 1/px².

    `told` are the directions that they tell, shape (n, m), orthogonal, one in each column.
    """

    def __init__(self, total: np.ndarray) -> None:
        values, vectors = np.linalg.eigh(total)
        is_told = values > _TOLD_PX ** -2
        self.told = vectors[:, is_told]
        # Of this the whole structure is the unit matrix.
        self._whitening = (self.told / np.sqrt(values[is_told])).T

    @property
    def tells_all(self) -> bool:
        """Whether the surface tells every shift, rotation and scale."""
        return self.told.shape[1] == len(self.told)

    def share(self, total: np.ndarray) -> float:
        """
        Tell how much of it some patches are, 0..1: of what tells the least certain direction.

        :param total: Their information, shape (n, n), in 1/px².
        """
        part = self._whitening @ total @ self._whitening.T
        return max(0.0, float(cv2.eigen(part)[1][-1, 0]))


class Motion(NamedTuple):
    """
    What the patches agree on.

    :param numbers: Shape (4,) or (6,), the similarity and the tilt, in px.
    :param agrees: Shape (n,), which patches agree on it.
    """

    numbers: np.ndarray
    agrees: np.ndarray


class MotionFit:
    """
    Finds a motion by least squares, reweighted against patches that an object covers.

    :param places: Shape (n, 2), the patches' centres, in px.
    :param size: Width and height of the picture, in px.
    :param axes: Shape (n, 2, 2): along each of its rows a patch tells its shift with the variance
        1, in 1/px.
    :param count: How many numbers a motion has, SIMILARITY or TILTED.
    """

    def __init__(self, places: np.ndarray, size: Tuple[int, int], axes: np.ndarray,
                 count: int = SIMILARITY) -> None:
        self._size, self._count = size, count
        self._prior = np.eye(count) / _PRIOR_PX ** 2
        lever = _lever(places, size)[:, :, :count]
        self._axes = axes
        self._u, self._v = along = (axes @ lever).transpose(1, 0, 2)
        # That of each patch, and along each of its axes.
        self._axis_share = (along[..., None] * along[:, :, None]).reshape(-1, count ** 2)
        self._share = self._axis_share.reshape(2, -1, count ** 2).sum(axis=0)
        width, height = size
        self._corners = _lever(np.array([
            [0, 0], [width, 0], [0, height], [width, height], [width / 2, height / 2]]), size)
        self._corners = self._corners[:, :, :count]

    def total(self, weights: np.ndarray) -> np.ndarray:
        """
        Give the information of some patches on the numbers, shape (n, n), in 1/px².

        :param weights: Shape (n,), a weight for each patch; (2, n), for each of its axes.
        """
        share = self._share if weights.ndim == 1 else self._axis_share
        return (weights.ravel() @ share).reshape(self._count, self._count)

    def covariance(self, weights: np.ndarray, precision: float = 1.0) -> np.ndarray:
        """Give the covariance of the numbers by some patches, shape (n, n), in px²."""
        return np.linalg.inv(precision * self.total(weights) + self._prior)

    def solve(self, shifts: np.ndarray, is_seen: np.ndarray, precision: float = 1.0) -> Motion:
        """
        Find what the patches agree on.

        :param shifts: Shape (n, 2), in px.
        :param is_seen: Shape (n,), bool: the others do not count.
        :param precision: Factor for the information, below 1 in a dark frame.
        """
        u, v = self._whitened(shifts)
        sides = self._u * u[:, None] + self._v * v[:, None]
        weights, numbers = is_seen.astype(float), np.full(self._count, np.inf)
        for _ in range(_ROUNDS):
            before, numbers = numbers, self._solution(weights, sides)
            deviations = precision * self._missed(u, v, numbers)
            if cv2.norm(numbers, before, cv2.NORM_INF) < _SETTLED_PX:
                break
            weights = is_seen / (1 + deviations / _HALF_WEIGHT) ** 2
        return Motion(numbers, is_seen & (deviations < _DISAGREES))

    def near_rest(self, shifts: np.ndarray, is_seen: np.ndarray, precision: float) -> Motion:
        """
        Find in one round what those patches tell that have hardly moved; see `solve`.

        It is right only where most patches agree on it.
        """
        u, v = self._whitened(shifts)
        weights = (is_seen & (precision * (u * u + v * v) < _FAR_FROM_REST)).astype(float)
        numbers = self._solution(weights, self._u * u[:, None] + self._v * v[:, None])
        return Motion(numbers, is_seen & (precision * self._missed(u, v, numbers) < _DISAGREES))

    def _whitened(self, shifts: np.ndarray) -> np.ndarray:
        return (self._axes @ shifts[:, :, None])[:, :, 0].T

    def _solution(self, weights: np.ndarray, sides: np.ndarray) -> np.ndarray:
        # numpy's takes three times as long for so few.
        return cv2.solve(self.total(weights) + self._prior, (weights @ sides)[:, None],
                         flags=cv2.DECOMP_CHOLESKY)[1][:, 0]

    def _missed(self, u: np.ndarray, v: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        # Squared, by each patch.
        missed_u, missed_v = u - self._u @ numbers, v - self._v @ numbers
        return missed_u * missed_u + missed_v * missed_v

    def matrix(self, numbers: np.ndarray) -> np.ndarray:
        """
        Give a motion as the map from the background's pixels to the frame's.

        :returns: Shape (2, 3), as cv2.warpAffine takes it; (3, 3) with a tilt.
        """
        width, height = self._size
        right, down, growth, turn, *tilt = numbers.tolist()
        half = np.hypot(width, height) / 2
        if tilt:
            return self._tilted_matrix(numbers / half, half)
        scale, turn = 1 + growth / half, turn / half
        # About the picture's centre.
        right += (width - scale * width + turn * height) / 2
        down += (height - turn * width - scale * height) / 2
        return np.array([[scale, -turn, right], [turn, scale, down]])

    def _tilted_matrix(self, numbers: np.ndarray, half: float) -> np.ndarray:
        # Numbers in halves of the diagonal.
        right, down, growth, turn, tilt_u, tilt_v = numbers
        width, height = self._size
        to_places = np.array([[1 / half, 0, -width / 2 / half], [0, 1 / half, -height / 2 / half],
                              [0, 0, 1]])
        warp = np.array([[1 + growth, -turn, right], [turn, 1 + growth, down],
                         [-tilt_u, -tilt_v, 1]])
        return np.linalg.inv(to_places) @ warp @ to_places

    def farthest_px(self, numbers: np.ndarray) -> float:
        """Tell how far the picture's centre or a corner moves, the farthest of them, in px."""
        right, down = (self._corners[:, :, :len(numbers)] @ numbers).T
        return float((right * right + down * down).max()) ** 0.5


def _lever(places: np.ndarray, size: Tuple[int, int]) -> np.ndarray:
    # Shape (n, 2, 6): the shift of each place by the numbers.
    x, y = ((places - np.array(size) / 2) / (np.hypot(*size) / 2)).T
    lever = np.zeros((len(places), 2, TILTED))
    lever[:, 0, 0] = lever[:, 1, 1] = 1
    lever[:, 0, 2], lever[:, 0, 3] = x, -y
    lever[:, 1, 2], lever[:, 1, 3] = y, x
    lever[:, 0, 4], lever[:, 0, 5] = x * x, x * y
    lever[:, 1, 4], lever[:, 1, 5] = x * y, y * y
    return lever
