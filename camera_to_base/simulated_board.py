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

"""A work surface with objects moving over it, rendered: a frame source that knows the truth."""

import math
from typing import List, NamedTuple, Optional, Tuple

from camera_to_base.board_conditions import BoardConditions
from camera_to_base.board_view import BoardView
from camera_to_base.checks import finite_number, whole_number
from camera_to_base.surface import ImageSize
import cv2
import numpy as np

# Differences of blue, green and red to the grey level: nothing real is quite grey.
_TABLE_TINT = np.array([-6.0, 0.0, 6.0], np.float32)
_OBJECT_TINT = np.array([-8.0, 0.0, 10.0], np.float32)
_HAND_COLOUR = np.array([66.0, 86.0, 116.0], np.float32)
# Faint lines every few cm let the eye see the tilt; no detector sees them.
_GRID_CM, _GRID_DEPTH = 4.5, 10.0
# One round of the path takes this long; 2 and 3 rounds in x and y make a closed figure.
_ROUND_S = 60.0
# How close to a hand an object's edge can come before a picture does not tell them apart, px.
_HAND_MARGIN_PX = 6.0


class TrueObject(NamedTuple):
    """
    An object as it is.

    :param point: Where its centre is on the surface, x and y, in cm, in the camera frame.
    :param pixel: The centroid of its picture, u and v, in px.
    :param radius: Half of its picture's shorter side, in px.
    :param cut_off: By how many px it is beyond the picture's edge; negative where it is inside.
    :param hidden: Whether a hand covers or touches it.
    """

    point: Tuple[float, float]
    pixel: Tuple[float, float]
    radius: float
    cut_off: float
    hidden: bool


