# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Markers: square markers (ArUco) that lie on the work surface.

In: a picture, the parameters `markers.*` and `surface.*`. Out: markers in px, the surface computed
anew where the camera was moved, with its covariance, and which markers were moved.

Callers: see the arrows in CONTRIBUTING. It imports numpy and OpenCV alone; where OpenCV was built
without the module aruco, everything else works.
"""

from camera_to_base.markers.find import (
    CELLS, find_markers, has_markers, marker_cells, MARKER_COUNT, NO_ARUCO, paper_corners,
    see_markers, SeenMarkers, TABLE_MARKERS)
from camera_to_base.markers.fit import (
    Corners, judge_markers, known_markers, LEAST_MARKERS, MARKER_SPECS, marker_values, MarkerFit,
    MarkerVerdict, refuse_polynomial)
from camera_to_base.markers.marked_surface import (
    lens_of_values, MarkedSurface, marker_surface, MarkerLook, new_surface_values, NewSurface)

__all__ = [
    'CELLS', 'Corners', 'find_markers', 'has_markers', 'judge_markers', 'known_markers',
    'LEAST_MARKERS', 'lens_of_values', 'MarkedSurface', 'marker_cells', 'MARKER_COUNT',
    'MARKER_SPECS', 'marker_surface', 'marker_values', 'MarkerFit', 'MarkerLook', 'MarkerVerdict',
    'new_surface_values', 'NewSurface', 'NO_ARUCO', 'paper_corners', 'refuse_polynomial',
    'see_markers', 'SeenMarkers', 'TABLE_MARKERS',
]
