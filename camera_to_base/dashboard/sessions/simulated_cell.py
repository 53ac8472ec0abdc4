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

"""The simulated table, on which a page lays what a person lays on a real one."""

from typing import Any, Dict, Mapping

from camera_to_base.dashboard.sessions.cell_values import CellChanges, CellValues
from camera_to_base.errors import InvalidValueError
from camera_to_base.sources import kind_of, SIMULATED

_SHOWS, _PLACEMENT, _TOUCHED = 'simulated.shows', 'simulated.placement', 'simulated.touched'
_PLACEMENTS = 8
# Where the simulated robot publishes its tool's pose, in the cell's namespace.
TOOL_TOPIC = 'simulated_tool'
_WORDS = {'objects': 'Coins move over the simulated table.',
          'still_objects': 'Five coins lie on the simulated table.',
          'board': 'The printed board lies on the simulated table.',
          'empty': 'The simulated table is empty.'}


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
