# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What is on the table: markers, areas; what lies on the simulated one."""

from collections import deque
import time
from typing import Any, Callable, Deque, Dict, List, Mapping, Optional

from camera_to_base.calibration import learned_markers, MARKERS
from camera_to_base.checks import finite_numbers
from camera_to_base.dashboard.sessions.values import CellChanges, CellValues
from camera_to_base.detection import Area, read_areas
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.markers import Corners, lens_of_values, see_markers
from camera_to_base.sources import kind_of, SIMULATED
from camera_to_base.surface import Surface
import numpy as np

# The sheet has these.
_PRINTED = range(4)
# A look costs 20 ms of CPU.
_GAP_S = 0.4
# Markers at rest are the same in so many looks.
_LOOKS = 4

_MOST_CORNERS = 200

_SHOWS, _PLACEMENT, _TOUCHED = 'simulated.shows', 'simulated.placement', 'simulated.touched'
_PLACEMENTS = 8
# Where the simulated robot publishes its tool's pose, in the cell's namespace.
TOOL_TOPIC = 'simulated_tool'
_WORDS = {'objects': 'Coins move over the simulated table.',
          'still_objects': 'Five coins lie on the simulated table.',
          'board': 'The printed board lies on the simulated table.',
          'empty': 'The simulated table is empty.'}


class MarkerSession:
    """
    Says which markers are seen, and learns their corners.

    :param values: The cell's parameters.
    :param on_change: Called when the state has changed.
    """

    def __init__(self, values: CellValues, on_change: Callable[[], None]) -> None:
        self._values, self._on_change = values, on_change
        self._is_on, self._looked_at = False, 0.0
        self._looks: Deque[Corners] = deque(maxlen=_LOOKS)
        self._error: Optional[str] = None

    @property
    def actions(self) -> Dict[str, Callable[[Mapping[str, Any]], Any]]:
        """What a page can ask for, by name."""
        return {'start': self.start, 'learn': self.learn, 'cancel': self.cancel}

    @property
    def wants_frames(self) -> bool:
        """Whether it looks for markers."""
        return self._is_on

    @property
    def state(self) -> Dict[str, Any]:
        """The state as JSON."""
        return {
            'step': 'looking' if self._is_on else 'off', 'needs': self._values.needs_surface,
            'seen': [{'number': number, 'pixel': np.round(corners.mean(axis=0), 1).tolist()}
                     for number, corners in sorted(self._seen.items())],
            'missing': self._missing, 'can_learn': self._can_learn,
            'known': sorted(self._values.markers), 'error': self._error,
            'hint': self._hint() if self._is_on else ''}

    def start(self, body: Mapping[str, Any]) -> None:
        """
        Look for markers from now on.

        :raises InvalidValueError: If there is no surface.
        """
        if self._values.needs_surface:
            raise InvalidValueError(self._values.needs_surface)
        self._is_on, self._error = True, None
        self._looks.clear()
        self._on_change()

    def cancel(self, body: Mapping[str, Any]) -> None:
        """Look no more."""
        self._is_on = False
        self._on_change()

    def see_frame(self, image: np.ndarray) -> None:
        """Look for the markers in the newest frame, shape (h, w, 3), uint8, BGR."""
        now = time.monotonic()
        if not self._is_on or now - self._looked_at < _GAP_S or self._values.camera is None:
            return
        self._looked_at = now
        try:
            self._looks.append(see_markers(image, lens_of_values(self._values.camera)).corners)
        except CameraToBaseError as error:
            self._is_on, self._error = False, str(error)
        self._on_change()

    def learn(self, body: Mapping[str, Any]) -> CellChanges:
        """
        Return what is to be set for the running node to know the markers.

        :raises CameraToBaseError: If they cannot be learned.
        """
        if not self._can_learn:
            raise InvalidValueError('wait until the markers have been seen for two seconds')
        learned = learned_markers(list(self._looks), self._values.camera, source='the page')
        return self._values.with_part(learned.values, MARKERS)

    def set_learned(self) -> None:
        """Look no more: the node knows the markers."""
        self._is_on = False
        self._on_change()

    @property
    def _seen(self) -> Corners:
        return self._looks[-1] if self._looks else {}

    @property
    def _missing(self) -> List[int]:
        return [number for number in _PRINTED if number not in self._seen]

    @property
    def _can_learn(self) -> bool:
        return self._is_on and len(self._looks) == _LOOKS

    def _hint(self) -> str:
        if not self._looks:
            return 'Waiting for a picture.'
        seen, missing = sorted(self._seen), self._missing
        sentence = f'Seen: {_names(seen)}.' if seen else 'No marker is seen.'
        return sentence + (f' Not seen: {_names(missing)}.' if missing else '')


def _names(numbers: List[int]) -> str:
    return ', '.join(map(str, numbers))


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
