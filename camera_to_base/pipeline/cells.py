# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A picture in cells of some px: mean colours, and what differs from the background."""

from typing import List, NamedTuple, Tuple

import cv2
import numpy as np

# The picture is made this long at most, in cells: a quarter of 640 px.
_LONGEST = 160
# Of a large picture some pixels are enough: this many along a cell.
_SAMPLES = 4


class Cells:
    """
    Square cells of a picture; what does not fill a cell at the right and below is left out.

    :param width: Of the picture, in px; `height`, too.

    `scale` is a cell's side in px, `samples` how many pixels along it count; `columns` and `rows`
    is how many cells there are.
    """

    def __init__(self, width: int, height: int) -> None:
        # The shorter side has at least one.
        self.scale = max(1, min(round(max(width, height) / _LONGEST), width, height))
        self.columns, self.rows = width // self.scale, height // self.scale
        self.samples = _SAMPLES if self.scale >= _SAMPLES else min(self.scale, 2)

    def pixels(self, picture: np.ndarray, rows: slice, columns: slice) -> np.ndarray:
        """Return the pixels of some cells: shape (rows, columns, 3), uint8."""
        return picture[self.scale * rows.start:self.scale * rows.stop,
                       self.scale * columns.start:self.scale * columns.stop]

    def means(self, pixels: np.ndarray) -> np.ndarray:
        """
        Return the mean colour of each cell.

        :param pixels: Shape (scale * rows, scale * columns, 3), uint8.
        :returns: Shape (rows, columns, 3), uint8.
        """
        return self.means_of_samples(self.sampled(pixels))

    def sampled(self, pixels: np.ndarray) -> np.ndarray:
        """
        Return the pixels that count.

        :param pixels: Shape (scale * rows, scale * columns, 3), uint8.
        :returns: Shape (samples * rows, samples * columns, 3), uint8.
        """
        if self.samples == self.scale:
            return pixels
        share = self.samples / self.scale
        return cv2.resize(pixels, None, fx=share, fy=share, interpolation=cv2.INTER_NEAREST)

    def means_of_samples(self, pixels: np.ndarray) -> np.ndarray:
        """Return the mean colour of each cell from the pixels that count, see `sampled`."""
        samples = self.samples
        # Halving is several times as fast as other ratios.
        while samples > 1:
            height, width = pixels.shape[:2]
            pixels = cv2.resize(pixels, (width // 2, height // 2), interpolation=cv2.INTER_AREA)
            samples //= 2
        return pixels

    def around(self, outline: np.ndarray) -> Tuple[slice, slice]:
        """
        Tell the rows and columns of the cells that an outline lies in.

        :param outline: Shape (n, 2), int32, columns u and v in px.
        """
        left, top, width, height = cv2.boundingRect(outline)
        right, bottom = (left + width - 1) // self.scale + 1, (top + height - 1) // self.scale + 1
        return (slice(top // self.scale, min(bottom, self.rows)),
                slice(left // self.scale, min(right, self.columns)))


class Light(NamedTuple):
    """
    The light of a frame, and what the surface itself may differ by.

    :param factors: How much brighter each channel is: three numbers, or shape (h, w, 3).
    :param least: What counts as a difference everywhere, in levels.
    :param slack: How much of its `spread` a cell may differ by.
    """

    factors: object
    least: float
    slack: float


class CellBackground(NamedTuple):
    """
    The background in cells, or a part of it.

    :param levels: Shape (h, w, 3), float32, at least 1.
    :param spread: Shape (h, w, 3), uint8, the range of a cell and its neighbours.
    """

    levels: np.ndarray
    spread: np.ndarray

    def part(self, rows: slice, columns: slice) -> 'CellBackground':
        """Return the same of some cells."""
        return CellBackground(self.levels[rows, columns], self.spread[rows, columns])

    def excess(self, means: np.ndarray, light: Light) -> np.ndarray:
        """
        Tell by how much cells differ from the background more than the surface itself may.

        :param means: Shape (h, w, 3), uint8.
        :returns: Of the same shape, uint8, 0 where they do not.
        """
        lit = cv2.multiply(self.levels, light.factors, dtype=cv2.CV_8U)
        most = cv2.convertScaleAbs(self.spread, alpha=light.slack, beta=light.least)
        return cv2.subtract(cv2.absdiff(means, lit), most)


def any_channel(excess: np.ndarray) -> np.ndarray:
    """Return where a channel is above 0: shape (h, w), uint8, 0 or 1."""
    blue, green, red = cv2.split(excess)
    return cv2.threshold(cv2.max(cv2.max(blue, green), red), 0, 1, cv2.THRESH_BINARY)[1]


def medians(ratios: np.ndarray) -> List[float]:
    """Return the median of each column of an array of shape (n, 3), the upper one of two."""
    half = len(ratios) // 2
    return np.partition(ratios, half, axis=0)[half].tolist()


def covered_share(mask: np.ndarray, outline: np.ndarray, scale: int) -> float:
    """
    Tell how much of an object overlaps a mask, 0..1.

    :param mask: Shape (h / scale, w / scale), uint8.
    :param outline: Shape (n, 2), int32, columns u and v in px.
    """
    cells = outline // scale
    left, top, width, height = cv2.boundingRect(cells)
    piece = mask[top:top + height, left:left + width]
    if not piece.size or not cv2.countNonZero(piece):
        return 0.0
    inside = np.zeros(piece.shape, np.uint8)
    cv2.fillPoly(inside, [cells], 1, offset=(-left, -top))
    return cv2.countNonZero(inside & piece) / max(cv2.countNonZero(inside), 1)
