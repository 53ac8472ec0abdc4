# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What a person says of the table: areas, flat objects; what lies on the simulated one."""

from typing import Any, Callable, Dict, Mapping

from camera_to_base.checks import finite_numbers
from camera_to_base.dashboard.sessions.values import CellChanges, CellValues
from camera_to_base.detection import Area, read_areas
from camera_to_base.errors import InvalidValueError
from camera_to_base.sources import kind_of, SIMULATED
from camera_to_base.surface import Surface
import numpy as np

_MOST_CORNERS = 200

_SHOWS, _PLACEMENT, _TOUCHED = 'simulated.shows', 'simulated.placement', 'simulated.touched'
_PLACEMENTS = 8
# Where the simulated robot publishes its tool's pose, in the cell's namespace.
TOOL_TOPIC = 'simulated_tool'
_WORDS = {'objects': 'Coins move over the simulated table.',
          'still_objects': 'Five coins lie on the simulated table.',
          'board': 'The printed board lies on the simulated table.',
          'empty': 'The simulated table is empty.'}


class FlatObjects:
    """
    Whether a person has said that objects which look solid are flat.

    :param on_change: Called when the state has changed.
    """

    def __init__(self, on_change: Callable[[], None]) -> None:
        self._on_change = on_change
        self.are_flat = False

    @property
    def state(self) -> Dict[str, Any]:
        """The state as JSON."""
        return {'flat': self.are_flat}

    def tell(self, body: Mapping[str, Any]) -> None:
        """
        Say that they are, or ask again.

        :param body: {'flat': whether they are}.
        :raises InvalidValueError: If it says neither.
        """
        if not isinstance(body.get('flat'), bool):
            raise InvalidValueError('flat must be true or false')
        self.are_flat = body['flat']
        self._on_change()


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

    :param body: {'work_area': a polygon or None, 'ignored_areas': polygons}; what is left out
        stays as it is. A corner is a pixel [u, v], or {'x', 'y'} in cm, which stays exactly so.
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
    if not isinstance(polygon, list) or len(polygon) > _MOST_CORNERS:
        raise InvalidValueError(
            f'an area must be a list of at most {_MOST_CORNERS} corners, got {polygon!r:.60}')
    kept = [isinstance(corner, dict) for corner in polygon]
    corners = finite_numbers('the corners of an area', [
        [corner.get('x'), corner.get('y')] if is_kept else corner
        for corner, is_kept in zip(polygon, kept)], -1, 2)
    drawn = ~np.array(kept, bool)
    if drawn.any():
        # To a hundredth of a mm.
        corners[drawn] = np.round(surface.locate(corners[drawn]), 3)
    return corners


def _text(corners: np.ndarray) -> str:
    return ', '.join(f'{x!r} {y!r}' for x, y in corners.tolist())


def _area_data(area: Area, values: CellValues) -> Dict[str, Any]:
    corners = area.corners.tolist()
    return {'px': [values.pixel_of(corner) for corner in corners],
            'cm': [{'x': x, 'y': y} for x, y in corners]}


def simulated_data(values: CellValues) -> Dict[str, Any]:
    """Describe the simulated table as JSON."""
    known = values.camera or {}
    shown = kind_of(known.get('source', 'auto')) == SIMULATED and _SHOWS in known
    shows = known.get(_SHOWS) if shown else None
    return {'shown': shown, 'shows': shows, 'placement': known.get(_PLACEMENT, 1),
            'placements': _PLACEMENTS, 'touched': known.get(_TOUCHED, 0),
            'sentence': _WORDS.get(shows, '')}


def show(values: CellValues, body: Mapping[str, Any]) -> CellChanges:
    """
    Return the parameters that lay something else on the table; the robot moves away.

    :param body: {'shows': see the parameter, 'placement': of the board}.
    :raises InvalidValueError: If it is no simulated table.
    """
    _refuse_real(values)
    wanted = {_TOUCHED: 0}
    if 'shows' in body:
        wanted[_SHOWS] = body['shows']
    if 'placement' in body:
        wanted[_PLACEMENT] = body['placement']
    return CellChanges({'camera': wanted}, [])


def touch(values: CellValues, number: int) -> CellChanges:
    """
    Return the parameters that let the simulated robot touch an object.

    :param number: The object's, see the parameter.
    :raises InvalidValueError: If it is no simulated table.
    """
    _refuse_real(values)
    return CellChanges({'camera': {_TOUCHED: number}}, [])


def _refuse_real(values: CellValues) -> None:
    if not simulated_data(values)['shown']:
        raise InvalidValueError('this camera is not the simulated one')
