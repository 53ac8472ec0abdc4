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

"""How the simulated camera is moved: by a person, by a bump."""

import math
from typing import Any, Dict, NamedTuple, Tuple

from camera_to_base.parameters import Values
from camera_to_base.simulation.specs import SIMULATION_DEFAULTS as _DEFAULTS
import numpy as np


class CameraMove(NamedTuple):
    """
    A camera's way from its first pose to another one; any pose can be reached.

    :param shift_px: The picture of the table moves to the right and down by this, at tilt 0.
    :param turn_deg: The picture turns clockwise about its middle by this.
    :param tilt_deg: The camera is tilted further about the point at its picture's middle: so that
        the top, and so that the left of the picture shows more distant points.
    :param zoom: The camera comes nearer by this factor.
    """

    shift_px: Tuple[float, float] = tuple(_DEFAULTS['camera_shift_px'])
    turn_deg: float = _DEFAULTS['camera_turn_deg']
    tilt_deg: Tuple[float, float] = tuple(_DEFAULTS['camera_tilt_deg'])
    zoom: float = _DEFAULTS['camera_zoom']

    def rotation(self, tilt: float) -> np.ndarray:
        """
        Return the rotation from the surface to the moved camera.

        :param tilt: The camera's before the move, in rad.
        :returns: Shape (3, 3).
        """
        about_u, about_v = np.deg2rad(self.tilt_deg)
        return (_about_axis(math.radians(self.turn_deg)) @ _about_u(tilt + about_u)
                @ _about_v(about_v))

    def times(self, factor: float) -> 'CameraMove':
        """Return a move of the same kind, larger by a factor, for small moves."""
        def scaled(pair: Tuple[float, float]) -> Tuple[float, float]:
            return pair[0] * factor, pair[1] * factor

        return CameraMove(scaled(self.shift_px), self.turn_deg * factor, scaled(self.tilt_deg),
                          1 + (self.zoom - 1) * factor)


def camera_move(values: Values) -> CameraMove:
    """Make the move of the parameters, named without 'simulated.'."""
    return CameraMove(tuple(values['camera_shift_px']), values['camera_turn_deg'],
                      tuple(values['camera_tilt_deg']), values['camera_zoom'])


def move_parameters(move: CameraMove) -> Dict[str, Any]:
    """Return the parameters of a move, by their full names."""
    return {'simulated.camera_shift_px': list(move.shift_px),
            'simulated.camera_turn_deg': move.turn_deg,
            'simulated.camera_tilt_deg': list(move.tilt_deg),
            'simulated.camera_zoom': move.zoom}


def _about_axis(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])


def _about_u(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, cos, sin], [0, -sin, cos]])


def _about_v(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