class SimulatedBoard:
    """
    Frames of objects that move over a board, seen by a pinhole camera, see :class:`BoardView`.

    The first frame shows the empty board, unless the conditions say otherwise.

    :param image_size: Width and height, in px.
    :param width_cm: What the picture's width sees of the surface at tilt 0, in cm.
    :param tilt_deg: 0 looks straight down; up to 60, in degrees.
    :param seed: Makes noise and texture; the same seed gives the same frames.
    :param frame_rate: Frames per second of the objects' time.
    :param conditions: Light, noise, objects: the fields of :class:`BoardConditions`.
    :raises InvalidValueError: If a value cannot be used.
    :raises HorizonError: If the picture would reach the horizon.
    """

    def __init__(
        self,
        *,
        image_size: ImageSize = (640, 480),
        width_cm: float = 36.0,
        tilt_deg: float = 0.0,
        seed: int = 0,
        frame_rate: float = 10.0,
        **conditions,
    ) -> None:
        self._view = BoardView(image_size, width_cm, tilt_deg)
        self._conditions = BoardConditions(**conditions)
        self._seed = whole_number('seed', seed, 0, 2**31 - 1)
        self.frame_rate = finite_number('frame_rate', frame_rate, 0.1, 1000.0)
        self._table = self._draw_table()
        self._frame_count = 0
        self.true_objects: List[TrueObject] = []

    @property
    def pixel_from_surface(self) -> np.ndarray:
        """Homography from cm in the camera frame to px, shape (3, 3)."""
        return self._view.pixel_from_surface.copy()

    @property
    def surface_from_pixel(self) -> np.ndarray:
        """Homography from px to cm in the camera frame, shape (3, 3): what calibration finds."""
        return self._view.surface_from_pixel.copy()

    @property
    def true_point(self) -> Optional[Tuple[float, float]]:
        """Tell the largest whole object's x and y on the last frame, in cm; None without one."""
        whole = [true for true in self.true_objects if true.cut_off < 0 and not true.hidden]
        return max(whole, key=lambda true: true.radius).point if whole else None

    def read(self) -> np.ndarray:
        """
        Render the next frame; from then on `true_objects` are the objects on it.

        :returns: Shape (h, w, 3), uint8, BGR.
        """
        number, self._frame_count = self._frame_count, self._frame_count + 1
        picture, hand = self._table.copy(), self._hand(number)
        self.true_objects = []
        if number > 0 or self._conditions.in_first_frame:
            for index, diameter in enumerate(self._conditions.diameters_cm):
                point = self.object_point(number, index)
                self._draw_object(picture, point, diameter / 2)
                self.true_objects.append(self._true_object(point, diameter / 2, hand))
        self._cast_shadow(picture, number)
        if hand is not None:
            self._draw_hand(picture, hand)
        picture *= np.float32(self._light(number))
        self._add_noise(picture, number)
        return np.clip(np.rint(picture), 0, 255).astype(np.uint8)

    def release(self) -> None:
        """Do nothing: there is no device to give back."""

    def object_point(self, number: int, index: int = 0) -> Tuple[float, float]:
        """
        Tell where an object is.

        :param number: The frame's, from 0.
        :param index: The object's; each has a part of the board to itself, they never meet.
        :returns: x and y, in cm, in the camera frame.
        """
        part = self._round(number)
        if self._conditions.rests:
            stage, within = divmod(part * 12, 1)
            part = (stage + min(2 * within, 1)) / 12
        angle = 2 * math.pi * part
        count = len(self._conditions.diameters_cm)
        reach_x, reach_y = (0.53, 0.53) if self._conditions.over_edge else (0.3, 0.25)
        width_cm = self._view.cm_per_px * self._view.width
        height_cm = self._view.cm_per_px * self._view.height
        return (width_cm / count * (index + 0.5 + reach_x * math.sin(2 * angle + index)),
                height_cm * (0.5 + reach_y * math.sin(3 * angle + index)))

    def _round(self, number: int) -> float:
        return number / self.frame_rate / _ROUND_S

    def _true_object(
        self, point: Tuple[float, float], radius: float, hand: Optional[np.ndarray]
    ) -> TrueObject:
        centre, half = self._view.ellipse(point, radius)
        last = np.array([self._view.width, self._view.height]) - 0.5
        cut_off = max((half - centre).max() - 0.5, (centre + half - last).max())
        hidden = hand is not None and self._hand_distance(
            hand, *centre) < half.max() + _HAND_MARGIN_PX
        return TrueObject(point, tuple(centre), float(half.min()), float(cut_off), bool(hidden))

    def _draw_table(self) -> np.ndarray:
        everything = slice(0, self._view.height), slice(0, self._view.width)
        offset = (self._view.points(*everything) + _GRID_CM / 2) % _GRID_CM - _GRID_CM / 2
        line = np.clip(1 - np.abs(offset).min(axis=2) / self._view.cm_per_px, 0, 1)
        level = self._conditions.table_level - _GRID_DEPTH * line
        if self._conditions.texture > 0:
            grain = np.random.default_rng((self._seed, 0, 0)).standard_normal(
                level.shape, dtype=np.float32)
            grain = cv2.GaussianBlur(grain, (0, 0), 3.0)
            level += grain * (self._conditions.texture / grain.std())
        return level[:, :, None].astype(np.float32) + _TABLE_TINT

    def _draw_object(
        self, picture: np.ndarray, point: Tuple[float, float], radius: float
    ) -> None:
        rows, columns = self._view.window(self._view.ellipse(point, radius))
        window = picture[rows, columns]
        if window.size == 0:
            return
        coverage = self._view.coverage(point, radius, rows, columns)
        if self._conditions.highlight:
            spot = point[0] - 0.3 * radius, point[1] - 0.3 * radius
            coverage -= self._view.coverage(spot, 0.35 * radius, rows, columns)
        colour = self._conditions.table_level - self._conditions.contrast + _OBJECT_TINT
        window += coverage[:, :, None].astype(np.float32) * (colour - window)

    def _cast_shadow(self, picture: np.ndarray, number: int) -> None:
        if self._conditions.shadow > 0 and number > 0:
            height, width = picture.shape[:2]
            angle = 2 * math.pi * self._round(number)
            u0 = width * (0.5 + 0.4 * math.sin(5 * angle))
            v0 = height * (0.5 + 0.4 * math.cos(4 * angle))
            v, u = np.ogrid[:height, :width]
            depth = np.clip(2 - 2 * np.hypot(u - u0, v - v0) / (0.2 * width), 0, 1)
            share = self._conditions.shadow / self._conditions.table_level
            soft = share * depth * depth * (3 - 2 * depth)
            picture *= (1 - soft)[:, :, None].astype(np.float32)

    def _hand(self, number: int) -> Optional[np.ndarray]:
        # A capsule from below the picture to where the fingers are; every time somewhere else.
        visit, part = divmod(self._round(number) * self._conditions.hands, 1)
        depth = math.sin(2 * math.pi * part)
        if self._conditions.hands == 0 or depth <= 0:
            return None
        u = self._view.width * (0.3 + 0.4 * (visit % 2) + 0.15 * math.cos(2 * math.pi * part))
        return np.array([u, self._view.height * (1.15 - 0.8 * depth)])

    def _hand_distance(self, tip: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.hypot(u - tip[0], np.minimum(v - tip[1], 0)) - 0.1 * self._view.width

    def _draw_hand(self, picture: np.ndarray, tip: np.ndarray) -> None:
        v, u = np.ogrid[:picture.shape[0], :picture.shape[1]]
        coverage = np.clip(0.5 - self._hand_distance(tip, u, v), 0, 1).astype(np.float32)
        picture += coverage[:, :, None] * (_HAND_COLOUR - picture)

    def _light(self, number: int) -> float:
        part = self._round(number)
        drift = max(1 + self._conditions.light_drift / self._conditions.table_level * part, 0.0)
        return drift * (self._conditions.exposure_step if int(4 * part) % 2 else 1.0)

    def _add_noise(self, picture: np.ndarray, number: int) -> None:
        if self._conditions.noise > 0:
            noise = np.random.default_rng((self._seed, number)).standard_normal(
                picture.shape, dtype=np.float32)
            picture += noise * np.float32(self._conditions.noise)
