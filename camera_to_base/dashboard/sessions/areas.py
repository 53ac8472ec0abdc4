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

"""Areas that a person draws on the picture, as the parameters of the detector."""

from typing import Any, Dict, Mapping

from camera_to_base.checks import finite_numbers
from camera_to_base.dashboard.sessions.cell_values import CellChanges, CellValues
from camera_to_base.detection import Area, read_areas
from camera_to_base.errors import InvalidValueError
from camera_to_base.surface import Surface
import numpy as np

_MOST_CORNERS = 200


def areas_data(values: CellValues) -> Dict[str, Any]:
    """Describe the areas as JSON, in cm of the camera frame and in px."""
    if values.camera is None:
        return {'needs': 'camera_publisher does not run: start it.', 'work_area': None,
                'ignored_areas': []}
    areas = values.settings.detector.areas
    return {'needs': None, 'work_area': areas.work and _area_data(areas.work, values),
            'ignored_areas': [_area_data(area, values) for area in areas.ignored]}


def area_changes(values: CellValues, body: Mapping[str, Any]) -> CellChanges:
    """
    Return the parameters of areas that are drawn on the picture.

    :param body: {'work_area': a polygon of pixels or None, 'ignored_areas': polygons}; what is
        left out stays as it is.
    :raises CameraToBaseError: If one is no polygon, or not on the surface.
    """
    surface, wanted = values.settings.surface, {}
    if 'work_area' in body:
        polygon = body['work_area']
        corners = _corners(surface, polygon) if polygon else np.empty((0, 2))
        wanted['work_area'] = corners.ravel().tolist()
    if 'ignored_areas' in body:
        if not isinstance(body['ignored_areas'], list):
            raise InvalidValueError('ignored_areas must be a list of polygons')
        wanted['ignored_areas'] = '; '.join(
            _text(_corners(surface, polygon)) for polygon in body['ignored_areas'])
    read_areas(wanted.get('work_area', []), wanted.get('ignored_areas', ''))
    return CellChanges({'camera': wanted} if wanted else {}, [])


def _corners(surface: Surface, polygon: Any) -> np.ndarray:
    pixels = finite_numbers('the corners of an area', polygon, -1, 2)
    if len(pixels) > _MOST_CORNERS:
        raise InvalidValueError(f'an area may have {_MOST_CORNERS} corners, got {len(pixels)}')
    # To a hundredth of a mm.
    return np.round(surface.locate(pixels), 3)


def _text(corners: np.ndarray) -> str:
    return ', '.join(f'{x:.10g} {y:.10g}' for x, y in corners.tolist())


def _area_data(area: Area, values: CellValues) -> Dict[str, Any]:
    return {'px': [values.pixel_of(corner) for corner in area.corners.tolist()]}
