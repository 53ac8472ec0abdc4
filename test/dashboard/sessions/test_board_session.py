# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Calibrating the surface on the page: look, take, fit, accept."""

import json
from pathlib import Path
import time
from types import SimpleNamespace

from camera_to_base.calibration import calibrate_placements, make_placement, PrintedBoard
from camera_to_base.errors import CameraToBaseError
import cv2
import numpy as np
import pytest
from session_cell import Cell


@pytest.fixture
def cell():
    one = Cell()
    yield one
    one.sessions.close()


def test_the_page_says_what_the_newest_frame_shows(cell):
    assert not cell.sessions.wants_frames
    cell.do('board', 'start')
    assert cell.sessions.wants_frames
    look = cell.show_frames(lambda state: state['look'])['look']
    assert look['found'] and look['sentence'] == '54 of 54 corners found'
    assert look['sharpness'] == 'sharp' and len(look['corners']) == 54
    assert 0.2 < look['covered'] < 0.4


def test_why_no_board_is_found_is_told_in_the_words_of_the_command(cell):
    cell.do('board', 'start')
    cell.board.lay((60, 240), 0)
    look = cell.show_frames(lambda state: state['look'])['look']
    assert not look['found'] and look['sentence'].startswith(
        'the board is cut off by the left edge of the picture')
    cell.do('board', 'start', corners=[8, 6])
    cell.board.lay((320, 240), 0)
    look = cell.show_frames(lambda state: state['look'] and '8 x 6' in state['look']['sentence'])
    assert 'has 9 x 6 inner corners, not 8 x 6' in look['look']['sentence']


def test_the_picture_shows_the_corners(cell):
    cell.do('board', 'start')
    cell.show_frames(lambda state: state['look'])
    drawn = cv2.imdecode(np.frombuffer(cell.pictures[-1], np.uint8), cv2.IMREAD_COLOR)
    u, v = map(int, cell.state('board')['look']['corners'][0])
    around = drawn[v - 8:v + 9, u - 8:u + 9].astype(int)
    assert (around[:, :, 1] - around[:, :, 2]).max() > 60


@pytest.mark.slow
def test_placements_cover_the_picture_and_the_next_one_is_suggested(cell):
    cell.do('board', 'start')
    state = cell.take()
    assert state['error'] is None and state['placements'][0]['corners'] == 54
    assert 'top left' in state['covered']['missing']
    assert 'Lay the board elsewhere' in state['suggestion']['sentence']
    assert 'twice' in cell.take()['error'] and len(cell.state('board')['placements']) == 1
    cell.board.lay(*cell.board.free_place(1))
    more = cell.take()
    assert more['error'] is None and len(more['placements']) == 2
    assert more['covered']['share'] > state['covered']['share']
    assert len(cell.do('board', 'remove', number=1)['placements']) == 1


@pytest.mark.slow
def test_the_fit_is_that_of_the_command(cell):
    state = cell.calibrate_board(4)
    report = state['report']
    assert state['step'] == 'fitted' and report['held_out_mm'] < 0.2 and report['covered'] > 0.4
    assert all(0 < one['error_mm'] < 0.2 for one in state['placements'])
    assert report['placements'] == 4 and len(report['error_map_mm']) == 6
    board = PrintedBoard()
    placements = []
    for number in range(4):
        cell.board.lay(*cell.board.free_place(number)) if number else cell.board.lay((320, 240), 0)
        placements.append(make_placement(board, cell.board.read(), 'one', number))
    expected = calibrate_placements(board, placements).values
    accepted = cell.values['camera']
    pixels = np.array([[100, 100], [320, 240], [560, 400]])
    from camera_to_base.settings import camera_settings
    found = camera_settings(accepted).surface.locate(pixels)
    wanted = camera_settings({**accepted, **expected}).surface.locate(pixels)
    np.testing.assert_allclose(found, wanted, atol=0.02)
    assert accepted['calibration.device'] == 'simulated'
    assert 'homography from a chessboard' in accepted['calibration.surface']
    assert accepted['calibration.thumbnail']


@pytest.mark.slow
def test_report_has_pictures_and_text(cell):
    report = cell.calibrate_board()['report']
    assert [cv2.imdecode(np.frombuffer(cell.sessions.report(name), np.uint8), 1).ndim
            for name in ('fit.png', 'above.png', 'errors.png')] == [3, 3, 3]
    assert report['pictures'][0]['url'].startswith('/api/report/fit.png')
    assert 'error at 54 points' in cell.sessions.report('board.txt').decode()
    with pytest.raises(CameraToBaseError, match='there is no report'):
        cell.sessions.report('../../etc/passwd')


@pytest.mark.slow
def test_a_new_surface_drops_what_was_made_for_the_former_one(cell):
    cell.calibrate_board()
    cell.values['camera']['work_area'] = [0.0, 0.0, 10.0, 0.0, 10.0, 10.0]
    for node in ('camera', 'transform'):
        cell.values[node]['displacement_cm'] = [1.0, 2.0, 3.0]
    cell.tell()
    assert cell.state('board')['would_drop'] == ['the base frame', 'work_area']
    accepted = cell.do('board', 'accept')['accepted']
    assert accepted['dropped'] == ['the base frame', 'work_area']
    assert 'No longer valid: the base frame, work_area' in accepted['sentence']
    assert cell.values['camera']['work_area'] == []
    assert cell.values['transform']['displacement_cm'] == [-17.8, 24.4, 0.0]


