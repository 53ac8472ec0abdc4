# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Where things are on the picture and on the map: the frames, the view, the objects' shapes."""

from typing import Any, Dict, List, Optional, Sequence

from camera_to_base.coordinate_transform import LEAST_ELONGATION
from camera_to_base.dashboard.live.positions import SeenFrame
from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import (
    checked_values, transform_node_settings, TRANSFORM_SPECS, TransformSettings, Values)
from camera_to_base.ros import SolidBox, SurfaceSilhouette
from camera_to_base.settings import camera_settings, CAMERA_SPECS, CameraSettings
from camera_to_base.surface import RayedSilhouette
import cv2
import numpy as np

# Points along each side of the picture: a side is no straight line with a lens that distorts.
_PER_SIDE = 9
# Of a grid on the picture: its steps, the most lines in a direction, and the points of each.
_STEPS_CM = (1, 2, 5, 10, 20, 50, 100, 200, 500)
_MOST_LINES = 9
_PER_LINE = 13
# Lines go on a little beyond the picture, and no pixel is farther away than this.
_BEYOND = 0.2
# A drawing shows no finer steps.
_STEP_CM = 0.05
# The thinnest box that can be shown; it is meant for a flat object.
_FLAT_CM = 0.1
# A disc has 0.79 of its box's area, a rectangle all of it.
_ROUND_SHARE = 0.87
# Of a unit square.
_CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])

Points = List[List[float]]


class Geometry:
    """
    Maps between picture, camera frame and base frame.

    :param camera: The camera node's parameters by name.
    :param transform: The transform node's; empty where it does not run.
    `map_data` is what the map from above shows, in cm in the base frame, as JSON.

    :raises CameraToBaseError: If the parameters cannot be used.
    """

    def __init__(self, camera: Values, transform: Values) -> None:
        self.settings: CameraSettings = camera_settings(checked_values(CAMERA_SPECS, camera))
        self.transform: Optional[TransformSettings] = transform_node_settings(
            checked_values(TRANSFORM_SPECS, transform)) if transform else None
        self.map_data = self._map_data()

    def pixels(self, points: Sequence[Sequence[float]]) -> List[Optional[List[float]]]:
        """
        Map points on the work surface to the picture.

        :param points: Shape (n, 2), x and y in the camera frame, in cm.
        :returns: Of each, u and v, in px; None if it has no pixel.
        """
        found = self.settings.surface.pixels(np.array(points, float))
        return [pixel if np.isfinite(pixel).all() else None for pixel in found.tolist()]

    def in_base_frame(self, points: Optional[np.ndarray]) -> Optional[List[List[float]]]:
        """
        Map points on the work surface to the base frame.

        :param points: Shape (n, 2), x and y in the camera frame, in cm; None for None.
        :returns: Of each, x and y, in cm; None where the transform is not known.
        """
        if points is None or self.transform is None:
            return None
        base_points = self.transform.conversion.convert_surface_points(points)
        return np.round(base_points[:, :2], 2).tolist()

    def _map_data(self) -> Dict[str, Any]:
        work = self.settings.detector.areas.work
        return {
            'reach_cm': self.transform and [0.0, self.transform.reach_cm],
            'view': self.in_base_frame(self._view()),
            'work_area': None if work is None else self.in_base_frame(work.corners)}

    @property
    def image_data(self) -> Dict[str, int]:
        """The picture's size as JSON."""
        width, height = self.settings.image_size
        return {'width': width, 'height': height}

    @property
    def grid_data(self) -> Dict[str, Any]:
        """The grids of both frames on the picture as JSON; None where one cannot be drawn."""
        view = self._view()
        unit = np.eye(3, 2)[[2, 0, 1]]
        in_base = None if self.transform is None else (
            self.transform.conversion.convert_surface_points(unit)[:, :2])
        return {'camera': None if view is None else self._grid(view, unit),
                'base': None if view is None or in_base is None else self._grid(view, in_base)}

    def _grid(self, view: np.ndarray, frame: np.ndarray) -> Optional[Dict[str, Any]]:
        """
        Return the lines of a frame.

        :param view: Points of the camera frame around what the picture shows, shape (n, 2), in cm.
        :param frame: Where the camera frame's origin and the ends of its unit vectors are in the
            frame, shape (3, 2), in cm.
        """
        axes = (frame[1:] - frame[0]).T
        if abs(np.linalg.det(axes)) < 1e-6:
            return None  # it looks along the surface
        placed = view @ axes.T + frame[0]
        low, high = placed.min(axis=0), placed.max(axis=0)
        step = next((one for one in _STEPS_CM if max(high - low) / one <= _MOST_LINES), None)
        if step is None:
            return None

        def pixels(points: np.ndarray) -> List[List[float]]:
            width, height = self.settings.image_size
            found = self.settings.surface.pixels((points - frame[0]) @ np.linalg.inv(axes).T)
            size = np.array([width, height])
            near = np.isfinite(found).all(axis=1)
            near[near] = (np.abs(found[near] / size - 0.5) < 0.5 + _BEYOND).all(axis=1)
            return np.round(found[near], 1).tolist()

        lines = []
        for axis, name in enumerate('xy'):
            along = np.linspace(low[1 - axis], high[1 - axis], _PER_LINE)
            for value in np.arange(np.ceil(low[axis] / step), high[axis] / step) * step:
                points = np.stack([np.full(_PER_LINE, value), along], axis=1)[:, ::1 - 2 * axis]
                lines.append({'name': f'{name} {value + 0.0:g}', 'points': pixels(points)})
        ends = pixels(np.array([[0.0, 0.0], [step, 0.0], [0.0, step]]))
        return {'step_cm': step, 'lines': [one for one in lines if len(one['points']) > 1],
                'axes': dict(zip(('origin', 'x', 'y'), ends)) if len(ends) == 3 else None}

    def _view(self) -> Optional[np.ndarray]:
        width, height = self.settings.image_size
        along = np.linspace(0, 1, _PER_SIDE)[:-1]
        corners = np.array([[0, 0], [width, 0], [width, height], [0, height]], float)
        sides = [start + along[:, None] * (end - start)
                 for start, end in zip(corners, np.roll(corners, -1, axis=0))]
        try:
            return self.settings.surface.locate(np.concatenate(sides))
        except CameraToBaseError:
            return None  # the picture shows the horizon


