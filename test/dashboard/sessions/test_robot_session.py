# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The base frame on the page: click an object, touch it, type what the robot shows."""

import time

from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import transform_settings
from camera_to_base.settings import camera_settings
import numpy as np
import pytest
from session_cell import Cell, TRUTH


@pytest.fixture(scope='module')
def calibrated():
    """Return the parameters of a camera node with a surface."""
    cell = Cell()
    cell.calibrate_board()
    cell.sessions.close()
    return cell.values['camera']


@pytest.fixture
def cell(calibrated):
    one = Cell(**calibrated)
    one.do('robot', 'start')
    return one


def test_there_must_be_a_surface_first():
    cell = Cell()
    assert 'There is no surface yet' in cell.state('robot')['needs']
    with pytest.raises(CameraToBaseError, match='There is no surface yet'):
        cell.do('robot', 'start')
    cell.sessions.see_parameters('camera', None)
    assert cell.state('robot')['needs'] == 'camera_publisher does not run: start it.'


@pytest.mark.slow
def test_five_touched_objects_give_the_base_frame(cell):
    state = cell.measure_pairs()
    assert [pair['number'] for pair in state['pairs']] == [1, 2, 3, 4, 5]
    assert state['pairs'][0]['name'] == 'top left' and state['pairs'][2]['name'] == 'bottom right'
    assert all(pair['residual_mm'] < 0.3 < 1 > pair['left_out_mm'] for pair in state['pairs'])
    assert state['fit']['can_accept'] and state['fit']['rms_mm'] < 0.3
    accepted = cell.do('robot', 'accept')['accepted']
    assert 'uses the new base frame' in accepted['sentence']
    for node in ('camera', 'transform'):
        found = transform_settings(cell.values[node])
        for point in ((0.0, 0.0), (10.0, 12.0), (-4.0, 8.0)):
            np.testing.assert_allclose(
                found.convert_point(*point, 0.0), TRUTH.convert_point(*point, 0.0), atol=0.05)
        assert 'rigid from objects that the robot touched' in cell.values[node]['calibration.base']
    assert len(cell.values['transform']['base_covariance']) == 21


def test_the_place_is_the_mean_of_twenty_frames(cell):
    u, v = cell.state('robot')['suggestion']['pixel']
    cell.do('robot', 'see', u=u, v=v)
    x, y = (cell.state('robot')['open']['pixel'])
    assert abs(x - u) < 1 and abs(y - v) < 1
    place = cell.clicked_point()
    for number in range(20):
        assert cell.state('robot')['open']['frames'] == number
        assert cell.state('robot')['open']['camera'] is None
        cell.sessions.see_objects([(place[0] + 0.01 * (-1) ** number, place[1])])
    state = cell.state('robot')
    assert state['open']['camera']['x'] == pytest.approx(place[0], abs=0.002)
    assert state['open']['sentence'].endswith('spread 0.10 mm')
    assert 'Touch its middle' in state['hint'] and state['suggestion'] is None


def test_an_object_that_moves_is_not_measured(cell):
    state = cell.measure_pair(np.array([3.0, 3.0]), noise=0.3)
    assert 'the object has moved' in state['error'] and state['open'] is None
    cell.do('robot', 'see', u=320, v=240)
    for _ in range(20):
        cell.sessions.see_objects([])
    assert 'frames show no object' in cell.state('robot')['error']
    assert cell.state('robot')['pairs'] == []


def test_a_pair_that_does_not_fit_is_named_and_measured_again(cell):
    state = cell.measure_pairs(6, wrong=4)
    bad = [pair for pair in state['pairs'] if not pair['fits']]
    assert [pair['number'] for pair in bad] == [4] and bad[0]['left_out_mm'] > 10
    assert 'does not belong to the others' in bad[0]['sentence']
    assert not state['fit']['can_accept'] and 'row 4 does not belong' in state['fit']['error']
    with pytest.raises(CameraToBaseError, match='row 4 does not belong'):
        cell.do('robot', 'accept')
    place = cell.do('robot', 'again', number=4)['suggestion']
    assert place['name'] == 'bottom left'
    state = cell.measure_pair(np.array([place['camera']['x'], place['camera']['y']]))
    assert [pair['number'] for pair in state['pairs']] == [1, 2, 3, 4, 5, 6]
    assert state['fit']['can_accept'] and all(pair['fits'] for pair in state['pairs'])


@pytest.mark.parametrize('change, named', [
    (lambda cell: cell.values['camera'].update({'surface.camera_height_cm': 80.0}), 'surface'),
    (lambda cell: cell.values['camera'].update({'source': '/dev/video4'}), 'camera'),
    (lambda cell: cell.sessions.see_background(2), 'background')])