@pytest.mark.slow
def test_background_is_asked_for_until_positions_are_published_with_the_new_surface(cell):
    cell.calibrate_board()
    cell.sessions.see_published(time.time(), [])
    state = cell.do('board', 'accept')
    assert 'take the background' in state['hint'] and not state['accepted']['has_background']
    # The last frame of before is still the newest one.
    cell.sessions.see_published(time.time() - 1.0, [])
    assert 'take the background' in cell.state('board')['hint']
    cell.sessions.see_published(time.time() + 0.1, [])
    state = cell.state('board')
    assert 'its background is taken' in state['hint'] and state['accepted']['has_background']


@pytest.mark.parametrize('name, body, said', [
    ('take', {}, 'start the search for a board first'),
    ('fit', {}, 'take a placement of the board first'),
    ('accept', {}, 'fit the surface first'),
    ('remove', {'number': 1}, 'there is no placement 1'),
    ('remove', {'number': 'x'}, "there is no placement 'x'"),
    ('start', {'corners': [2, 6]}, 'must be 3..40, got 2'),
    ('start', {'corners': 9}, 'corners must be two counts'),
    ('start', {'square_mm': 'wide'}, 'square_mm must be numbers'),
    ('start', {'paper': 'A9'}, 'paper must be one of A4')])
def test_what_cannot_be_done_is_one_sentence_and_changes_nothing(cell, name, body, said):
    before = cell.state('board')
    with pytest.raises(CameraToBaseError, match=said):
        cell.do('board', name, **body)
    assert cell.state('board') == before


def test_a_camera_that_gives_no_frames_ends_the_taking(cell, monkeypatch):
    monkeypatch.setattr(
        'camera_to_base.dashboard.sessions.board_watch._LONGEST_WAIT_S', 0.05)
    cell.do('board', 'start')
    cell.do('board', 'take')
    while cell.state('board')['busy']:
        pass
    assert 'no pictures come from the camera node' in cell.state('board')['error']
    monkeypatch.undo()
    assert cell.take()['error'] is None


def test_a_camera_that_changes_its_size_ends_the_taking(cell):
    cell.do('board', 'start')
    cell.do('board', 'take')
    cell.sessions.see_frame(cell.board.read())
    cell.sessions.see_frame(cell.board.read()[:400])
    state = cell.state('board')
    assert not state['busy'] and 'the picture has changed its size' in state['error']


def test_what_is_busy_does_nothing_else(cell):
    cell.do('board', 'start')
    cell.do('board', 'take')
    for name, body in (('take', {}), ('fit', {}), ('remove', {'number': 1})):
        with pytest.raises(CameraToBaseError):
            cell.do('board', name, **body)
    cell.do('board', 'cancel')
    assert cell.state('board')['busy'] is None and cell.state('board')['step'] == 'off'


def test_another_board_drops_the_placements_and_the_same_one_keeps_them(cell):
    cell.do('board', 'start')
    cell.take()
    assert len(cell.do('board', 'start')['placements']) == 1
    assert cell.do('board', 'start', square_mm=30)['placements'] == []
    assert cell.do('board', 'cancel')['step'] == 'off'


@pytest.mark.slow
def test_every_state_is_json(cell):
    cell.calibrate_board()
    for part in ('board', 'robot', 'save', 'areas', 'simulated'):
        json.dumps(cell.state(part), allow_nan=False)


@pytest.mark.slow
def test_each_sheet_is_a_pdf_of_its_own(cell):
    bodies = [{}, {'charuco': True}, {'paper': 'Letter'}, {'markers': True}]
    sheets = [cell.sessions.sheet(body) for body in bodies]
    assert all(sheet.startswith(b'%PDF') for sheet in sheets)
    assert len({len(sheet) for sheet in sheets}) == len(sheets)


@pytest.mark.slow
def test_a_placement_that_was_removed_and_a_stop_can_be_undone(cell):
    cell.do('board', 'start')
    cell.take()
    cell.board.lay(*cell.board.free_place(1))
    cell.take()
    before = cell.state('board')['placements']
    assert len(before) == 2 and cell.state('board')['undo'] is None
    state = cell.do('board', 'remove', number=1)
    assert len(state['placements']) == 1 and state['undo'] == 'placement 1 removed'
    assert cell.do('board', 'cancel')['placements'] == []
    assert len(cell.do('board', 'undo')['placements']) == 1
    state = cell.do('board', 'undo')
    assert state['placements'] == before and state['step'] == 'looking' and state['undo'] is None
    with pytest.raises(CameraToBaseError, match='nothing to undo'):
        cell.do('board', 'undo')


