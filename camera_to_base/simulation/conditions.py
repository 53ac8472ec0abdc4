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

from camera_to_base.checks import finite_number, finite_numbers, whole_number


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

    noise: float = 2.0
    light_drift: float = 0.0
    exposure_step: float = 1.0
    shadow: float = 0.0
    hands: int = 0
    table_level: float = 202.0
    contrast: float = 142.0
    diameters_cm: Sequence[float] = (2.4,)
    elongation: float = 1.0
    yaw_deg: float = 0.0
    highlight: bool = False
    texture: float = 0.0
    over_edge: bool = False
    in_first_frame: bool = False
    rests: bool = False

    def __post_init__(self) -> None:
        """Check that the conditions can be rendered."""
        finite_number('noise', self.noise, 0.0, 100.0)
        finite_number('light_drift', self.light_drift, -255.0, 255.0)
        finite_number('exposure_step', self.exposure_step, 0.01, 100.0)
        finite_number('shadow', self.shadow, 0.0, 255.0)
        whole_number('hands', self.hands, 0, 100)
        finite_number('table_level', self.table_level, 1.0, 255.0)
        finite_number('contrast', self.contrast, -255.0, 255.0)
        finite_number('elongation', self.elongation, 1.0, 10.0)
        finite_number('yaw_deg', self.yaw_deg, -180.0, 180.0)
        finite_number('texture', self.texture, 0.0, 100.0)
        for diameter in finite_numbers('diameters_cm', self.diameters_cm, -1):
            finite_number('diameters_cm', diameter, 0.1, 100.0)
