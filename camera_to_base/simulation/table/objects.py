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

"""Where the objects are on the simulated table."""

import math
from typing import List, NamedTuple, Optional, Tuple

from camera_to_base.simulation.conditions import BoardConditions
from camera_to_base.simulation.view import BoardView, Oval, SeenEllipse
import numpy as np

_YAW_STEP_DEG = 50.0
# The still objects, the largest first: diameter in cm, place as shares of the table that is seen.
_STILL = ((3.0, (0.5, 0.5)), (2.8, (0.29, 0.33)), (2.6, (0.71, 0.67)), (2.4, (0.71, 0.33)),
          (2.2, (0.29, 0.67)))


class TrueObject(NamedTuple):
    """
    The true state of an object.

    :param point: Where its centre is on the surface, x and y, in cm, in the camera frame.
    :param pixel: The centroid of its picture, u and v, in px.
    :param radius: Radius of a disc of the same area in the picture, in px.
    :param cut_off: Distance by which it exceeds the picture's edge, in px; negative inside.
    :param hidden: Whether a hand covers or touches it.
    :param yaw: The direction of its length about the camera frame's z, from x towards y, in rad,
        in (-pi/2, pi/2]; None for a round one.
    """

    point: Tuple[float, float]
    pixel: Tuple[float, float]
    radius: float
    cut_off: float
    hidden: bool
    yaw: Optional[float]


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

    def still(self) -> List[Oval]:
        """Return the objects at rest."""
        return [self._oval(index, diameter, (share_x * self._width_cm, share_y * self._height_cm))
                for index, (diameter, (share_x, share_y)) in enumerate(_STILL)]

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

    def _oval(self, index: int, length: float, point: Tuple[float, float]) -> Oval:
        elongation = self._conditions.elongation
        yaw_deg = self._conditions.yaw_deg + index * _YAW_STEP_DEG if elongation > 1 else 0.0
        return Oval(point, length / 2, length / 2 / elongation,
                    math.radians(90 - (90 - yaw_deg) % 180))


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
        oval.yaw if oval.half_length > oval.half_width else None)
