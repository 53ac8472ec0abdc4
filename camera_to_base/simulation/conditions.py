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

"""Light, noise and objects of the simulated board."""

from dataclasses import dataclass
from typing import Sequence

from camera_to_base.simulation.specs import SIMULATION_DEFAULTS as _DEFAULTS


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
    :param elongation: Length / width of the objects, whose length is the diameter; 1 for coins.
    :param yaw_deg: The direction of the first oval's length, from x towards y, in degrees; each
        further one is turned by 50 degrees more.
    :param highlight: Whether objects have a spot that looks like the table.
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
    elongation: float = _DEFAULTS['elongation']
    yaw_deg: float = _DEFAULTS['yaw_deg']
    highlight: bool = _DEFAULTS['highlight']
    texture: float = _DEFAULTS['texture']
    over_edge: bool = _DEFAULTS['over_edge']
    in_first_frame: bool = _DEFAULTS['in_first_frame']
    rests: bool = _DEFAULTS['rests']
