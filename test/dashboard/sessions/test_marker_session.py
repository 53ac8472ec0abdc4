# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Markers on the page: which are seen, learned by one click, touched in place of objects."""

import time

from camera_to_base.calibration import MARKERS, parts_of
from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import transform_settings
from camera_to_base.settings import camera_settings, CAMERA_SPECS
from camera_to_base.simulation import SimulatedBoard
import numpy as np
import pytest
from session_cell import Cell, TRUTH


@pytest.fixture(scope='module')
def calibrated():
    """Return the parameters of a camera node whose surface is that of the simulated camera."""
    cell = Cell()
    cell.sessions.close()
    surface = camera_settings(cell.values['camera']).surface
    matrix = np.diag([*surface.locate([[1.0, 1.0]])[0], 1.0])
    return {'surface.model': 'homography',
            'surface.homography.surface_from_pixel': matrix.ravel().tolist()}


@pytest.fixture
def table():
    values = {spec.name: spec.default for spec in CAMERA_SPECS}
    scene = camera_settings({**values, 'simulated.markers': True, 'simulated.shows': 'empty'})
    return scene.simulated.board((640, 480))


@pytest.fixture
def cell(calibrated):
    return Cell(**calibrated)


def show(cell, picture, looks=5):
    for _ in range(looks):
        cell.sessions.see_frame(picture)
        time.sleep(0.41)
    return cell.state('markers')


def test_there_must_be_a_surface_first():
    cell = Cell()
    assert 'There is no surface yet' in cell.state('markers')['needs']
    with pytest.raises(CameraToBaseError, match='There is no surface yet'):
        cell.do('markers', 'start')


def test_markers_that_are_seen_and_not_seen_are_named(cell, table):
    picture = table.read()
    picture[:160, 400:] = 120
    cell.do('markers', 'start')
    assert cell.sessions.wants_frames
    state = show(cell, picture, 1)
    assert [each['number'] for each in state['seen']] == [0, 2, 3]
    assert state['missing'] == [1]
    assert state['hint'] == 'Seen: 0, 2, 3. Not seen: 1.'
    assert not cell.do('markers', 'cancel')['seen'] or not cell.sessions.wants_frames


@pytest.mark.slow
def test_one_click_learns_them_and_the_robot_touches_them(cell, table):
    cell.do('markers', 'start')
    with pytest.raises(CameraToBaseError, match='wait until the markers'):
        cell.do('markers', 'learn')
    show(cell, table.read())
    state = cell.do('markers', 'learn')
    assert state['step'] == 'off' and state['known'] == [0, 1, 2, 3]
    assert MARKERS in parts_of(cell.values['camera'])
    assert cell.state('robot')['markers'] == [0, 1, 2, 3]
    for number, corners in SimulatedBoard(image_size=(640, 480)).true_markers.items():
        cell.do('robot', 'marker', number=number)
        assert f'marker {number} lies at' in cell.state('robot')['open']['sentence']
        x, y, _ = TRUTH.convert_point(*corners.mean(axis=0))
        cell.do('robot', 'touch', text=f'{x:.3f} {y:.3f}')
    state = cell.state('robot')
    assert [pair['name'] for pair in state['pairs']] == [f'marker {n}' for n in range(4)]
    cell.do('robot', 'accept')
    found = transform_settings(cell.values['transform'])
    for point in ((0.0, 0.0), (10.0, 12.0)):
        np.testing.assert_allclose(found.convert_point(*point, 0.0),
                                   TRUTH.convert_point(*point, 0.0), atol=0.05)


def test_marker_that_is_not_known_is_refused(cell):
    with pytest.raises(CameraToBaseError, match='there is no marker 2: learn the markers first'):
        cell.do('robot', 'marker', number=2)
    with pytest.raises(CameraToBaseError, match='there is no marker'):
        cell.do('robot', 'marker')


@pytest.mark.slow
def test_table_without_markers_teaches_nothing(cell):
    cell.do('markers', 'start')
    assert 'No marker is seen' in show(cell, np.full((480, 640, 3), 120, np.uint8))['hint']
    with pytest.raises(CameraToBaseError, match='0 of the markers'):
        cell.do('markers', 'learn')
