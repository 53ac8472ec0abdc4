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
Live calibration of the base frame: objects that a camera sees, and the robot's touches of them.

In: a parameter file, and a running node or a camera. Out: pairs of places, one for each object.

Callers: `commands.calibrate.base` and `commands.calibrate.marker_base`.
"""

from camera_to_base.commands.calibrate.live.camera import display_text, FreshFrames
from camera_to_base.commands.calibrate.live.pairs import (
    collect, KeptPairs, measure_again, touch_elsewhere)
from camera_to_base.commands.calibrate.live.sources import (
    open_positions, open_robot, Positions, Robot)

__all__ = [
    'collect', 'display_text', 'FreshFrames', 'KeptPairs', 'measure_again', 'open_positions',
    'open_robot', 'Positions', 'Robot', 'touch_elsewhere',
]
