# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The simulated table: plain, wood or print, where its objects are, and how they are drawn."""

import math
from typing import Collection, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.simulation.disturbances import BoardConditions
from camera_to_base.simulation.specs import DISC, PRINTED, WOOD
from camera_to_base.simulation.view import BoardView, Oval, SeenEllipse
import cv2
import numpy as np

_PLANK_CM, _PLANK_LENGTH_CM, _JOINT_CM = 9.0, 45.0, 0.12
_JOINT_LEVEL = -45.0
_CM2_PER_KNOT, _CM2_PER_FIGURE = 250.0, 12.0
# The rings of a knot, from outside: the share of its radius, and their level.
_KNOT_RINGS = ((1.0, -12.0), (0.75, -28.0), (0.5, -20.0), (0.3, -42.0))
# OpenCV's drawing functions take fractions of a pixel with this many bits.
_SHIFT = 4

# Offsets of blue, green and red from the grey level: no real material is exactly grey.
_TABLE_TINT = np.array([-6.0, 0.0, 6.0], np.float32)
_WOOD_COLOUR = np.array([0.56, 0.76, 0.98], np.float32)
# Faint lines every few cm show the tilt to the eye; they are below every detector's threshold.
_GRID_CM, _GRID_DEPTH = 4.5, 10.0
# How far wood and print go on beside the picture, as a share of its size; then they are mirrored.
_MARGIN = 0.6

_YAW_STEP_DEG = 50.0
# The still objects, the largest first: diameter in cm, place as shares of the table that is seen.
_STILL = ((3.0, (0.5, 0.5)), (2.8, (0.29, 0.33)), (2.6, (0.71, 0.67)), (2.4, (0.71, 0.33)),
          (2.2, (0.29, 0.67)))
# By how much a layout moves an object in x and y, in cm, and turns it, in degrees, at most.
_LAYOUT = np.array([1.5, 1.5, 90.0])

# Offsets of blue, green and red from the grey level.
_OBJECT_TINT = np.array([-8.0, 0.0, 10.0], np.float32)


class ReliefSize:
    """
    Size of a surface.

    :param width_cm: In cm.
    :param height_cm: In cm.
    :param cm_per_px: Of the picture of it.
    """

    def __init__(self, width_cm: float, height_cm: float, cm_per_px: float) -> None:
        self.width, self.height = round(width_cm / cm_per_px), round(height_cm / cm_per_px)
        self.cm2 = width_cm * height_cm
        self.px_per_cm = 1 / cm_per_px

    def point(self, random: np.random.Generator) -> np.ndarray:
        """Draw a point: x and y, in px."""
        return random.uniform(0, 1, 2) * [self.width, self.height]


def draw_wood(size: ReliefSize, random: np.random.Generator) -> np.ndarray:
    """
    Draw planks along x, each with its own grain and shade, with joints between them, and knots.

    :returns: Shape (h, w), float32, in grey levels, about 0.
    """
    relief = np.zeros((size.height, size.width), np.float32)
    for top in np.arange(0, size.height, _PLANK_CM * size.px_per_cm):
        bottom = min(top + _PLANK_CM * size.px_per_cm, size.height)
        _draw_plank(relief[int(top):int(bottom)], size.px_per_cm, random)
    for _ in range(round(size.cm2 / _CM2_PER_KNOT)):
        _draw_knot(relief, size.point(random), random.uniform(0.3, 0.7) * size.px_per_cm)
    return cv2.GaussianBlur(relief, (0, 0), 0.6)