def test_pairs_of_another_surface_background_or_camera_are_invalid(cell, change, named):
    cell.sessions.see_background(1)
    cell.measure_pairs(3)
    assert cell.state('robot')['fit']['can_accept']
    before = {**cell.values['camera']}
    change(cell)
    cell.tell()
    state = cell.state('robot')
    assert [pair['valid'] for pair in state['pairs']] == [False] * 3
    assert all(f'another {named}' in pair['invalid_because'] for pair in state['pairs'])
    assert state['fit'] is None
    with pytest.raises(CameraToBaseError, match='measure three pairs or more first'):
        cell.do('robot', 'accept')
    if named != 'background':
        cell.values['camera'] = before
        cell.tell()
        assert cell.state('robot')['fit']['can_accept']


def test_the_tool_of_a_robot_that_publishes_it_is_taken(cell):
    u, v = cell.state('robot')['suggestion']['pixel']
    with pytest.raises(CameraToBaseError, match='click the object in the picture first'):
        cell.do('robot', 'from_topic', topic='/tool')
    assert cell.sessions.tool_topic == '/tool'
    cell.do('robot', 'see', u=u, v=v)
    place = cell.clicked_point()
    for _ in range(20):
        cell.sessions.see_objects([place])
    with pytest.raises(CameraToBaseError, match='0 poses came on /tool'):
        cell.do('robot', 'from_topic')
    for x in (12.0, 12.0, 12.0, 12.0, 12.1):
        cell.sessions.see_tool(x, -3.0, 'base_link')
    with pytest.raises(CameraToBaseError, match='the robot moves by 1.0 mm'):
        cell.do('robot', 'from_topic')
    for _ in range(5):
        cell.sessions.see_tool(12.1, -3.0, 'base_link')
    state = cell.do('robot', 'from_topic')
    assert state['pairs'][0]['base'] == {'x': 12.1, 'y': -3.0}
    assert state['tool']['position'] == {'x': 12.1, 'y': -3.0}


@pytest.mark.parametrize('name, body, said', [
    ('touch', {'text': '1 2'}, 'click the object in the picture first'),
    ('see', {'u': 'left', 'v': 3}, 'u must be numbers'),
    ('see', {}, 'u must be finite numbers'),
    ('from_topic', {}, 'click the object in the picture first'),
    ('from_topic', {'topic': 'a b; rm'}, 'is no name of a topic'),
    ('again', {'number': 7}, 'there is no pair 7'),
    ('remove', {}, 'there is no pair None'),
    ('base_z', {'base_z': 'left'}, "base_z must be up or down, got 'left'"),
    ('accept', {}, 'measure three pairs or more first')])
def test_what_cannot_be_done_is_one_sentence_and_changes_nothing(cell, name, body, said):
    before = cell.state('robot')
    with pytest.raises(CameraToBaseError, match=said):
        cell.do('robot', name, **body)
    assert cell.state('robot') == before


def test_a_typed_text_that_is_no_position_leaves_the_pair_open(cell):
    with pytest.raises(CameraToBaseError, match="got 'ten'"):
        cell.measure_pair(np.array([3.0, 3.0]), text='ten')
    assert cell.state('robot')['open']['camera'] is not None
    assert cell.do('robot', 'touch', text='125 -30 mm')['pairs'][0]['base'] == {
        'x': 12.5, 'y': -3.0}


def test_a_table_that_hangs_has_its_z_down(cell):
    state = cell.measure_pairs()
    assert state['fit']['can_accept']
    assert 'mirrored' in cell.do('robot', 'base_z', base_z='down')['fit']['error']


def test_areas_survive_another_view_of_the_surface(cell):
    polygon = [[100, 100], [500, 110], [480, 400], [90, 380]]
    state = cell.do('areas', 'set', work_area=polygon, ignored_areas=[[[5, 5], [60, 5], [60, 60]]])
    np.testing.assert_allclose(state['work_area']['px'], polygon, atol=0.2)
    assert len(state['ignored_areas']) == 1
    areas = camera_settings(cell.values['camera']).detector.areas
    pixels = camera_settings(cell.values['camera']).surface.pixels(areas.work.corners)
    np.testing.assert_allclose(pixels, polygon, atol=0.2)
    # A corner that is not moved stays exactly where it is, however it was given.
    exact = '0.1234567890123 0.5, 7.1 0.3, 7.1 6.000000000001'
    cell.values['camera']['ignored_areas'] = exact
    cell.tell()
    kept = cell.state('areas')['ignored_areas'][0]['cm']
    cell.do('areas', 'set', ignored_areas=[kept])
    assert cell.values['camera']['ignored_areas'] == exact
    cell.do('areas', 'set', ignored_areas=[[*kept, [60, 300]], kept])
    assert cell.values['camera']['ignored_areas'].startswith(exact + ', ')
    assert cell.values['camera']['ignored_areas'].endswith('; ' + exact)
    assert cell.do('areas', 'set', ignored_areas=[])['ignored_areas'] == []
    assert cell.state('areas')['work_area'] is not None
    assert cell.do('areas', 'set', work_area=None)['work_area'] is None
    for wrong in ([[1, 1], [2, 2]], 'all', [[0, 0], [10, 10], [10, 0], [0, 10]]):
        with pytest.raises(CameraToBaseError):
            cell.do('areas', 'set', work_area=wrong)
    assert cell.state('areas')['work_area'] is None


