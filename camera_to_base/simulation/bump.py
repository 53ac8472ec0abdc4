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

"""Random bumps of the simulated camera."""

from camera_to_base.simulation.camera_move import CameraMove
from camera_to_base.simulation.view import BoardView
import numpy as np

# By how far a bump moves the corner of the picture that it moves farthest, in px.
_BUMP_PX = 4.0, 15.0
# Standard deviations before the bump is scaled: px at VGA, degrees, degrees, factor.
_SHIFT, _TURN_DEG, _TILT_DEG, _ZOOM = 5.0, 0.4, 0.4, 0.008


def largest_shift_px(view: BoardView, moved: BoardView) -> float:
    """Return how far a move takes the picture's corner that it takes farthest, in px."""
    right, bottom = view.width - 1.0, view.height - 1.0
    corners = np.array([[0, 0], [right, 0], [0, bottom], [right, bottom]])
    points = np.array([view.point(corner) for corner in corners])
    return float(np.hypot(*(moved.pixels(points) - corners).T).max())


def random_bump(random: np.random.Generator, view: BoardView) -> CameraMove:
    """Draw a bump of a camera: shift, turn, tilt and zoom at once, a few px in all."""
    unscaled = CameraMove(
        tuple(random.normal(0, _SHIFT, 2)), random.normal(0, _TURN_DEG),
        tuple(random.normal(0, _TILT_DEG, 2)), 1 + random.normal(0, _ZOOM))
    return _rounded(unscaled.times(
        random.uniform(*_BUMP_PX) / largest_shift_px(view, view.moved(unscaled))))


def _rounded(move: CameraMove) -> CameraMove:
    # As a person would write it; plain floats, as parameters take them.
    def pair(numbers: tuple) -> tuple:
        return tuple(round(float(number), 2) for number in numbers)

    return CameraMove(pair(move.shift_px), round(float(move.turn_deg), 3), pair(move.tilt_deg),
                      round(float(move.zoom), 5))
