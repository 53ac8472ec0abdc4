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

"""Small pieces of a picture: where its structure is most like a corner, and how they are read."""

import cv2
import numpy as np

# Samples along a side, and px between two of them in a picture of 640 px.
SIDE, _STEP_PX, _USUAL_LENGTH = 16, 2, 640
# Places are chosen in cells of at least this many px, 8 x 8 of them at most.
_MOST_CELLS, _LEAST_CELL_PX = 8, 32
# Of a strong edge no more than this counts, in levels per px: a faint corner is told from it.
_STRONG_EDGE, _CORNER_SIGMA = 20.0, 1.5
# An edge is better than nothing: it tells a shift across.
_EDGE_SHARE = 0.02
# Room for the filters of the gradient.
_MARGIN_PX = 3
_MEAN = np.full(SIDE * SIDE, 1 / SIDE ** 2, np.float32)


class Patches:
    """
    Reads square patches of pictures of one size: a sample is the mean of four pixels.

    :param centres: Shape (n, 2), columns u and v in px, n at least 1.
    :param step: Distance of two samples, in px.
    """

    def __init__(self, centres: np.ndarray, step: int) -> None:
        self._step, self.count, self._centres = step, len(centres), centres
        self._first = np.floor(centres - (SIDE - 1) / 2 * step).astype(int)

    def part(self, chosen: np.ndarray) -> 'Patches':
        """Give some of the patches, by their indices."""
        return Patches(self._centres[chosen], self._step)

    def read(self, picture: np.ndarray) -> np.ndarray:
        """
        Read the patches' grey levels, each patch without its mean.

        :param picture: Shape (h, w, 3), uint8, BGR.
        :returns: Shape (n, 256), float32.
        """
        u, v = self._first.T
        pairs = _pieces(picture, self._step)[v, u].view(np.uint8)
        grey = cv2.cvtColor(pairs.reshape(-1, 2 * SIDE, 3), cv2.COLOR_BGR2GRAY)
        means = cv2.resize(grey, (SIDE, SIDE * self.count), interpolation=cv2.INTER_AREA)
        return self._without_mean(means.astype(np.float32))

    def slopes(self, grey: np.ndarray, half_px: float) -> np.ndarray:
        """
        Read the patches' gradients, each patch without its mean, as differences over 2 half_px.

        :param grey: Shape (h, w), float32.
        :returns: Shape (n, 256, 2), along u and v, in levels per px.
        """
        u, v = self._centres_of_samples()
        ahead_u, back_u, ahead_v, back_v = (
            self._without_mean(cv2.remap(grey, u + du, v + dv, cv2.INTER_LINEAR,
                                         borderMode=cv2.BORDER_REPLICATE))
            for du, dv in ((half_px, 0), (-half_px, 0), (0, half_px), (0, -half_px)))
        return np.stack([ahead_u - back_u, ahead_v - back_v], axis=2) / (2 * half_px)

    def _centres_of_samples(self) -> tuple:
        offsets = np.arange(SIDE, dtype=np.float32) * self._step + np.float32(0.5)
        shape = self.count, SIDE, SIDE
        u, v = (first[:, None] + offsets for first in self._first.T)
        return (np.broadcast_to(u[:, None, :], shape).astype(np.float32).reshape(-1, SIDE),
                np.broadcast_to(v[:, :, None], shape).astype(np.float32).reshape(-1, SIDE))

    def _without_mean(self, pieces: np.ndarray) -> np.ndarray:
        samples = pieces.reshape(self.count, -1)
        return samples - (samples @ _MEAN)[:, None]


def _pieces(picture: np.ndarray, step: int) -> np.ndarray:
    # A view of every patch that a picture can have: shape (v, u, 16, 2, 16), of pairs of pixels.
    picture, length = np.ascontiguousarray(picture), (SIDE - 1) * step + 2
    height, width = picture.shape[:2]
    row, pixel, _ = picture.strides
    return np.ndarray(
        (height - length + 1, width - length + 1, SIDE, 2, SIDE), np.dtype('V6'), picture,
        strides=(row, pixel, step * row, row, step * pixel))


def step_for(size: tuple) -> int:
    """Tell the distance of two samples for a picture of a size in px, in px."""
    return _STEP_PX * max(1, round(max(size) / _USUAL_LENGTH))


def find_places(grey: np.ndarray, step: int) -> np.ndarray:
    """
    Find in each cell of a picture the patch that is most like a corner.

    :param grey: Shape (h, w), float32.
    :returns: Shape (n, 2), the patches' centres, columns u and v in px; n is 0 where the picture
        is smaller than a patch.
    """
    reach = SIDE * step // 2
    score = _corner_score(grey, 2 * reach + 1)
    rows, columns = (_cells(length, reach + _MARGIN_PX) for length in grey.shape)
    places = [_best(score, row, column) for row in rows for column in columns]
    return np.array(places, np.float32).reshape(-1, 2)


def _cells(length: int, margin: int) -> list:
    count = min(_MOST_CELLS, (length - 2 * margin) // _LEAST_CELL_PX + 1)
    bounds = np.linspace(margin, length - margin, max(count, 0) + 1).astype(int)
    return [slice(*pair) for pair in zip(bounds, bounds[1:]) if pair[0] < pair[1]]


def _best(score: np.ndarray, rows: slice, columns: slice) -> tuple:
    piece = score[rows, columns]
    v, u = np.unravel_index(piece.argmax(), piece.shape)
    return columns.start + u, rows.start + v


def _corner_score(grey: np.ndarray, width: int) -> np.ndarray:
    # The smaller eigenvalue of the structure tensor: J. Shi, C. Tomasi, Good features to track,
    # 1994.
    smooth = cv2.GaussianBlur(grey, (0, 0), _CORNER_SIGMA)
    du, dv = (np.clip(cv2.Sobel(smooth, cv2.CV_32F, *order, scale=1 / 8),
                      -_STRONG_EDGE, _STRONG_EDGE) for order in ((1, 0), (0, 1)))
    uu, vv, uv = (cv2.boxFilter(product, -1, (width, width))
                  for product in (du * du, dv * dv, du * dv))
    return (uu + vv) / 2 - (1 - _EDGE_SHARE) * np.sqrt(((uu - vv) / 2) ** 2 + uv ** 2)
