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

"""What a pair depends on, and where its object is worth measuring."""

from itertools import islice
from typing import Any, Dict

from camera_to_base.calibration import Place, suggested_places, Suggestion
from camera_to_base.dashboard.sessions.cell_values import CellValues
from camera_to_base.dashboard.sessions.robot.data import point_data
from camera_to_base.dashboard.sessions.robot.pair_list import MeasuredWith
from camera_to_base.errors import InvalidValueError

_OF_POSITIONS = ('surface.', 'object_height_cm', 'uncertainty.', 'detector.method')


def surface_values(values: CellValues) -> Dict[str, Any]:
    """Return the parameters that the error of a position depends on, without the base frame."""
    return {name: value for name, value in values.given.items() if name.startswith(_OF_POSITIONS)}


def marker_place(values: CellValues, number: Any) -> Place:
    """
    Return where the middle of a marker lies.

    :raises InvalidValueError: If the camera node does not know it.
    """
    if number not in list(values.markers):
        raise InvalidValueError(f'there is no marker {number!r:.40}: learn the markers first')
    x, y = values.markers[number].mean(axis=0).tolist()
    return Place(x, y, 0.0, 1)


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
