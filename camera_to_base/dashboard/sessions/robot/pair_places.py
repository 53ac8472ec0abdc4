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

"""What a pair needs of a cell: a surface, and a place that is worth measuring."""

from itertools import islice
from typing import Any, Dict, Optional

from camera_to_base.calibration import parts_of, suggested_places, Suggestion, SURFACE
from camera_to_base.dashboard.sessions.cell_values import CellValues
from camera_to_base.dashboard.sessions.robot.data import point_data
from camera_to_base.dashboard.sessions.robot.pair_list import MeasuredWith

_OF_POSITIONS = ('surface.', 'object_height_cm', 'uncertainty.', 'detector.method')


def needs(values: CellValues) -> Optional[str]:
    """Say why pairs cannot be measured; None if they can."""
    if values.camera is None:
        return 'camera_publisher does not run: start it.'
    if SURFACE not in parts_of(values.given):
        return 'There is no surface yet: calibrate it with the board first.'
    return None


def surface_values(values: CellValues) -> Dict[str, Any]:
    """Return the parameters that the error of a position depends on, without the base frame."""
    return {name: value for name, value in values.given.items() if name.startswith(_OF_POSITIONS)}


def measured_with(values: CellValues, background: Any) -> MeasuredWith:
    """Return what a point in the camera frame depends on now."""
    surface = {name: value for name, value in values.given.items()
               if name.startswith('surface.') or name == 'object_height_cm'}
    return MeasuredWith(surface, values.given.get('source', ''), background)


def suggested(values: CellValues, number: int) -> Suggestion:
    """Suggest where to put the object of a pair, counted from 1."""
    camera = values.settings
    places = suggested_places(camera.surface, camera.hull, camera.image_size)
    return next(islice(places, number - 1, None))


def suggestion_data(place: Suggestion) -> Dict[str, Any]:
    """Describe a suggestion as JSON."""
    return {'name': place.name, 'pixel': list(place.pixel), 'camera': point_data(place.point),
            'sentence': f'Put one object near the {place.name} of the calibrated area, take your '
                        'hand and the robot out of the picture, and click the object.'}
