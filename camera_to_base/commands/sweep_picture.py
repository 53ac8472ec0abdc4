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

"""Draws a sweep: on how many frames there is an object, over the parameter's value."""

from typing import Callable, List, Sequence, Tuple

from camera_to_base.calibration import round_step
from camera_to_base.commands.sweep import SweepResult
import cv2
import numpy as np

# Colours as blue, green, red.
_PAPER = (255, 255, 255)
_INK = (40, 40, 40)
_GRID = (225, 225, 225)
_ANY = (200, 120, 20)
_ONE = (40, 160, 40)
_NOW = (40, 40, 220)

_WIDTH, _HEIGHT = 960, 540
_LEFT, _RIGHT, _TOP, _BOTTOM = 80, 30, 90, 70
_SIZE = 0.5
_Place = Callable[[float, float], Tuple[int, int]]


def sweep_picture(result: SweepResult) -> np.ndarray:
    """
    Draw the chart of a sweep; its current value is a line of its own.

    :returns: Shape (h, w, 3), uint8, BGR.
    """
    canvas = np.full((_HEIGHT, _WIDTH, 3), _PAPER, np.uint8)
    frames = max([1, *(counter.frames for counter in result.counters)])
    place = _places(result, frames)
    _draw_grid(canvas, place, result.values, frames)
    if result.values[0] <= result.current <= result.values[-1]:
        _draw_now(canvas, place, result.current, frames)
    for counts, colour in ((_counts(result, 'with_any'), _ANY),
                           (_counts(result, 'with_one'), _ONE)):
        _draw_curve(canvas, [place(*point) for point in zip(result.values, counts)], colour)
    _draw_legend(canvas, result, frames)
    return canvas


def _counts(result: SweepResult, which: str) -> List[int]:
    return [getattr(counter, which) for counter in result.counters]


def _places(result: SweepResult, frames: int) -> _Place:
    low, high = result.values[0], result.values[-1]

    def place(value: float, count: float) -> Tuple[int, int]:
        x = _LEFT + (value - low) / (high - low) * (_WIDTH - _LEFT - _RIGHT)
        y = _HEIGHT - _BOTTOM - count / frames * (_HEIGHT - _TOP - _BOTTOM)
        return round(x), round(y)

    return place


def _draw_grid(canvas: np.ndarray, place: _Place, values: Sequence[float], frames: int) -> None:
    for count in _marks(0, frames):
        left, right = place(values[0], count), place(values[-1], count)
        cv2.line(canvas, left, right, _GRID, 1)
        _text(canvas, f'{count:g}', (left[0] - 10, left[1] + 5), align=1.0)
    for value in _marks(values[0], values[-1]):
        below, above = place(value, 0), place(value, frames)
        cv2.line(canvas, below, above, _GRID, 1)
        _text(canvas, f'{value:g}', (below[0], below[1] + 22), align=0.5)
    cv2.rectangle(canvas, place(values[0], frames), place(values[-1], 0), _INK, 1)


def _marks(low: float, high: float) -> List[float]:
    step = round_step((high - low) / 10)
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return [round(float(mark * step), 9) + 0.0 for mark in np.arange(first, last + 1)]  # no -0


def _draw_now(canvas: np.ndarray, place: _Place, current: float, frames: int) -> None:
    (x, bottom), (_, top) = place(current, 0), place(current, frames)
    for y in range(top, bottom, 10):
        cv2.line(canvas, (x, y), (x, min(y + 5, bottom)), _NOW, 2)


def _draw_curve(
    canvas: np.ndarray, pixels: List[Tuple[int, int]], colour: Tuple[int, int, int]
) -> None:
    cv2.polylines(canvas, [np.array(pixels, np.int32)], False, colour, 2, cv2.LINE_AA)
    for pixel in pixels:
        cv2.circle(canvas, pixel, 4, colour, -1, cv2.LINE_AA)


def _draw_legend(canvas: np.ndarray, result: SweepResult, frames: int) -> None:
    _text(canvas, f'frames of {frames} with an object, over {result.name}', (_LEFT, 28), size=0.65)
    x = _LEFT
    for text, colour in (('one or more', _ANY), ('exactly one', _ONE),
                         (f'now: {result.current:g}', _NOW)):
        cv2.line(canvas, (x, 57), (x + 24, 57), colour, 3)
        x += _text(canvas, text, (x + 32, 62)) + 60
    _text(canvas, result.name, ((_LEFT + _WIDTH - _RIGHT) // 2, _HEIGHT - 16), align=0.5)


def _text(
    canvas: np.ndarray, text: str, corner: Tuple[int, int], *, align: float = 0.0,
    size: float = _SIZE
) -> int:
    """Write a text at, around (0.5) or before (1) a place; return its width in px."""
    width = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, size, 1)[0][0]
    cv2.putText(canvas, text, (round(corner[0] - align * width), corner[1]),
                cv2.FONT_HERSHEY_SIMPLEX, size, _INK, 1, cv2.LINE_AA)
    return width
