# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The grids of both frames on the picture, and the everyday names of parameters."""

from pathlib import Path
import re

import camera_to_base.dashboard as dashboard
from camera_to_base.dashboard.live.geometry import Geometry
from camera_to_base.parameters import default_values, TRANSFORM_SPECS
from camera_to_base.settings import CAMERA_SPECS
import numpy as np
import pytest

CAMERA = {**default_values(CAMERA_SPECS), 'surface.model': 'parallel'}
TRANSFORM = default_values(TRANSFORM_SPECS)
NAMES = Path(dashboard.__file__).parent / 'web' / 'base' / 'names.js'


def test_lines_of_the_base_frame_lie_where_the_nodes_put_their_positions():
    grid = Geometry(CAMERA, TRANSFORM).grid_data['base']
    assert grid['step_cm'] == 5
    # The tutorial's check values: x is 0.05625 u - 17.8, y is 24.4 - 0.05625 v.
    for line in grid['lines']:
        axis, value = line['name'].split()
        u, v = np.array(line['points']).T
        found = 0.05625 * u - 17.8 if axis == 'x' else 24.4 - 0.05625 * v
        np.testing.assert_allclose(found, float(value), atol=0.006)
    names = {line['name'] for line in grid['lines']}
    assert {'x -15', 'x 0', 'x 15', 'y 0', 'y 20'} <= names and len(names) < 20
    assert grid['axes']['origin'] == pytest.approx([17.8 / 0.05625, 24.4 / 0.05625], abs=0.1)
    assert grid['axes']['y'][1] < grid['axes']['origin'][1]


def test_grid_of_a_tilted_camera_bends_with_the_surface_and_stays_in_the_picture():
    grid = Geometry({**CAMERA, 'surface.model': 'polynomial'}, {}).grid_data
    assert grid['base'] is None
    lines = grid['camera'] and grid['camera']['lines']
    for line in lines or ():
        u, v = np.array(line['points']).T
        assert (-200 < u).all() and (u < 840).all() and (-150 < v).all() and (v < 630).all()
    assert lines


def test_every_everyday_name_is_that_of_a_parameter():
    named = dict(re.findall(r"^  '([\w.]+)': '([^']+)',$", NAMES.read_text(), re.MULTILINE))
    known = {spec.name for spec in (*CAMERA_SPECS, *TRANSFORM_SPECS)}
    assert len(named) > 35 and set(named) <= known
    assert len(set(named.values())) == len(named)
