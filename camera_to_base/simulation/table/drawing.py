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

"""Draws the objects on the simulated table."""

from camera_to_base.simulation.conditions import BoardConditions
from camera_to_base.simulation.view import BoardView, Oval
import numpy as np

# Offsets of blue, green and red from the grey level.
_OBJECT_TINT = np.array([-8.0, 0.0, 10.0], np.float32)


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
