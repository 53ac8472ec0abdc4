# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Markers are learned where the surface was measured, or with a warning."""

from camera_to_base.calibration.marker_learning import learned_markers
from camera_to_base.parameters import checked_values
from camera_to_base.surface import SURFACE_SPECS
import numpy as np
import pytest

PLACES = {0: (60, 60), 1: (560, 70), 2: (570, 400), 3: (70, 410)}
FRAME = {number: np.array([[0, 0], [40, 0], [40, 40], [0, 40]], float) + place
         for number, place in PLACES.items()}


@pytest.mark.parametrize('hull, told', [
    ([10, 10, 630, 10, 630, 470, 10, 470], None), ([], None),
    ([10, 10, 400, 10, 400, 470, 10, 470], 'marker(s) 1, 2 lie outside the area'),
])
def test_markers_beyond_the_board_are_a_warning(hull, told):
    values = checked_values(SURFACE_SPECS, {'surface.hull': [float(one) for one in hull]})
    warnings = learned_markers([FRAME] * 3, values, source='a test').report['warnings']
    assert len(warnings) == bool(told) and all(told in warning for warning in warnings)
