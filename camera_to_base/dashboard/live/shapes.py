# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""How objects stand on the surface: their footprints and boxes, on the picture and on the map."""

from typing import Any, Dict, List, Optional

from camera_to_base.dashboard.live.geometry import Geometry
from camera_to_base.dashboard.live.positions import SeenFrame
from camera_to_base.ros import SolidBox, SurfaceSilhouette
from camera_to_base.surface import RayedSilhouette
import cv2
import numpy as np

# A drawing shows no finer steps.
_STEP_CM = 0.05
# The thinnest box that can be shown; it is meant for a flat object.
_FLAT_CM = 0.1
# A disc has 0.79 of its box's area, a rectangle all of it; a longer object has a direction.
_ROUND_SHARE, _LEAST_ELONGATION = 0.87, 1.2
# Of a unit square.
_CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])

Points = List[List[float]]


def shapes_data(frame: Optional[SeenFrame], geometry: Optional[Geometry]) -> List[Dict[str, Any]]:
    """
    Describe the boxes and footprints of a frame's objects as JSON, in their order.

    :param frame: None where nothing is published.
    :param geometry: Where things are; None where it is not known.
    """
    if frame is None or geometry is None or not frame.boxes:
        return []
    silhouettes: List[Any] = list(frame.silhouettes)
    if len(silhouettes) != len(frame.boxes):  # One is beyond the horizon: whose is not told.
        silhouettes = [None] * len(frame.boxes)
    return [_shape(number, box, silhouette, geometry) for number, (box, silhouette) in enumerate(
        zip(frame.boxes, silhouettes), start=1) if box.length > 0]


def _shape(
    number: int, box: SolidBox, silhouette: Optional[SurfaceSilhouette], geometry: Geometry
) -> Dict[str, Any]:
    height = box.height if box.height > _FLAT_CM else 0.0
    seen = None if silhouette is None else silhouette.corners[:, :2]
    stands = _footprint(seen, height, geometry)
    # The box of a round object is turned by its noise alone.
    bottom = None if _may_be_round(box, stands) else _bottom(box)
    return {
        'number': number,
        'size_cm': [round(side, 1) for side in (box.length, box.width, height)],
        'picture': {
            'box': _pixels(bottom, geometry),
            'top': _pixels(_raised(
                stands if bottom is None else bottom, height, geometry), geometry),
            'footprint': _pixels(stands, geometry),
            'silhouette': _pixels(seen, geometry) if height else None},
        'map': {
            'box': geometry.in_base_frame(bottom), 'footprint': geometry.in_base_frame(stands),
            'silhouette': geometry.in_base_frame(seen) if height else None}}


def _bottom(box: SolidBox) -> np.ndarray:
    cosine, sine = np.cos(box.pose.yaw), np.sin(box.pose.yaw)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    return _CORNERS * [box.length, box.width] @ turn.T + box.pose[:2]


def _may_be_round(box: SolidBox, stands: Optional[np.ndarray]) -> bool:
    if box.length > _LEAST_ELONGATION * box.width:
        return False
    if stands is None:
        return True  # It may be.
    area = cv2.contourArea((stands - stands[0]).astype(np.float32))
    return area < _ROUND_SHARE * box.length * box.width


def _raised(bottom: np.ndarray, height_cm: float, geometry: Geometry) -> Optional[np.ndarray]:
    """Return the points of the surface that are hidden by points above it, in cm."""
    camera = geometry.settings.surface.camera_place
    if camera is None or not 0 < height_cm < camera.height_cm:
        return None
    foot = np.array(camera.foot_cm)
    return foot + (bottom - foot) / (1 - height_cm / camera.height_cm)


def _footprint(
    seen: Optional[np.ndarray], height_cm: float, geometry: Geometry
) -> Optional[np.ndarray]:
    camera = geometry.settings.surface.camera_place
    if seen is None or camera is None or not height_cm < camera.height_cm:
        return None
    if height_cm == 0:
        return seen
    rayed = RayedSilhouette(seen, camera.foot_cm)
    corners = rayed.footprint(height_cm / camera.height_cm).outline.corners
    if len(corners) < 3:
        return None
    return cv2.approxPolyDP(corners.astype(np.float32), _STEP_CM, True)[:, 0].astype(float)


def _pixels(points: Optional[np.ndarray], geometry: Geometry) -> Optional[Points]:
    if points is None:
        return None
    found = geometry.pixels(points)
    return None if None in found else np.round(found, 1).tolist()