def draw_print(size: ReliefSize, random: np.random.Generator) -> np.ndarray:
    """
    Draw frames, discs and lines of ink.

    :returns: Shape (h, w), float32, in grey levels, 0 and below.
    """
    relief = np.zeros((size.height, size.width), np.float32)
    for number in range(round(size.cm2 / _CM2_PER_FIGURE)):
        at, level = size.point(random), random.uniform(-70, -25)
        length, height = random.uniform(0.6, 5, 2) * size.px_per_cm
        line_px = max(1, round(0.1 * size.px_per_cm))
        if number % 3 == 0:
            cv2.rectangle(relief, _fixed(at), _fixed(at + [length, height]), level, line_px,
                          cv2.LINE_AA, _SHIFT)
        elif number % 3 == 1:
            cv2.circle(relief, _fixed(at), _fixed([length / 4])[0], level, -1, cv2.LINE_AA,
                       _SHIFT)
        else:
            cv2.line(relief, _fixed(at), _fixed(at + [length, -height]), level, line_px,
                     cv2.LINE_AA, _SHIFT)
    return cv2.GaussianBlur(relief, (0, 0), 0.6)


def _draw_plank(
    plank: np.ndarray, px_per_cm: float, random: np.random.Generator
) -> None:
    # Length and width of the grain in cm, and its standard deviation in grey levels.
    for length_cm, width_cm, level in ((2.5, 0.12, 9), (0.6, 0.08, 5), (9.0, 1.5, 5)):
        plank += level * _grain(plank.shape, length_cm * px_per_cm, width_cm * px_per_cm, random)
    plank += random.normal(0, 5)
    height, width = plank.shape
    joint_px = max(1, round(_JOINT_CM * px_per_cm))
    plank[:joint_px] = _JOINT_LEVEL
    length_px = _PLANK_LENGTH_CM * px_per_cm
    for end in np.arange(random.uniform(0, length_px), width, length_px).astype(int):
        plank[:, end:end + joint_px] = _JOINT_LEVEL


def _grain(
    shape: Tuple[int, int], length_px: float, width_px: float, random: np.random.Generator
) -> np.ndarray:
    # Noise that was drawn coarsely; its standard deviation is about 1.
    height, width = shape
    coarse = random.standard_normal(
        (max(2, round(height / width_px)), max(2, round(width / length_px))))
    return 1.3 * cv2.resize(
        coarse.astype(np.float32), (width, height), interpolation=cv2.INTER_CUBIC)


def _draw_knot(relief: np.ndarray, middle: np.ndarray, radius: float) -> None:
    for share, level in _KNOT_RINGS:
        axes = _fixed((1.6 * share * radius, share * radius))
        cv2.ellipse(relief, _fixed(middle), axes, 0, 0, 360, level, -1, cv2.LINE_AA, _SHIFT)


def _fixed(numbers: Sequence[float]) -> Tuple[int, ...]:
    return tuple(round(float(number) * 2 ** _SHIFT) for number in numbers)


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


class TrueObject(NamedTuple):
    """
    The true state of an object.

    :param point: Where its centre is on the surface, x and y, in cm, in the camera frame.
    :param pixel: The centroid of its picture, sides included, u and v, in px.
    :param radius: Radius of a disc of the same area in the picture, in px.
    :param cut_off: Distance by which it exceeds the picture's edge, in px; negative inside.
    :param hidden: Whether a hand covers or touches it.
    :param yaw: The direction of its length about the camera frame's z, from x towards y, in rad,
        in (-pi/2, pi/2]; None for a round one.
    :param size_cm: Length, width and height, in cm.
    :param angle: The direction of its length as it is drawn, also where that cannot be seen, in
        rad.
    """

    point: Tuple[float, float]
    pixel: Tuple[float, float]
    radius: float
    cut_off: float
    hidden: bool
    yaw: Optional[float]
    size_cm: Tuple[float, float, float]
    angle: float


