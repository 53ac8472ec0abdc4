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

In: the records of frames, also of those whose view cannot be believed. Out: the records, with
another standpoint where the camera was moved, with the wish for a new background, with reasons,
and without the markers that were found as objects.

Caller: `trust.pipeline`.
"""

from camera_to_base.trust.markers.marker_watch import MarkerSettings, MarkerWatch

__all__ = ['MarkerSettings', 'MarkerWatch']
