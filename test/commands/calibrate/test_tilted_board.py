# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""`calibrate board` with a board that is held at a tilt: the simulated camera, and files."""

import json

from camera_to_base.commands.calibrate.command import main
from camera_to_base.parameters import read_parameter_file
from camera_to_base.simulation import SimulatedChessboard
import cv2
import numpy as np
import pytest


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def pictures(folder):
    """Write four flat and four tilted pictures, and return their names."""
    board = SimulatedChessboard(9, 6, 2.5)
    names = []
    for number in range(8):
        if 0 < number < 4:
            board.lay(*board.free_place(number))
        elif number >= 4:
            board.hold(number - 3)
        names.append(f'{number}.png')
        cv2.imwrite(names[-1], board.read())
    return names[:4], names[4:]


def run(capsys, *arguments):
    code = main([str(argument) for argument in arguments])
    output, error = capsys.readouterr()
    return code, output, error


def status_of(capsys, path='cell.yaml'):
    code, output, _ = run(capsys, 'status', '--json', path)
    assert code == 0
    return json.loads(output)


@pytest.mark.slow
def test_simulated_camera_needs_no_hands_and_tells_its_place(folder, capsys):
    code, output, error = run(capsys, 'board', '--camera', 'simulated', '-o', 'cell.yaml')
    assert code == 0
    for side in ('left', 'right', 'top', 'bottom'):
        assert f'raised at the {side} of the picture' in error
    assert ' cm above the surface (95 %' in output
    camera = status_of(capsys)['camera']
    assert camera['height_cm'] == pytest.approx(60.0, rel=0.01)
    # The board's first corner lies at (8, 7.25), and the camera is above (18, 13.5).
    assert camera['foot_cm'] == pytest.approx([10.0, 6.25], abs=0.2)
    assert camera['focal_px'] == pytest.approx(60 / 36 * 640, rel=0.01)
    assert 0 < camera['height_cm_95'] < 0.5 and 0 < camera['foot_cm_95'] < 0.5
    assert 0 < camera['focal_px_95'] < 10


@pytest.mark.slow
def test_pictures_give_the_same_as_the_camera(pictures, capsys):
    flat, tilted = pictures
    code, output, _ = run(capsys, 'board', *flat, '--tilted', *tilted, '-o', 'cell.yaml', '--json')
    report = json.loads(output)
    assert code == 0 and report['warnings'] == []
    assert report['camera']['height_cm'] == pytest.approx(60.0, rel=0.01)
    assert [picture['is_tilted'] for picture in report['pictures']] == 4 * [False] + 4 * [True]
    assert max(picture['rms_px'] for picture in report['pictures']) < 0.1
    values = read_parameter_file('cell.yaml').values
    assert values['surface.model'] == 'pinhole' and len(values['surface.camera_covariance']) == 10


@pytest.mark.slow
def test_flat_pictures_alone_say_that_heights_are_missing(pictures, capsys):
    flat, _ = pictures
    code, output, _ = run(capsys, 'board', *flat, '-o', 'cell.yaml')
    assert code == 0 and 'homography from' in output
    assert '--tilted-placements 4' in output
    status = status_of(capsys)
    assert status['camera'] is None
    assert any('height' in text for text in status['lacks'])


@pytest.mark.slow
def test_mirrored_tilted_picture_of_a_camera_that_looks_aside_is_named(pictures, capsys):
    flat, tilted = pictures
    rows = cv2.imread(tilted[1])
    # The camera's centre 40 px off the picture's: a mirrored picture has it on the other side.
    for name in (*flat, *tilted):
        cv2.imwrite(name, cv2.imread(name)[:, :600])
    cv2.imwrite(tilted[1], rows[:, 599::-1])
    code, _, error = run(capsys, 'board', *flat, '--tilted', *tilted, '-o', 'cell.yaml')
    assert code == 1 and '5.png' in error and 'mirrored' in error


@pytest.mark.parametrize('arguments, said', [
    (('a.png', '--tilted-placements', 3), '--tilted-placements needs --camera'),
    (('--camera', 'simulated', '--tilted', 'a.png'), '--tilted names pictures'),
    (('--camera', 'simulated', '--tilted-placements', 30), '--tilted-placements must be 0..20'),
])
def test_options_that_contradict_each_other_are_refused(folder, capsys, arguments, said):
    code, _, error = run(capsys, 'board', *arguments, '-o', 'cell.yaml')
    assert code == 1 and said in error


def test_board_that_is_held_is_not_the_board_that_lies_there():
    board = SimulatedChessboard(9, 6, 2.5)
    lying = board.read()
    board.hold(1)
    assert np.abs(board.read().astype(int) - lying).mean() > 5
