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
Markers: which of the printed markers the camera sees, and where they lie on the surface.

In: frames, the cell's parameters, what a page asks for. Out: the state as JSON, what is to be set
on the nodes.

Caller: `cell_sessions`.
"""

from camera_to_base.dashboard.sessions.markers.session import MarkerSession

__all__ = ['MarkerSession']
