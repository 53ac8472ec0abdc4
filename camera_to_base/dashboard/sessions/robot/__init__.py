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
The robot's session: the base frame from objects that the camera sees and the robot touches.

In: the objects that are found, the tool's pose, and what a page asks for. Out: the session's
state, and the transform as parameters.

Caller: `dashboard.sessions.cell_sessions`.
"""

from camera_to_base.dashboard.sessions.robot.session import RobotSession

__all__ = ['RobotSession']