def until(condition):
    end = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_the_placements_are_there_after_a_restart_of_the_dashboard(tmp_path):
    path = tmp_path / 'cell.yaml'
    cell = Cell(path)
    cell.do('board', 'start', square_mm=24.0)
    assert cell.take()['error'] is None
    before = cell.state('board')
    until(lambda: Path(tmp_path, '.cell.yaml.steps').exists())
    # It is killed: nothing is closed.
    again = Cell(path)
    until(lambda: again.state('board')['placements'])
    after = again.state('board')
    for name in ('placements', 'options', 'step', 'covered'):
        assert after[name] == before[name]
    assert again.fit()['report']['rms_mm'] < 0.5
    again.do('board', 'cancel')
    until(lambda: not Path(tmp_path, '.cell.yaml.steps').exists())
    for one in (cell, again):
        one.sessions.close()


@pytest.mark.parametrize('content', [b'', b'PK', b'x' * 1000])
def test_steps_that_cannot_be_read_are_left_alone(tmp_path, content):
    Path(tmp_path, '.cell.yaml.steps').write_bytes(content)
    cell = Cell(tmp_path / 'cell.yaml')
    assert cell.state('board')['step'] == 'off' and cell.state('robot')['pairs'] == []
    cell.sessions.close()


def hold(cell, number):
    """Hold the board at a tilt, and keep it still until the picture is taken."""
    cell.board.hold(number)
    state = cell.show_frames(lambda state: len(state['tilted']) == number and not state['busy'])
    assert state['error'] is None
    return state


@pytest.mark.slow
def test_lens_of_the_driver_makes_flat_placements_enough(cell):
    focal = 60 / 36 * 640
    info = SimpleNamespace(
        width=640, height=480, distortion_model='plumb_bob', d=[0.0] * 5, p=[0.0] * 12,
        k=[focal, 0.0, 320.0, 0.0, focal, 240.0, 0.0, 0.0, 1.0], binning_x=0, binning_y=0,
        roi=SimpleNamespace(width=0, height=0))
    cell.sessions.see_camera_info(info)
    cell.do('board', 'start')
    for number in range(4):
        if number:
            cell.board.lay(*cell.board.free_place(number))
        assert cell.take()['error'] is None
    # It says one thing: where it says to fit, no further place is suggested.
    assert 'camera_info tells the lens' in cell.state('board')['hint']
    assert cell.state('board')['suggestion'] is None
    assert cell.fit()['error'] is None
    cell.do('board', 'accept')
    assert cell.values['camera']['surface.model'] == 'pinhole'
    height_cm = cell.values['camera']['surface.pinhole.camera_position_cm'][2]
    assert abs(height_cm) == pytest.approx(60.0, rel=0.005)


@pytest.mark.slow
def test_a_board_that_is_held_at_a_tilt_is_taken_by_itself_and_gives_the_cameras_height(
        cell, tmp_path):
    with pytest.raises(CameraToBaseError, match='take a placement on the table first'):
        cell.do('board', 'tilt', on=True)
    cell.do('board', 'start')
    for number in range(3):
        if number:
            cell.board.lay(*cell.board.free_place(number))
        assert cell.take()['error'] is None
    assert cell.state('board')['tilt_side'] is None
    state = cell.do('board', 'tilt', on=True)
    assert '0 of 4 tilted pictures' in state['hint'] and 'Hold the board' in state['hint']
    sides = [state['tilt_side']]
    for number in range(1, 5):
        state = hold(cell, number)
        sides.append(state['tilt_side'])
        assert 6 <= state['tilted'][-1]['degrees'] <= 60
    assert not state['tilting'] and len(state['placements']) == 3 and sides[-1] is None
    state = cell.fit()
    assert state['error'] is None
    cell.do('board', 'accept')
    assert cell.values['camera']['surface.model'] == 'pinhole'


@pytest.mark.slow
def test_a_board_that_lies_flat_is_no_tilted_picture_and_one_can_be_removed(cell):
    cell.do('board', 'start')
    cell.take()
    cell.do('board', 'tilt', on=True)
    cell.board.lay(*cell.board.free_place(1))
    state = cell.show_frames(lambda state: state['error'])
    assert 'tilt it by about 30 degrees' in state['error'] and state['tilted'] == []
    hold(cell, 1)
    state = cell.do('board', 'remove', number=1, tilted=True)
    assert state['tilted'] == [] and len(state['placements']) == 1
    state = cell.do('board', 'undo')
    assert len(state['tilted']) == 1
    with pytest.raises(CameraToBaseError, match='no tilted picture'):
        cell.do('board', 'remove', number=2, tilted=True)


@pytest.mark.slow
def test_tilted_pictures_are_there_after_a_restart_of_the_dashboard(tmp_path):
    cell = Cell(tmp_path / 'cell.yaml')
    cell.do('board', 'start')
    cell.take()
    cell.do('board', 'tilt', on=True)
    before = hold(cell, 1)
    cell.sessions.close()
    again = Cell(tmp_path / 'cell.yaml')
    until(lambda: again.state('board')['tilted'])
    after = again.state('board')
    assert (after['tilted'], after['placements']) == (before['tilted'], before['placements'])
    again.sessions.close()
