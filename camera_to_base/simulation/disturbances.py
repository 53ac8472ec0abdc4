# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Bad days of the simulated picture: its light, noise and objects, hands, drift and steps."""

from dataclasses import dataclass
import math
from typing import Optional, Sequence

from camera_to_base.checks import ImageSize
from camera_to_base.simulation.specs import SIMULATION_DEFAULTS as _DEFAULTS
from camera_to_base.simulation.view import SeenEllipse
import numpy as np

_HAND_COLOUR = np.array([66.0, 86.0, 116.0], np.float32)
# An object nearer than this to a hand cannot be told from it in a picture, in px.
_HAND_MARGIN_PX = 6.0


@dataclass(frozen=True)
class BoardConditions:
    """
    Conditions of the simulated board; by default, only a little noise.

    :param noise: Standard deviation of the sensor's noise, in grey levels.
    :param light_drift: Change of the table's brightness in one round, in grey levels.
    :param exposure_step: The factor by which the camera's exposure jumps, in every other
        quarter of a round.
    :param shadow: Depth of a soft shadow that moves over the board, in grey levels.
    :param hands: How often a hand reaches into the picture in one round.
    :param table_level: The table's brightness, in grey levels.
    :param contrast: Objects are darker than the table by this; lighter if it is negative.
    :param diameters_cm: The diameter of each object.
    :param shapes: Of each object, one of `specs.SHAPES`; the first one follows the last one.
    :param heights_cm: Of each object, 0 for a flat one; the first one follows the last one.
    :param elongation: Length / width of the objects, whose length is the diameter; 1 for coins.
    :param yaw_deg: The direction of the first object's length, from x towards y, in degrees; each
        further one is turned by 50 degrees more.
    :param highlight: Whether flat discs have a spot that looks like the table.
    :param texture: Standard deviation of the table's pattern, in grey levels.
    :param over_edge: Whether the objects' paths lead beyond the picture's edge.
    :param in_first_frame: Whether the objects lie there on the first frame, the background.
    :param rests: Whether the objects stop on their way, for as long as they move.
    """

    noise: float = _DEFAULTS['noise']
    light_drift: float = _DEFAULTS['light_drift']
    exposure_step: float = _DEFAULTS['exposure_step']
    shadow: float = _DEFAULTS['shadow']
    hands: int = _DEFAULTS['hands']
    table_level: float = _DEFAULTS['table_level']
    contrast: float = _DEFAULTS['contrast']
    diameters_cm: Sequence[float] = tuple(_DEFAULTS['diameters_cm'])
    shapes: Sequence[str] = tuple(_DEFAULTS['shapes'])
    heights_cm: Sequence[float] = tuple(_DEFAULTS['heights_cm'])
    elongation: float = _DEFAULTS['elongation']
    yaw_deg: float = _DEFAULTS['yaw_deg']
    highlight: bool = _DEFAULTS['highlight']
    texture: float = _DEFAULTS['texture']
    over_edge: bool = _DEFAULTS['over_edge']
    in_first_frame: bool = _DEFAULTS['in_first_frame']
    rests: bool = _DEFAULTS['rests']


class BoardDisturbances:
    """
    Applies the conditions to the picture of a board.

    :param image_size: Width and height, in px.
    :param seed: Seed of the noise.
    """

    def __init__(self, image_size: ImageSize, conditions: BoardConditions, seed: int) -> None:
        self._width, self._height = image_size
        self._conditions = conditions
        self._seed = seed

    def disturb(self, picture: np.ndarray, number: int, rounds: float) -> None:
        """
        Apply the disturbances to a picture.

        :param picture: Shape (h, w, 3), float32; it is changed.
        :param number: The frame's, from 0.
        :param rounds: How many rounds of the objects have passed.
        """
        if number > 0:
            self._cast_shadow(picture, rounds)
        hand = self._hand(rounds)
        if hand is not None:
            self._draw_hand(picture, hand)
        picture *= np.float32(self._light(rounds))
        self._add_noise(picture, number)

    def hides(self, ellipse: SeenEllipse, rounds: float) -> bool:
        """Tell whether a hand covers or touches an object's picture."""
        hand = self._hand(rounds)
        return hand is not None and bool(
            self._hand_distance(hand, *ellipse.centre) < ellipse.half.max() + _HAND_MARGIN_PX)

    def _cast_shadow(self, picture: np.ndarray, rounds: float) -> None:
        if self._conditions.shadow > 0:
            height, width = picture.shape[:2]
            angle = 2 * math.pi * rounds
            u0 = width * (0.5 + 0.4 * math.sin(5 * angle))
            v0 = height * (0.5 + 0.4 * math.cos(4 * angle))
            v, u = np.ogrid[:height, :width]
            depth = np.clip(2 - 2 * np.hypot(u - u0, v - v0) / (0.2 * width), 0, 1)
            share = self._conditions.shadow / self._conditions.table_level
            soft = share * depth * depth * (3 - 2 * depth)
            picture *= (1 - soft)[:, :, None].astype(np.float32)

    def _hand(self, rounds: float) -> Optional[np.ndarray]:
        # A capsule from below the picture to the fingertips, at another place each time.
        visit, part = divmod(rounds * self._conditions.hands, 1)
        depth = math.sin(2 * math.pi * part)
        if self._conditions.hands == 0 or depth <= 0:
            return None
        u = self._width * (0.3 + 0.4 * (visit % 2) + 0.15 * math.cos(2 * math.pi * part))
        return np.array([u, self._height * (1.15 - 0.8 * depth)])

    def _hand_distance(self, tip: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.hypot(u - tip[0], np.minimum(v - tip[1], 0)) - 0.1 * self._width

    def _draw_hand(self, picture: np.ndarray, tip: np.ndarray) -> None:
        v, u = np.ogrid[:picture.shape[0], :picture.shape[1]]
        coverage = np.clip(0.5 - self._hand_distance(tip, u, v), 0, 1).astype(np.float32)
        picture += coverage[:, :, None] * (_HAND_COLOUR - picture)

    def _light(self, rounds: float) -> float:
        drift = max(1 + self._conditions.light_drift / self._conditions.table_level * rounds, 0.0)
        return drift * (self._conditions.exposure_step if int(4 * rounds) % 2 else 1.0)

    def _add_noise(self, picture: np.ndarray, number: int) -> None:
        if self._conditions.noise > 0:
            noise = np.random.default_rng((self._seed, number)).standard_normal(
                picture.shape, dtype=np.float32)
            picture += noise * np.float32(self._conditions.noise)
