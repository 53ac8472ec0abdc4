# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Saving on the page: what changes, what is written, and what the nodes have after a start."""

import os
from pathlib import Path

from camera_to_base.calibration import BASE, file_status, SURFACE
from camera_to_base.dashboard.sessions.cell_file import CellFiles
from camera_to_base.dashboard.sessions.cell_sessions import AllSessions
from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import (
    default_values, read_node_parameters, read_parameter_file, TRANSFORM_SPECS)
from camera_to_base.settings import read_node_settings
import numpy as np
import pytest
from session_cell import Cell


@pytest.fixture(scope='module')
def calibrated():
    """Return both nodes' parameters after a whole set-up."""
    cell = Cell()
    cell.calibrate_board()
    cell.measure_pairs()
    cell.do('robot', 'accept')
    cell.sessions.close()
    return cell


def set_up(calibrated, path):
    cell = Cell(path, **calibrated.values['camera'])
    cell.values['transform'] = calibrated.values['transform']
    cell.tell()
    return cell


@pytest.mark.slow
def test_after_a_start_from_the_file_everything_is_as_it_was(calibrated, tmp_path):
    path = tmp_path / 'cell.yaml'
    cell = set_up(calibrated, path)
    cell.values['camera'].update({
        'detector.faintest': 9.5, 'work_area': [0.0, 0.0, 10.0, 0.0, 10.0, 8.0],
        'ignored_areas': '0 0, 2 0, 2 2', 'background_frames': 7, 'simulated.shows': 'board'})
    cell.values['transform']['reach_cm'] = 55.5
    cell.tell()
    saved = cell.do('save', 'save')
    assert saved['saved']['sentence'] == f'Written to {path}.'
    assert saved['changes'] == [] and saved['error'] is None
    for node, name in (('camera', 'camera_publisher'), ('transform', 'robot_base_publisher')):
        held = read_node_parameters(str(path), f'/{name}')
        started = Cell().values[node] | {key: value for key, value in held.items()
                                         if key in cell.values[node]}
        wanted = {**cell.values[node]}
        if node == 'camera':
            wanted['simulated.shows'] = 'objects'
        assert started == wanted
    assert read_node_settings(str(path)).warnings == []


@pytest.mark.slow
def test_the_file_is_that_of_the_command(tmp_path):
    path = tmp_path / 'cell.yaml'
    cell = Cell(path)
    cell.calibrate_board()
    cell.measure_pairs()
    cell.do('robot', 'accept')
    # A pair that is not accepted yet does not belong to what is saved.
    cell.measure_pair(np.array([5.0, 5.0]))
    cell.take()
    cell.do('save', 'save')
    file = read_parameter_file(str(path))
    assert file.comments[0] == 'Written by `calibrate` of camera_to_base.'
    from datetime import datetime
    status = file_status(str(path), file.values, file.comments, datetime.now().astimezone())
    said = '\n'.join(status['holds'])
    assert 'surface: homography' in said and 'base frame, from objects that the robot' in said
    assert said.count('error at') == 2 and status['lacks'] == [
        "the camera's height, which objects with a height need (calibrate board, with the board "
        'held at a tilt, too)']
    # The next start of the dashboard keeps the reports, though it has not made them.
    again = set_up(cell, path)
    assert again.sessions.file_text() == path.read_text()


def test_what_changes_is_shown_by_name_with_old_and_new(calibrated, tmp_path):
    path = tmp_path / 'cell.yaml'
    path.write_text('/**:\n  ros__parameters: {reach_cm: 80.0, other: {thing: 3}, period: 2.0}\n')
    cell = set_up(calibrated, path)
    cell.values['transform'] = {**cell.values['transform'], 'reach_cm': 60.0}
    cell.tell()
    changes = {change['name']: change for change in cell.state('save')['changes']}
    assert changes['reach_cm'] == {
        'name': 'reach_cm', 'old': '80', 'new': '60', 'nodes': 'transform'}
    assert changes['surface.covariance'] == {
        'name': 'surface.covariance', 'old': None, 'new': '105 numbers', 'nodes': 'camera'}
    # The node does not have the file's value any more, but the default.
    assert changes['period']['new'] is None
    assert 'other.thing' not in changes
    saved = cell.do('save', 'save')
    assert saved['saved']['sentence'].endswith(f'; the old file is {path}.bak.1.')
    assert read_parameter_file(str(path)).values['other.thing'] == 3
    assert read_parameter_file(f'{path}.bak.1').values['reach_cm'] == 80.0


def test_a_node_that_does_not_run_keeps_what_the_file_holds(calibrated, tmp_path):
    path = tmp_path / 'cell.yaml'
    cell = set_up(calibrated, path)
    cell.values['transform'] = {**cell.values['transform'], 'reach_cm': 61.0}
    cell.tell()
    cell.do('save', 'save')
    cell.sessions.see_parameters('transform', None)
    state = cell.state('save')
    assert 'robot_base_publisher does not run' in state['warnings'][0]
    assert [change['name'] for change in state['changes']] == []
    cell.do('save', 'save')
    assert read_parameter_file(str(path)).values['reach_cm'] == 61.0


