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
The simulated cell: what the camera node offers with `source:=simulated` alone.

In: the simulated board and the node's settings. Out: the true positions, the pose of the simulated
robot's tool, and a service that bumps the camera.

Callers: `nodes.feeds` and `nodes.positions`.
"""

from camera_to_base.nodes.simulated.bump_service import BumpService
from camera_to_base.nodes.simulated.tool import SimulatedTool
from camera_to_base.nodes.simulated.true_positions import TruePositions

__all__ = ['BumpService', 'SimulatedTool', 'TruePositions']