class BoardObjects:
    """
    The objects that move, and those that lie still.

    :param view: The camera's at the start; the objects' places do not depend on its tilt.
    """

    def __init__(self, view: BoardView, conditions: BoardConditions) -> None:
        self._width_cm, self._height_cm = view.size_cm
        self._conditions = conditions

    def moving(self, rounds: float) -> List[Oval]:
        """Return the objects that move, after a number of rounds of their path."""
        return [self._oval(index, diameter, self.point(rounds, index))
                for index, diameter in enumerate(self._conditions.diameters_cm)]

    def still(self, layout: int = 0, taken: Collection[int] = ()) -> List[Oval]:
        """
        Return the objects at rest.

        :param layout: Moves and turns each of them, but 0.
        :param taken: Numbers of those that are not there, from 1.
        """
        random = np.random.default_rng(layout)
        ovals = []
        for index, (diameter, (share_x, share_y)) in enumerate(_STILL):
            x, y, turn_deg = random.uniform(-1, 1, 3) * _LAYOUT if layout else (0.0, 0.0, 0.0)
            point = (float(share_x * self._width_cm + x), float(share_y * self._height_cm + y))
            if index + 1 not in taken:
                ovals.append(self._oval(index, diameter, point, turn_deg))
        return ovals

    def point(self, rounds: float, index: int) -> Tuple[float, float]:
        """
        Return the position of a moving object: x and y, in cm, in the camera frame.

        Each object has its own part of the board, so they never meet.
        """
        part = rounds
        if self._conditions.rests:
            stage, within = divmod(part * 12, 1)
            part = (stage + min(2 * within, 1)) / 12
        # 2 and 3 rounds in x and y make a closed figure.
        angle = 2 * math.pi * part
        count = len(self._conditions.diameters_cm)
        reach_x, reach_y = (0.53, 0.53) if self._conditions.over_edge else (0.3, 0.25)
        return (self._width_cm / count * (index + 0.5 + reach_x * math.sin(2 * angle + index)),
                self._height_cm * (0.5 + reach_y * math.sin(3 * angle + index)))

    def _oval(
        self, index: int, length: float, point: Tuple[float, float], turn_deg: float = 0.0
    ) -> Oval:
        conditions, elongation = self._conditions, self._conditions.elongation
        shape = conditions.shapes[index % len(conditions.shapes)]
        is_turned = elongation > 1 or shape != DISC
        yaw_deg = conditions.yaw_deg + index * _YAW_STEP_DEG + turn_deg if is_turned else 0.0
        return Oval(point, length / 2, length / 2 / elongation,
                    math.radians(90 - (90 - yaw_deg) % 180), shape,
                    conditions.heights_cm[index % len(conditions.heights_cm)])


def true_object(oval: Oval, ellipse: SeenEllipse, view: BoardView, hidden: bool) -> TrueObject:
    """
    Return the true state of an object in a picture.

    :param ellipse: Its picture.
    """
    last = np.array([view.width, view.height]) - 0.5
    cut_off = max((ellipse.half - ellipse.centre).max() - 0.5,
                  (ellipse.centre + ellipse.half - last).max())
    return TrueObject(
        oval.point, tuple(ellipse.centre), ellipse.radius, float(cut_off), hidden,
        oval.yaw if oval.half_length > oval.half_width else None,
        (2 * oval.half_length, 2 * oval.half_width, oval.height_cm), oval.yaw)


def draw_oval(
    picture: np.ndarray, oval: Oval, view: BoardView, conditions: BoardConditions
) -> None:
    """
    Draw an object.

    :param picture: Shape (h, w, 3), float32, BGR; it is changed.
    """
    rows, columns = view.window(view.ellipse(oval))
    window = picture[rows, columns]
    if window.size == 0:
        return
    coverage = view.coverage(oval, rows, columns)
    if conditions.highlight:
        coverage -= view.coverage(_highlight(oval), rows, columns)
    colour = conditions.table_level - conditions.contrast + _OBJECT_TINT
    window += coverage[:, :, None].astype(np.float32) * (colour - window)


def _highlight(oval: Oval) -> Oval:
    x, y = oval.point
    offset, radius = 0.3 * oval.half_width, 0.35 * oval.half_width
    return Oval((x - offset, y - offset), radius, radius, 0.0)
