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

"""The empty table as the simulated camera sees it: plain with faint lines, wood, or a print."""

from typing import Optional

from camera_to_base.simulation.conditions import BoardConditions
from camera_to_base.simulation.specs import PRINTED, WOOD
from camera_to_base.simulation.table.reliefs import draw_print, draw_wood, ReliefSize
from camera_to_base.simulation.view import BoardView
import cv2
import numpy as np

# Offsets of blue, green and red from the grey level: no real material is exactly grey.
_TABLE_TINT = np.array([-6.0, 0.0, 6.0], np.float32)
_WOOD_COLOUR = np.array([0.56, 0.76, 0.98], np.float32)
# Faint lines every few cm show the tilt to the eye; they are below every detector's threshold.
_GRID_CM, _GRID_DEPTH = 4.5, 10.0
# How far wood and print go on beside the picture, as a share of its size; then they are mirrored.
_MARGIN = 0.6
_RELIEFS = {WOOD: draw_wood, PRINTED: draw_print}


class Table:
    """
    A table's surface, for a camera that may be moved.

    :param name: One of `specs.TABLES`.
    :param start: The camera's view at the start.
    :param seed: Seed of what is random about the surface.
    """

    def __init__(
        self, name: str, start: BoardView, conditions: BoardConditions, seed: int
    ) -> None:
        self._name, self._start, self._conditions = name, start, conditions
        self._margin_cm = _MARGIN * start.size_cm
        self._grain = self._draw_grain(np.random.default_rng((seed, 0, 0)))
        self._relief = self._draw_relief(np.random.default_rng((seed, 0, 1)))

    def seen_by(self, view: BoardView) -> np.ndarray:
        """
        Draw the table.

        :returns: Shape (h, w, 3), float32, BGR.
        """
        level = self._conditions.table_level + self._pattern(view)
        if self._grain is not None:
            level += self._seen_grain(view)
        level = level[:, :, None].astype(np.float32)
        return level * _WOOD_COLOUR if self._name == WOOD else level + _TABLE_TINT

    def _pattern(self, view: BoardView) -> np.ndarray:
        if self._relief is None:
            return -_GRID_DEPTH * _grid(view)
        relief_from_surface = np.diag([1 / self._start.cm_per_px] * 2 + [1.0])
        relief_from_surface[:2, 2] = self._margin_cm / self._start.cm_per_px
        return _warped(
            self._relief, view.pixel_from_surface @ np.linalg.inv(relief_from_surface), view)

    def _draw_relief(self, random: np.random.Generator) -> Optional[np.ndarray]:
        if self._name not in _RELIEFS:
            return None
        size = ReliefSize(*(self._start.size_cm + 2 * self._margin_cm), self._start.cm_per_px)
        return _RELIEFS[self._name](size, random)

    def _draw_grain(self, random: np.random.Generator) -> Optional[np.ndarray]:
        if self._conditions.texture <= 0:
            return None
        grain = random.standard_normal((self._start.height, self._start.width), dtype=np.float32)
        grain = cv2.GaussianBlur(grain, (0, 0), 3.0)
        return grain * (self._conditions.texture / grain.std())

    def _seen_grain(self, view: BoardView) -> np.ndarray:
        if view is self._start:
            return self._grain
        return _warped(
            self._grain, view.pixel_from_surface @ self._start.surface_from_pixel, view)


def _grid(view: BoardView) -> np.ndarray:
    everything = slice(0, view.height), slice(0, view.width)
    offset = (view.points(*everything) + _GRID_CM / 2) % _GRID_CM - _GRID_CM / 2
    return np.clip(1 - np.abs(offset).min(axis=2) / view.cm_per_px, 0, 1)


def _warped(picture: np.ndarray, pixel_from_picture: np.ndarray, view: BoardView) -> np.ndarray:
    return cv2.warpPerspective(picture, pixel_from_picture, (view.width, view.height),
                               borderMode=cv2.BORDER_REFLECT)
