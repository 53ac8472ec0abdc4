# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The work surface: from pixels to points in the camera frame, and back.

In: pixels of shape (n, 2), in px, and the parameters `surface.*`. Out: points of shape (n, 2), in
cm, on the surface. Models, lens distortion, the hull of a calibration, the camera's pose, the
footprints of solid objects and the view from above are here.

Callers: see the arrows in CONTRIBUTING. It imports numpy and OpenCV alone.
"""

from camera_to_base.surface.distortion import divide, RadialDistortion, undivide
from camera_to_base.surface.footprint import Footprint, Outline, RayedSilhouette
from camera_to_base.surface.lens import DISTORTION_MODELS, LensModel
from camera_to_base.surface.models import (
    homogeneous, HomographySurface, PolynomialSurface, Surface, SURFACE_DEFAULTS, SURFACE_SPECS)
from camera_to_base.surface.nudged import (
    as_homography, is_same_surface, NudgedSurface, PictureMap, towards_camera)
from camera_to_base.surface.parameters import make_hull, make_surface, surface_values
from camera_to_base.surface.pinhole import nearest_pinhole, PinholeSurface
from camera_to_base.surface.points import (
    check_inside, check_spread, Hull, MatchedPoints, on_one_line,
    PointPairs, sees_y_clockwise, surface_extent, top_view)
from camera_to_base.surface.thumbnail import read_thumbnail, shares_structure, view_thumbnail

__all__ = [
    'as_homography', 'check_inside', 'check_spread', 'DISTORTION_MODELS', 'divide',
    'Footprint', 'homogeneous', 'HomographySurface', 'Hull', 'is_same_surface', 'LensModel',
    'make_hull', 'make_surface', 'MatchedPoints', 'nearest_pinhole', 'NudgedSurface',
    'on_one_line', 'Outline', 'PictureMap', 'PinholeSurface', 'PointPairs',
    'PolynomialSurface', 'RadialDistortion', 'RayedSilhouette', 'read_thumbnail',
    'sees_y_clockwise', 'shares_structure', 'Surface', 'SURFACE_DEFAULTS', 'surface_extent',
    'SURFACE_SPECS', 'surface_values', 'top_view', 'towards_camera', 'undivide',
    'view_thumbnail',
]
