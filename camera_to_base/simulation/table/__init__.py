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

"""
The simulated table and what lies on it: wood or a print, objects, paper with a board or markers.

In: the camera's view of the surface, a seed and the conditions of the day. Out: pictures in grey
levels, where each object lies, and functions that draw on a picture.

Callers: the modules of `simulation`.
"""

from camera_to_base.simulation.table.drawing import draw_oval
from camera_to_base.simulation.table.empty_table import Table
from camera_to_base.simulation.table.objects import BoardObjects, true_object, TrueObject
from camera_to_base.simulation.table.printed_board import placed_board, RenderedBoard
from camera_to_base.simulation.table.printed_markers import PrintedMarkers

__all__ = [
    'BoardObjects', 'draw_oval', 'placed_board', 'PrintedMarkers', 'RenderedBoard', 'Table',
    'true_object', 'TrueObject',
]
