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
Markers on the surface: whether the camera stands where the surface in use holds.

In: frames, why the view of each cannot be believed, and the surface in use. Out: a surface for
where the camera stands, whether to take a new background, reasons, and where markers are seen.

Caller: `trust.pipeline`.
"""

from camera_to_base.trust.markers.marker_view import MarkerSettings, MarkerView
from camera_to_base.trust.markers.marker_watch import MarkerWatch

__all__ = ['MarkerSettings', 'MarkerView', 'MarkerWatch']
