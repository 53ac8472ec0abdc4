# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Where things are, from the parameters of a cell's two nodes."""

from typing import Any, Dict, List, Optional, Sequence

from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import (
    checked_values, transform_node_settings, TRANSFORM_SPECS, TransformSettings, Values)
from camera_to_base.settings import camera_settings, CAMERA_SPECS, CameraSettings
import numpy as np

# Points along each side of the picture: a side is no straight line with a lens that distorts.
_PER_SIDE = 9


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

    def _map_data(self) -> Dict[str, Any]:
        work = self.settings.detector.areas.work
        return {
            'reach_cm': self.transform and [0.0, self.transform.reach_cm],
            'view': self._in_base_frame(self._view()),
            'work_area': None if work is None else self._in_base_frame(work.corners)}

    @property
    def image_data(self) -> Dict[str, int]:
        """The picture's size as JSON."""
        width, height = self.settings.image_size
        return {'width': width, 'height': height}

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

    def _in_base_frame(self, points: Optional[np.ndarray]) -> Optional[List[List[float]]]:
        if points is None or self.transform is None:
            return None
        base_points = self.transform.conversion.convert_surface_points(points)
        return np.round(base_points[:, :2], 3).tolist()
