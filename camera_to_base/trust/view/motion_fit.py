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

"""The shift, rotation and scale on which the patches' shifts agree."""

from typing import NamedTuple, Tuple

import cv2
import numpy as np

# A similarity has four numbers: shift along u and v, growth and turn. All are in px, the last two
# at half of the picture's diagonal.
_NUMBERS = 4
# The camera is taken to stand still, to this many px, as long as nothing says otherwise.
_PRIOR_PX = 1.0
_PRIOR = np.eye(_NUMBERS) / _PRIOR_PX ** 2
# At most so many rounds, until a round changes the numbers by less than this.
_ROUNDS, _SETTLED_PX = 4, 0.005
# Squared deviation from the similarity, in variances: half the weight, and no agreement.
_HALF_WEIGHT, _DISAGREES = 4.0, 9.0


class Motion(NamedTuple):
    """
    What the patches agree on.

    :param numbers: Shape (4,), the similarity, in px.
    :param agrees: Shape (n,), which patches agree on it.
    """

    numbers: np.ndarray
    agrees: np.ndarray


class MotionFit:
    """
    Finds the similarity by least squares, reweighted against patches that an object covers.

    :param places: Shape (n, 2), the patches' centres, in px.
    :param size: Width and height of the picture, in px.
    :param information: Shape (n, 2, 2), inverse covariance of each patch's shift, in 1/px².
    """

    def __init__(self, places: np.ndarray, size: Tuple[int, int], information: np.ndarray) -> None:
        self._size = size
        lever = _lever(places, size)
        # In these axes the shift of a patch along each has the variance 1.
        self._axes = np.linalg.cholesky(information).transpose(0, 2, 1)
        self._u, self._v = (self._axes @ lever).transpose(1, 0, 2)
        self._share = (lever.transpose(0, 2, 1) @ information @ lever).reshape(-1, _NUMBERS ** 2)
        width, height = size
        self._corners = _lever(np.array([
            [0, 0], [width, 0], [0, height], [width, height], [width / 2, height / 2]]), size)

    def total(self, weights: np.ndarray) -> np.ndarray:
        """Give the information of some patches on the similarity, shape (4, 4), in 1/px²."""
        return (weights @ self._share).reshape(_NUMBERS, _NUMBERS)

    def solve(self, shifts: np.ndarray, is_seen: np.ndarray, precision: float = 1.0) -> Motion:
        """
        Find what the patches agree on.

        :param shifts: Shape (n, 2), in px.
        :param is_seen: Shape (n,), bool: the others do not count.
        :param precision: Factor for the information, below 1 in a dark frame.
        """
        u, v = (self._axes @ shifts[:, :, None])[:, :, 0].T
        sides = self._u * u[:, None] + self._v * v[:, None]
        weights, numbers = is_seen.astype(float), np.full(_NUMBERS, np.inf)
        for _ in range(_ROUNDS):
            before, numbers = numbers, _solution(self.total(weights) + _PRIOR, weights @ sides)
            missed_u, missed_v = u - self._u @ numbers, v - self._v @ numbers
            deviations = precision * (missed_u * missed_u + missed_v * missed_v)
            if cv2.norm(numbers, before, cv2.NORM_INF) < _SETTLED_PX:
                break
            weights = is_seen / (1 + deviations / _HALF_WEIGHT) ** 2
        return Motion(numbers, is_seen & (deviations < _DISAGREES))

    def matrix(self, numbers: np.ndarray) -> np.ndarray:
        """
        Give a similarity as the map from the background's pixels to the frame's.

        :returns: Shape (2, 3), as cv2.warpAffine takes it.
        """
        width, height = self._size
        right, down, growth, turn = numbers.tolist()
        half = np.hypot(width, height) / 2
        scale, turn = 1 + growth / half, turn / half
        # About the picture's centre.
        right += (width - scale * width + turn * height) / 2
        down += (height - turn * width - scale * height) / 2
        return np.array([[scale, -turn, right], [turn, scale, down]])

    def farthest_px(self, numbers: np.ndarray) -> float:
        """Tell how far the picture's centre or a corner moves, the farthest of them, in px."""
        right, down = (self._corners @ numbers).T
        return float((right * right + down * down).max()) ** 0.5


def _solution(matrix: np.ndarray, sides: np.ndarray) -> np.ndarray:
    # numpy's takes three times as long for so few.
    return cv2.solve(matrix, sides[:, None], flags=cv2.DECOMP_CHOLESKY)[1][:, 0]


def _lever(places: np.ndarray, size: Tuple[int, int]) -> np.ndarray:
    # Shape (n, 2, 4): the shift of each place by the four numbers.
    x, y = ((places - np.array(size) / 2) / (np.hypot(*size) / 2)).T
    lever = np.zeros((len(places), 2, _NUMBERS))
    lever[:, 0, 0] = lever[:, 1, 1] = 1
    lever[:, 0, 2], lever[:, 0, 3] = x, -y
    lever[:, 1, 2], lever[:, 1, 3] = y, x
    return lever
