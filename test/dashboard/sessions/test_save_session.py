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

from camera_to_base.calibration import file_status
from camera_to_base.errors import CameraToBaseError
from camera_to_base.parameters import read_node_parameters, read_parameter_file
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
        "the camera's height, which objects that are not flat need (calibrate board with "
        '--intrinsics)']
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
    assert saved['saved']['sentence'].endswith(f'; the old file is {path}.bak.')
    assert read_parameter_file(str(path)).values['other.thing'] == 3
    assert read_parameter_file(f'{path}.bak').values['reach_cm'] == 80.0


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
    ('none/cell.yaml', 'there is no folder'), ('cell.txt', 'must end in .yaml'),
    ('other.yaml', 'has parameters for single nodes (/cell_1/camera_publisher)'),
    ('text.yaml', 'is no parameter file for all nodes'), ('folder.yaml', 'cannot read')])
def test_a_file_that_would_be_lost_is_not_overwritten(calibrated, tmp_path, name, said):
    Path(tmp_path, 'other.yaml').write_text(
        '/cell_1/camera_publisher:\n  ros__parameters: {period: 2.0}\n')
    Path(tmp_path, 'text.yaml').write_text('just: text\n')
    Path(tmp_path, 'folder.yaml').mkdir()
    before = {path: path.is_file() and path.read_bytes() for path in tmp_path.iterdir()}
    cell = set_up(calibrated, '')
    with pytest.raises(CameraToBaseError) as refused:
        cell.do('save', 'save', path=str(tmp_path / name))
    assert said in str(refused.value) and cell.state('save')['error'] == str(refused.value)
    assert {path: path.is_file() and path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize('body, said', [
    ({}, 'name the file to write'), ({'path': 7}, 'expected the path of a file')])
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
