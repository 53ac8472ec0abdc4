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
The work surface: from pixels to points in the camera frame, and back.

In: pixels of shape (n, 2), in px, and the parameters `surface.*`. Out: points of shape (n, 2), in
cm, on the surface or below the tops of raised objects. Models, lens distortion, the hull of a
calibration, the camera's pose and the view from above are here.

Callers: all rooms below. It imports numpy and OpenCV alone.
"""

from camera_to_base.image_size import ImageSize
from camera_to_base.surface.distortion import divide, RadialDistortion, undivide
from camera_to_base.surface.equivalence import as_homography, is_same_surface
from camera_to_base.surface.hull import Hull
from camera_to_base.surface.matched_points import (
    check_inside, check_spread, MatchedPoints, on_one_line, PointPairs)
from camera_to_base.surface.models import (
    homogeneous, HomographySurface, PolynomialSurface, Surface)
from camera_to_base.surface.nudged import NudgedSurface, PictureMap
from camera_to_base.surface.parameters import make_hull, make_surface, surface_values
from camera_to_base.surface.pose import camera_pose, CameraIntrinsics
from camera_to_base.surface.raised import flat_surface, RaisedSurface
from camera_to_base.surface.rectification import sees_y_clockwise, surface_extent, top_view
from camera_to_base.surface.specs import SURFACE_DEFAULTS, SURFACE_SPECS

__all__ = [
    'as_homography', 'camera_pose', 'CameraIntrinsics', 'check_inside', 'check_spread', 'divide',
    'flat_surface', 'homogeneous', 'HomographySurface', 'Hull', 'ImageSize', 'is_same_surface',
    'make_hull', 'make_surface', 'MatchedPoints', 'NudgedSurface', 'on_one_line', 'PictureMap',
    'PointPairs', 'PolynomialSurface', 'RadialDistortion', 'RaisedSurface', 'sees_y_clockwise',
    'Surface', 'SURFACE_DEFAULTS', 'surface_extent', 'SURFACE_SPECS', 'surface_values', 'top_view',
    'undivide',
]