def shapes_data(frame: Optional[SeenFrame], geometry: Optional[Geometry]) -> List[Dict[str, Any]]:
    """
    Describe the boxes and footprints of a frame's objects as JSON, in their order.

    :param frame: None where nothing is published.
    :param geometry: Where things are; None where it is not known.
    """
    if frame is None or not frame.boxes:
        return []
    if frame.is_fused:
        return _fused_shapes(frame)
    if geometry is None:
        return []
    silhouettes: List[Any] = list(frame.silhouettes)
    if len(silhouettes) != len(frame.boxes):  # One is beyond the horizon: whose is not told.
        silhouettes = [None] * len(frame.boxes)
    return [_shape(number, box, silhouette, geometry) for number, (box, silhouette) in enumerate(
        zip(frame.boxes, silhouettes), start=1) if box.length > 0]


def _fused_shapes(frame: SeenFrame) -> List[Dict[str, Any]]:
    """Describe the boxes of a fused cell: they are in the base frame, and in no picture."""
    poses = frame.base if len(frame.base or []) == len(frame.boxes) else [None] * len(frame.boxes)
    # An object without a direction has the identity's; its box is turned by noise alone.
    return [{'number': number, 'size_cm': [round(side, 2) for side in box[1:]], 'picture': {},
             'map': {'box': np.round(_bottom(box), 2).tolist() if pose and pose.yaw else None}}
            for number, (box, pose) in enumerate(zip(frame.boxes, poses), start=1)]


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
    if box.length > LEAST_ELONGATION * box.width:
        return False
    if stands is None:
        return True  # It may be.
    area = cv2.contourArea((stands - stands[0]).astype(np.float32))
    return area < _ROUND_SHARE * box.length * box.width


def _raised(
    bottom: Optional[np.ndarray], height_cm: float, geometry: Geometry
) -> Optional[np.ndarray]:
    """Return the points of the surface that are hidden by points above it, in cm."""
    camera = geometry.settings.surface.camera_place
    if bottom is None or camera is None or not 0 < height_cm < camera.height_cm:
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
