# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What reaches in from the picture's edge: a hand, a sleeve, an arm, and their shadows."""

from typing import Iterable, List, NamedTuple, Optional, Sequence

from camera_to_base.pipeline.cells import any_channel, CellBackground, Cells, Light, medians
import cv2
import numpy as np

# Pixels that tell the light, along the picture's longer side.
_LIGHT_SAMPLES = 20

# What differs from the background by more than this in one channel is there, in levels at the
# background's light; in a dark frame not less than the second, for it is rounded.
_FAINTEST, _FAINTEST_IN_THE_DARK = 3.0, 2.5
# The same in standard deviations of the noise.
_NOISE_DEVIATIONS = 4.5
# What is left of a shift of the camera that was measured, in px.
_SHIFT_ERROR_PX = 0.3
# Where a change reaches more of the edge than this it may be the light, which changes smoothly.
_EDGE_SHARE = 0.4
# What reaches in everywhere is another view, or other light, and nothing that reaches in.
_WHOLE_EDGE = 0.8
# Rounds of the fit of smooth light, and what counts half in it, in shares of the light.
_ROUNDS, _HALF_WEIGHT = 8, 0.03
# Smooth light is fitted to every fourth cell each way, which saves time.
_GRID_STEP = 4
# Where the surface's own texture is seen at the edge, it lies in a soft shade or in the sun, and
# nothing covers it. Detail is finer than this, px; edges of so many levels are no texture: they
# may be written over the picture, such as its time. The deviation of the detail in the background,
# in levels, and how alike the frame's is, in squares of so many cells.
_DETAIL, _STRONG_EDGE, _LEAST_DETAIL, _ALIKE, _SQUARE = (9, 9), 40.0, 1.5, 0.6, 5
# On a surface whose own levels vary by this much, an arm is like it here and there: gaps of up to
# 4 cells are closed there.
_TEXTURE_LEVELS, _CLOSING = 2.0, np.ones((5, 5), np.uint8)