def test_the_simulated_robot_touches_the_object_that_was_clicked(cell):
    state = cell.do('simulated', 'show', shows='still_objects')
    assert state['shown'] and state['shows'] == 'still_objects' and state['touched'] == 0
    with pytest.raises(CameraToBaseError, match='click an object'):
        cell.do('simulated', 'touch')
    cell.do('robot', 'see', u=320, v=240)
    place = cell.clicked_point()
    cell.sessions.see_objects([(place[0] + 8, place[1]), (place[0] + 0.2, place[1])])
    assert cell.do('simulated', 'touch')['touched'] == 2
    assert cell.do('simulated', 'touch', x=place[0] + 8, y=place[1])['touched'] == 1
    assert cell.do('simulated', 'show', shows='board', placement=3)['touched'] == 0
    cell.values['camera']['source'] = '/dev/video0'
    cell.tell()
    assert not cell.state('simulated')['shown']
    with pytest.raises(CameraToBaseError, match='not the simulated one'):
        cell.do('simulated', 'show', shows='board')


def test_the_display_of_the_simulated_robot_is_shown(cell):
    assert cell.sessions.tool_topic == 'simulated_tool'
    assert cell.state('robot')['tool']['position'] is None
    cell.parts.clear()
    cell.sessions.see_tool(3.004, -1.0, 'base_link')
    assert cell.state('robot')['tool']['position'] == {'x': 3.0, 'y': -1.0}
    assert 'robot' in cell.parts
    cell.do('simulated', 'show', shows='empty')
    assert cell.state('robot')['tool']['position'] is None
    # A pose that was on its way still is of the former touch.
    cell.sessions.see_tool(3.004, -1.0, 'base_link', time.time() - 0.5)
    assert cell.state('robot')['tool']['position'] is None
    cell.sessions.see_tool(5.0, -2.0, 'base_link', time.time() + 0.1)
    assert cell.state('robot')['tool']['position'] == {'x': 5.0, 'y': -2.0}
    cell.values['camera']['source'] = '/dev/video0'
    cell.tell()
    cell.do('robot', 'cancel')
    assert cell.sessions.tool_topic == ''


def test_a_robot_without_a_topic_is_asked_for_it(calibrated):
    cell = Cell(**{**calibrated, 'source': '/dev/video0'})
    with pytest.raises(CameraToBaseError, match="name the topic of the robot's tool"):
        cell.do('robot', 'from_topic')


def test_the_first_word_of_a_background_leaves_pairs_valid(cell):
    cell.measure_pairs(3)
    cell.sessions.see_background('first')
    assert cell.state('robot')['fit']['can_accept']
    cell.sessions.see_background('second')
    assert cell.state('robot')['fit'] is None


def test_an_object_that_was_seen_with_another_surface_makes_no_valid_pair(cell):
    cell.do('robot', 'see', u=320, v=240)
    place = cell.clicked_point()
    for _ in range(20):
        cell.sessions.see_objects([place])
    cell.values['camera']['surface.camera_height_cm'] = 80.0
    cell.tell()
    pair, = cell.do('robot', 'touch', text='1 2')['pairs']
    assert not pair['valid'] and 'another surface' in pair['invalid_because']


def test_a_removed_pair_a_stop_and_a_pair_that_was_measured_again_can_be_undone(cell):
    cell.measure_pairs(4)
    before = cell.state('robot')['pairs']
    assert len(cell.do('robot', 'remove', number=2)['pairs']) == 3
    assert cell.do('robot', 'cancel')['pairs'] == []
    assert cell.state('robot')['undo'] == 'stop'
    assert len(cell.do('robot', 'undo')['pairs']) == 3
    state = cell.do('robot', 'undo')
    assert state['pairs'] == before and state['fit']['can_accept'] and state['undo'] is None
    cell.do('robot', 'again', number=3)
    cell.measure_pair(np.array([5.0, 5.0]))
    assert cell.state('robot')['pairs'] != before
    assert cell.do('robot', 'undo')['pairs'] == before


def test_the_pairs_are_there_after_a_restart_of_the_dashboard_as_valid_as_before(
        cell, tmp_path):
    first = Cell(tmp_path / 'cell.yaml', **cell.values['camera'])
    first.sessions.see_background((7, 5))
    first.measure_pairs(5)
    first.sessions.see_background((7, 5))
    before = first.state('robot')
    assert all(pair['valid'] for pair in before['pairs'])
    first.sessions.close()
    again = Cell(tmp_path / 'cell.yaml', **cell.values['camera'])
    assert again.state('robot')['pairs'] == before['pairs']
    assert again.sessions.wants_objects
    fits = [dict(one['fit']) for one in (again.state('robot'), before)]
    # The first line says when it was fitted.
    assert fits[0].pop('lines')[1:] == fits[1].pop('lines')[1:] and fits[0] == fits[1]
    again.sessions.see_background((7, 5))
    assert again.state('robot')['pairs'] == before['pairs']
    # Another background was taken while the dashboard did not run.
    again.sessions.see_background((9, 1))
    assert not any(pair['valid'] for pair in again.state('robot')['pairs'])
    again.sessions.close()
