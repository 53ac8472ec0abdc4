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
Markers: square markers (ArUco) that lie on the work surface.

In: a picture, and the corners of the markers on the surface in cm. Out: markers in px.

Callers: all rooms below. It imports numpy and OpenCV alone.
"""

from camera_to_base.markers.aruco import CELLS, find_markers, marker_cells, MARKER_COUNT

__all__ = ['CELLS', 'find_markers', 'marker_cells', 'MARKER_COUNT']