@pytest.mark.parametrize('name, said', [
    ('none/cell.yaml', 'does not lie in'), ('cell.txt', 'must end in .yaml'),
    ('/tmp/cell.yaml', 'does not lie in'), ('../cell.yaml', 'does not lie in'),
    ('link.yaml', 'does not lie in'),
    ('other.yaml', 'has parameters for single nodes'),
    ('text.yaml', 'is no parameter file for all nodes'), ('folder.yaml', 'cannot read')])
def test_a_file_that_would_be_lost_is_not_overwritten(calibrated, tmp_path, name, said):
    Path(tmp_path, 'other.yaml').write_text(
        '/cell_1/camera_publisher:\n  ros__parameters: {period: 2.0}\n')
    Path(tmp_path, 'text.yaml').write_text('just: text\n')
    Path(tmp_path, 'folder.yaml').mkdir()
    Path(tmp_path, 'link.yaml').symlink_to('/etc/hostname.yaml')
    before = {path: path.is_file() and path.read_bytes() for path in tmp_path.iterdir()}
    cell = set_up(calibrated, tmp_path / 'cell.yaml')
    with pytest.raises(CameraToBaseError) as refused:
        cell.do('save', 'save', path=name)
    assert said in str(refused.value) and cell.state('save')['error'] == str(refused.value)
    assert {path: path.is_file() and path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize('body, said', [
    ({}, 'name the file to write'), ({'path': 7}, 'expected the name of a file')])
def test_a_save_without_a_file_asks_for_one(calibrated, body, said):
    cell = set_up(calibrated, '')
    with pytest.raises(CameraToBaseError, match=said):
        cell.do('save', 'save', **body)


def test_a_full_disk_is_told_and_leaves_the_old_file(calibrated, tmp_path, monkeypatch):
    path = tmp_path / 'cell.yaml'
    cell = set_up(calibrated, path)
    cell.do('save', 'save')
    before = path.read_bytes()
    cell.values['transform'] = {**cell.values['transform'], 'reach_cm': 42.0}
    cell.tell()

    def full(descriptor):
        raise OSError(28, os.strerror(28))
    monkeypatch.setattr(os, 'fsync', full)
    with pytest.raises(CameraToBaseError, match='No space left on device'):
        cell.do('save', 'save')
    assert 'No space left on device' in cell.state('save')['error']
    assert path.read_bytes() == before
    assert [one.name for one in tmp_path.iterdir()] == ['cell.yaml']
    monkeypatch.undo()
    assert cell.do('save', 'save')['error'] is None
    assert read_parameter_file(str(path)).values['reach_cm'] == 42.0


def test_nodes_that_differ_in_a_shared_parameter_are_told_of(calibrated):
    cell = set_up(calibrated, '')
    assert cell.state('save')['warnings'] == []
    cell.values['camera'] = {**cell.values['camera'], 'camera_frame_id': 'table'}
    cell.tell()
    assert 'The two nodes differ in camera_frame_id' in cell.state('save')['warnings'][0]


def test_what_a_robot_node_that_does_not_run_has_in_the_file_is_kept(calibrated, tmp_path):
    path = tmp_path / 'cell.yaml'
    cell = set_up(calibrated, path)
    cell.do('save', 'save')
    before = read_parameter_file(str(path)).values
    assert before['rotation_deg'] and before['displacement_cm'] and before['base_covariance']
    # Its own parameters of the same names are the tutorial's: it only shows the base frame.
    cell.values['camera'] = {**cell.values['camera'], 'detector.faintest': 9.5,
                             'rotation_deg': [180.0, 0.0, 0.0],
                             'displacement_cm': [-17.8, 24.4, 0.0]}
    cell.tell()
    cell.sessions.see_parameters('transform', None)
    cell.do('save', 'save')
    assert read_parameter_file(str(path)).values == {**before, 'detector.faintest': 9.5}


def test_the_base_frame_of_a_former_surface_goes_with_its_covariance_once_that_is_allowed(
        calibrated, tmp_path):
    path = tmp_path / 'cell.yaml'
    cell = set_up(calibrated, path)
    cell.do('save', 'save')
    cell.sessions.see_parameters('transform', None)
    cell.values['camera'] = {**cell.values['camera'], 'surface.parallel.width_cm': 40.0}
    cell.sessions.see_parameters('camera', cell.values['camera'])
    before = path.read_bytes()
    state = cell.do('save', 'save')
    assert 'the base frame' in state['question']['sentence'] and state['saved'] is None
    assert path.read_bytes() == before
    assert cell.do('save', 'save', removes=[])['question']
    assert path.read_bytes() == before
    state = cell.do('save', 'save', removes=state['question']['removes'])
    assert state['question'] is None and state['saved']
    held = read_parameter_file(str(path)).values
    assert not {'rotation_deg', 'displacement_cm', 'base_covariance', 'calibration.base'} & {*held}


def test_a_robot_node_that_was_started_without_the_file_has_no_base_frame(calibrated):
    cell = set_up(calibrated, '')
    assert cell.sessions.setup.parts == [SURFACE, BASE]
    cell.values['transform'] = default_values(TRANSFORM_SPECS)
    cell.tell()
    assert cell.sessions.setup.parts == [SURFACE]


def test_a_base_frame_that_is_the_default_is_written_with_its_covariance(tmp_path):
    path = tmp_path / 'cell.yaml'
    cell = Cell(path)
    cell.values['transform'] = {**cell.values['transform'], 'base_covariance': [0.0] * 21}
    cell.tell()
    cell.do('save', 'save')
    assert read_parameter_file(str(path)).values['displacement_cm'] == [-17.8, 24.4, 0.0]


def test_the_file_of_another_cell_is_not_overwritten(calibrated, tmp_path):
    told = []
    files = CellFiles(str(tmp_path / 'one.yaml'), own='/one')
    sessions = AllSessions(files, lambda *state: told.append(state), lambda *picture: None)
    try:
        for name in ('/one', '/two'):
            for node, values in calibrated.values.items():
                sessions.of(name).see_parameters(node, values)
        one, two = sessions.of('/one'), sessions.of('/two')
        assert one.file_path == str(tmp_path / 'one.yaml')
        assert two.file_path == str(tmp_path / 'two.yaml')
        one.act('save', 'save', {})
        before = Path(tmp_path, 'one.yaml').read_bytes()
        with pytest.raises(CameraToBaseError, match='is the file of the cell /one'):
            two.act('save', 'save', {'path': 'one.yaml'})
        two.act('save', 'save', {})
        assert Path(tmp_path, 'one.yaml').read_bytes() == before
        # Where nobody knows whose file it is, the page asks.
        Path(tmp_path, 'old.yaml').write_bytes(before)
        two.act('save', 'save', {'path': 'old.yaml'})
        assert 'Replace it?' in two.state('save')['question']['sentence']
        two.act('save', 'cancel', {})
        assert two.state('save')['question'] is None
    finally:
        sessions.close()


def test_several_cells_have_the_files_that_they_were_started_with():
    files = CellFiles('', '/one=/a/1.yaml; /two/left=/b/2.yaml')
    assert (files.of('/one'), files.of('/two/left')) == ('/a/1.yaml', '/b/2.yaml')
    assert files.of('/') not in ('/a/1.yaml', '/b/2.yaml')
    assert CellFiles('/a/two.yaml').of('/two') == ''
    assert CellFiles().of('/') == ''
    with pytest.raises(CameraToBaseError, match='/cell_1=FILE'):
        CellFiles('', 'cell_1: a.yaml')


def test_the_last_five_files_are_kept_and_the_nodes_go_back_to_one(calibrated, tmp_path):
    path = tmp_path / 'cell.yaml'
    cell = set_up(calibrated, path)
    for reach in range(51, 59):
        cell.values['transform'] = {**cell.values['transform'], 'reach_cm': float(reach)}
        cell.tell()
        cell.do('save', 'save')
    former = cell.state('save')['former']
    assert [one['name'] for one in former] == [f'cell.yaml.bak.{number}' for number in range(1, 6)]
    state = cell.do('save', 'load', number=3)
    assert cell.values['transform']['reach_cm'] == 55.0
    assert 'cell.yaml.bak.3' in state['saved']['sentence'] and state['can_undo']
    assert read_parameter_file(str(path)).values['reach_cm'] == 58.0
    assert not cell.do('save', 'undo')['can_undo']
    assert cell.values['transform']['reach_cm'] == 58.0
    for number in (6, 0.5, True, 'x', -1, 2 ** 70):
        with pytest.raises(CameraToBaseError, match='no former file'):
            cell.do('save', 'load', number=number)


def test_an_error_does_not_tell_what_a_file_holds(calibrated, tmp_path):
    Path(tmp_path, 'secret.yaml').write_text('password: [hunter2, *other\n')
    cell = set_up(calibrated, tmp_path / 'cell.yaml')
    with pytest.raises(CameraToBaseError) as refused:
        cell.do('save', 'save', path='secret.yaml')
    assert 'hunter2' not in str(refused.value) and 'other' not in str(refused.value)


def test_newer_calibration_in_the_file_is_not_replaced_without_a_question(calibrated, tmp_path):
    path = tmp_path / 'cell.yaml'
    cell = set_up(calibrated, path)
    assert cell.do('save', 'save')['question'] is None
    mine = path.read_text()
    # The command `calibrate` writes the file while the nodes run with the former one.
    record = cell.values['camera']['calibration.surface']
    assert record[:10] in mine
    later = mine.replace(record[:10], '2999-01-01')
    path.write_text(later)
    state = cell.do('save', 'save')
    assert 'later date' in state['question']['sentence'] and path.read_text() == later
    assert state['question']['verb'] == 'Replace'
    cell.do('save', 'save', removes=state['question']['removes'])
    assert '2999-' not in path.read_text()
    assert '2999-' in (tmp_path / 'cell.yaml.bak.1').read_text()
