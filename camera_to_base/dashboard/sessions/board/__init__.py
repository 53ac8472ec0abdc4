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
The board's session: the surface from a board that a person lays on the table several times.

In: the newest frames, and what a page asks for. Out: the session's state and its pictures, and the
surface as parameters.

Caller: `dashboard.sessions.cell_sessions`.
"""

from camera_to_base.dashboard.sessions.board.data import PANEL_NAMES
from camera_to_base.dashboard.sessions.board.session import BoardSession

__all__ = ['BoardSession', 'PANEL_NAMES']
