# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Detection: finds the objects on a frame, and their positions on the surface.

In: a frame, a background picture of the same size and the parameters `detector.*`. Out: detections
in px, and located objects in cm, the largest first.

Callers: `pipeline` and the rooms that use its results. It imports only numpy and OpenCV;
`pipeline` decides whether a position may be published.
"""

from camera_to_base.detection.background import (
    BackgroundTaker, changed_blocks, has_changed_block, mean_blocks, median_of, smoothed_noise,
    white_noise)
from camera_to_base.detection.detection import (
    Box, Detection, NoObject, Pixel, random_pixel, touches_edge)
from camera_to_base.detection.left_out import LeftOut, locate_pixel, Point, REASONS
from camera_to_base.detection.locator import (
    Found, LocatedObject, object_shape, ObjectLocator)
from camera_to_base.detection.on_surface import object_on_surface
from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.detection.settings import (
    Area, AREA_SPECS, Areas, BACKGROUND_SPECS, DETECTOR_SPECS, DetectorSettings,
    HEIGHT_SPECS, read_areas, read_polygons)
from camera_to_base.detection.solid import (
    object_heights, Sides, sides_of, silhouette_on_surface, Size)
from camera_to_base.detection.tutorial import AbsoluteDifferenceDetector

__all__ = [
    'AbsoluteDifferenceDetector', 'Area', 'AREA_SPECS', 'Areas', 'BACKGROUND_SPECS',
    'BackgroundTaker', 'Box', 'changed_blocks', 'Detection', 'DETECTOR_SPECS', 'DetectorSettings',
    'Found', 'has_changed_block', 'HEIGHT_SPECS', 'LeftOut', 'locate_pixel', 'LocatedObject',
    'mean_blocks', 'median_of', 'NoObject', 'object_heights', 'object_on_surface',
    'object_shape', 'ObjectLocator', 'Pixel', 'Point', 'PreciseDifferenceDetector',
    'random_pixel', 'read_areas', 'read_polygons', 'REASONS', 'Sides', 'sides_of',
    'silhouette_on_surface', 'Size', 'smoothed_noise', 'touches_edge', 'white_noise',
]