class PictureEdge:
    """
    Tells whether a frame differs from the background near its edge.

    :param picture: The background, shape (h, w, 3), uint8, BGR.
    :param cells: Its cells; `background` is its content.
    :param depth: How many cells from the edge count.
    """

    def __init__(
        self, picture: np.ndarray, cells: Cells, background: CellBackground, depth: int
    ) -> None:
        self._cells, self._depth = cells, min(depth, cells.rows, cells.columns)
        self._height, self._width = cells.rows * cells.scale, cells.columns * cells.scale
        self._background = CellBackground(*(
            _joined(_sides(part, self._depth)) for part in background))
        step = max(1, max(picture.shape) // _LIGHT_SAMPLES)
        self._grid = tuple(
            slice(min(step, length) // 2, None, step) for length in picture.shape[:2])
        self._light = np.maximum(picture[self._grid], 1).astype(np.float32)
        self._surface = [_Strip.of(strip, cells.scale) for strip in self._strips(picture)]

    def gains(self, frame: np.ndarray) -> List[float]:
        """Tell how much brighter each channel of a frame is."""
        return medians((frame[self._grid] / self._light).reshape(-1, 3))

    def differs(self, frame: np.ndarray, light: Light) -> bool:
        """
        Tell whether anything differs there.

        :param frame: Shape (h, w, 3), uint8, BGR.
        """
        whole = frame[:self._height, :self._width]
        sides = _sides(whole, self._depth * self._cells.scale)
        means = self._cells.means_of_samples(_joined(map(self._cells.sampled, sides)))
        return cv2.norm(self._background.excess(means, light), cv2.NORM_INF) > 0

    def shows_surface(self, frame: np.ndarray) -> np.ndarray:
        """
        Tell where the surface's texture is seen at the edge.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :returns: Shape (rows, columns), uint8, 1 in cells at the edge that show it.
        """
        top, bottom, left, right = (
            surface.shown(strip)
            for surface, strip in zip(self._surface, self._strips(frame)))
        shown = np.zeros((self._cells.rows, self._cells.columns), np.uint8)
        shown[0], shown[-1] = top, bottom
        shown[:, 0] |= left
        shown[:, -1] |= right
        return shown

    def _strips(self, picture: np.ndarray) -> Sequence[np.ndarray]:
        # The edge is the first row of each.
        depth = min(_SQUARE, self._cells.rows, self._cells.columns) * self._cells.scale
        top, bottom, left, right = _sides(picture[:self._height, :self._width], depth)
        return top, bottom[::-1], cv2.transpose(left), cv2.transpose(right)[::-1]


class _Strip(NamedTuple):
    """
    A strip of the surface along the picture's edge, which is its first row.

    :param detail: Its detail, shape (h, w), float32; 0 beside edges that are no texture.
    :param is_fine: 1 elsewhere, of the same shape.
    :param power: The detail's mean square around each cell of the edge, shape (w / scale,).
    :param scale: The side of a cell, in px.
    """

    detail: np.ndarray
    is_fine: np.ndarray
    power: np.ndarray
    scale: int

    @classmethod
    def of(cls, picture: np.ndarray, scale: int) -> '_Strip':
        """Take it from a part of the background, shape (h, w, 3), uint8, BGR."""
        grey = _grey(picture)
        step = cv2.morphologyEx(grey, cv2.MORPH_GRADIENT, np.ones(_DETAIL))
        is_fine = (step < _STRONG_EDGE).astype(np.float32)
        detail = _detail(grey, is_fine)
        return cls(detail, is_fine, _around_cells(detail ** 2, scale), scale)

    def shown(self, picture: np.ndarray) -> np.ndarray:
        """
        Tell where a part of a frame shows the same detail.

        :param picture: Shape (h, w, 3), uint8, BGR.
        :returns: Shape (w / scale,), bool, of the cells along the edge.
        """
        now = _detail(_grey(picture), self.is_fine)
        both, other = (
            _around_cells(one, self.scale) for one in (self.detail * now, now ** 2))
        return (self.power > _LEAST_DETAIL ** 2) & (both > _ALIKE * np.sqrt(self.power * other))


def _around_cells(values: np.ndarray, scale: int) -> np.ndarray:
    """Give the means in squares around the cells of the first row."""
    return cv2.blur(values, (_SQUARE * scale,) * 2)[scale // 2, scale // 2::scale]


def _grey(picture: np.ndarray) -> np.ndarray:
    return cv2.cvtColor(np.ascontiguousarray(picture), cv2.COLOR_BGR2GRAY).astype(np.float32)


def _detail(levels: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Give levels without their mean around each pixel, in a mask and by that alone."""
    mean = cv2.blur(levels * mask, _DETAIL) / np.maximum(cv2.blur(mask, _DETAIL), 1e-6)
    return (levels - mean) * mask


def _sides(picture: np.ndarray, depth: int) -> Sequence[np.ndarray]:
    return picture[:depth], picture[-depth:], picture[:, :depth], picture[:, -depth:]


def _joined(sides: Iterable[np.ndarray]) -> np.ndarray:
    # To a long picture, the left and the right side turned: each call costs more than its pixels.
    top, bottom, left, right = sides
    return cv2.hconcat([top, bottom, cv2.transpose(left), cv2.transpose(right)])


class Changes(NamedTuple):
    """
    Where a frame differs from the background, in cells of some px.

    :param reaching_in: Shape (h / scale, w / scale), uint8, 1 where something reaches in.
    :param differs: The same, 1 where anything differs; looked at where the outlines are, at least.
    :param gain: How much brighter the frame is.
    """

    reaching_in: np.ndarray
    differs: np.ndarray
    gain: float

    @property
    def any_reaching_in(self) -> bool:
        """Whether anything reaches in."""
        return cv2.countNonZero(self.reaching_in) > 0

    @property
    def edge_share(self) -> float:
        """How much of the picture's edge something reaches in from, 0..1."""
        return float(_on_edge(self.reaching_in).mean())


class ReachingIn:
    """
    Finds what differs from the background and is connected to the picture's edge.

    A shade or the sun on the surface does not reach in by itself: where the surface's texture is
    seen at the edge, nothing covers it.

    A detector finds strong differences, so that a hand whose brightness is like the table's falls
    apart into islands. A faint difference shows that they belong together. Where nothing differs
    near the edge, nothing reaches in: then the rest of the picture is not looked at.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param unknown: Where the background shows nothing, shape (h, w), uint8, 255 there: what is
        connected to it reaches in, too. None for nowhere.

    `noise` is that of a pixel of a frame and of the background together, in levels.
    """

    def __init__(self, background: np.ndarray, unknown: Optional[np.ndarray] = None) -> None:
        height, width = background.shape[:2]
        self._cells = Cells(width, height)
        means = self._all_means(background)
        self._background = CellBackground(
            np.maximum(means, 1).astype(np.float32),
            cv2.morphologyEx(means, cv2.MORPH_GRADIENT, np.ones((3, 3))))
        noise = np.median(np.abs(np.diff(background[::4].astype(np.int16), axis=1)))
        self._is_textured = cv2.dilate(
            (self._background.spread.max(axis=2) > 2 * _TEXTURE_LEVELS).astype(np.uint8),
            np.ones((3, 3)))
        self.noise = float(noise) / 0.6745
        # Of the mean of a cell.
        self._cell_noise = self.noise / self._cells.samples
        self._terms = _quadratic_terms(self._cells.columns, self._cells.rows)
        self._edge = PictureEdge(background, self._cells, self._background, self._depth)
        self._unknown = None if unknown is None else self._unknown_cells(unknown)

    @property
    def _depth(self) -> int:
        # A cell at the edge belongs to what reaches in if it differs, or where gaps are closed.
        return 1 + (_on_edge(self._is_textured).any() and _CLOSING.shape[0] // 2)

    @property
    def scale(self) -> int:
        """How many px along a cell."""
        return self._cells.scale

    def find(self, frame: np.ndarray, shift_px: float,
             outlines: Sequence[np.ndarray] = ()) -> Changes:
        """
        Find it on a frame of the background's size.

        :param shift_px: How far the view has moved, in px: so much blurs the surface's edges.
        :param outlines: Of places, each of shape (n, 2), int32, columns u and v in px:
            `differs` is looked at there.
        """
        gains = self._edge.gains(frame)
        gain = sorted(gains)[1]
        light = self._light(gains, gain, shift_px)
        if self._unknown is not None or self._edge.differs(frame, light):
            return self._find_everywhere(frame, shift_px)
        nothing = np.zeros((self._cells.rows, self._cells.columns), np.uint8)
        return Changes(nothing, self._differs_at(frame, light, outlines), gain)

    def _differs_at(self, frame: np.ndarray, light: Light,
                    outlines: Sequence[np.ndarray]) -> np.ndarray:
        differs = np.zeros((self._cells.rows, self._cells.columns), np.uint8)
        for outline in outlines:
            place = self._cells.around(outline)
            if differs[place].size:
                means = self._cells.means(self._cells.pixels(frame, *place))
                differs[place] = any_channel(self._background.part(*place).excess(means, light))
        return differs

    def _find_everywhere(self, frame: np.ndarray, shift_px: float) -> Changes:
        means = self._all_means(frame)
        ratio = (means[::_GRID_STEP, ::_GRID_STEP]
                 / self._background.levels[::_GRID_STEP, ::_GRID_STEP]).reshape(-1, 3)
        gains = medians(ratio)
        gain = sorted(gains)[1]
        light = self._light(gains, gain, shift_px)
        found = self._changes(means, light, gain)
        if found.edge_share > _EDGE_SHARE:
            other = self._changes(
                means, light._replace(factors=self._smooth_light(ratio)), gain)
            found = min(found, other, key=lambda changes: changes.edge_share)
        if found.edge_share > _WHOLE_EDGE:
            return found._replace(reaching_in=np.zeros_like(found.reaching_in))
        if not found.edge_share:
            return found
        return found._replace(reaching_in=self._connected(
            found.reaching_in & (1 - self._edge.shows_surface(frame))))

    def _light(self, gains: List[float], gain: float, shift_px: float) -> Light:
        # Half a level less, as both pictures are rounded.
        least = max(_FAINTEST * min(gain, 1.0), _FAINTEST_IN_THE_DARK,
                    _NOISE_DEVIATIONS * self._cell_noise)
        slack = (shift_px + _SHIFT_ERROR_PX) / self.scale / 2
        return Light((*gains, 0.0), least - 0.5, slack)

    def _changes(self, means: np.ndarray, light: Light, gain: float) -> Changes:
        differs = any_channel(self._background.excess(means, light))
        closed = cv2.morphologyEx(differs, cv2.MORPH_CLOSE, _CLOSING) & self._is_textured
        # Around it is an edge from which all that touches it is filled.
        return Changes(self._connected(differs | closed), differs, gain)

    def _connected(self, mask: np.ndarray) -> np.ndarray:
        """Give what of a mask is connected to the edge, or to what is unknown."""
        connected = mask if self._unknown is None else mask | self._unknown
        framed = cv2.copyMakeBorder(connected, 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=1)
        cv2.floodFill(framed, None, (0, 0), 2, flags=8)
        reaching_in = (framed[1:-1, 1:-1] == 2).astype(np.uint8)
        return reaching_in if self._unknown is None else reaching_in & (1 - self._unknown)

    def _unknown_cells(self, unknown: np.ndarray) -> np.ndarray:
        cells = self._cells
        whole = unknown[:cells.rows * cells.scale, :cells.columns * cells.scale]
        share = cv2.resize(whole, (cells.columns, cells.rows), interpolation=cv2.INTER_AREA)
        return cv2.dilate((share > 0).view(np.uint8), np.ones((3, 3)))

    def _smooth_light(self, ratio: np.ndarray) -> np.ndarray:
        grid = self._terms[::_GRID_STEP, ::_GRID_STEP].reshape(-1, self._terms.shape[2])
        weights = np.ones(len(grid))
        for _ in range(_ROUNDS):
            weighted = grid * weights[:, None]
            factors = np.linalg.lstsq(weighted.T @ grid, weighted.T @ ratio, rcond=None)[0]
            missed = np.abs(grid @ factors - ratio).max(axis=1)
            weights = 1 / (1 + (missed / _HALF_WEIGHT) ** 2) ** 2
        return (self._terms @ factors).astype(np.float32)

    def _all_means(self, picture: np.ndarray) -> np.ndarray:
        cells = self._cells
        return cells.means(cells.pixels(picture, slice(0, cells.rows), slice(0, cells.columns)))


def _on_edge(mask: np.ndarray) -> np.ndarray:
    return np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]])


def _quadratic_terms(width: int, height: int) -> np.ndarray:
    y, x = np.meshgrid(np.linspace(-1, 1, height), np.linspace(-1, 1, width), indexing='ij')
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=2)
