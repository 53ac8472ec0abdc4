# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Markers from the first sheet to the base frame, by the commands that a user types."""

import io
from pathlib import Path

from camera_to_base.calibration import MARKERS, parts_of
from camera_to_base.commands.calibrate.command import main
from camera_to_base.coordinate_transform import (
    CameraToRobotBaseConversion, TUTORIAL_DISPLACEMENT_CM, TUTORIAL_ROTATION_DEG)
from camera_to_base.parameters import read_parameter_file
from camera_to_base.settings import read_node_settings
from camera_to_base.shell_commands import full_command
from camera_to_base.simulation import SimulatedBoard
import cv2
import numpy as np
import pytest
from rendered_markers import Camera, Table

TRUE = CameraToRobotBaseConversion.from_roll_pitch_yaw(
    TUTORIAL_ROTATION_DEG, TUTORIAL_DISPLACEMENT_CM)


def answers(*changes):
    """Return what a person types who touches the markers 0 to 3 of the simulated table."""
    corners = SimulatedBoard(image_size=(640, 480)).true_markers
    typed = ['{:.2f} {:.2f}'.format(*TRUE.convert_point(*corners[number].mean(axis=0))[:2])
             for number in range(4)]
    return io.StringIO('\n'.join([*typed, *changes]) + '\n')


@pytest.fixture
def cell(simulated_markers):
    """Return a file with the simulated surface and its markers."""
    Path('cell.yaml').write_text(simulated_markers)
    return 'cell.yaml'


def test_markers_are_learned_where_they_lie(cell):
    file = read_parameter_file(cell)
    assert MARKERS in parts_of(file.values)
    assert file.values['markers.numbers'] == [0, 1, 2, 3]
    corners = np.reshape(file.values['markers.corners_cm'], (4, 4, 2))
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    assert np.abs(sides - 4.0).max() < 0.05
    assert 'marker 0: middle at' in '\n'.join(file.comments)
    assert 'pinhole from a chessboard' in '\n'.join(file.comments)


def test_touched_markers_give_the_base_frame(cell, run_main, monkeypatch):
    monkeypatch.setattr('sys.stdin', answers())
    code, _, error = run_main(main, 'base', '--markers', cell)
    assert code == 0, error
    corners = SimulatedBoard(image_size=(640, 480)).true_markers
    settings = read_node_settings(cell)
    middles = np.reshape(read_parameter_file(cell).values['markers.corners_cm'], (4, 4, 2)).mean(
        axis=1)
    base_from_camera = CameraToRobotBaseConversion.from_roll_pitch_yaw(
        *(read_parameter_file(cell).values[name] for name in ('rotation_deg', 'displacement_cm')))
    for number, middle in enumerate(middles):
        true = TRUE.convert_point(*corners[number].mean(axis=0))
        assert base_from_camera.convert_point(*middle) == pytest.approx(true, abs=0.05)
    assert settings.camera.markers is not None


def test_wrong_touch_can_be_repeated(cell, run_main, monkeypatch):
    right = answers().getvalue().split()
    typed = f'{right[0]} {right[1]}\n{float(right[2]) + 6} {right[3]}\n' + ''.join(
        f'{right[index]} {right[index + 1]}\n' for index in (4, 6)) + f'1\n{right[2]} {right[3]}\n'
    monkeypatch.setattr('sys.stdin', io.StringIO(typed))
    code, _, error = run_main(main, 'base', '--markers', cell)
    assert code == 0, error
    assert 'The touches do not fit' in error


def test_robot_that_touches_markers_is_practised_with_its_display(cell, run_main, monkeypatch):
    monkeypatch.setattr('sys.stdin', answers())
    code, _, error = run_main(main, 'base', '--markers', cell)
    assert code == 0 and error.count('Its display shows: x ') == 4
    shown = error.partition('Its display shows: x ')[2].splitlines()[0]
    x, y = map(float, shown.removesuffix(' cm').split(', y '))
    corners = SimulatedBoard(image_size=(640, 480)).true_markers
    assert (x, y) == pytest.approx(TRUE.convert_point(*corners[0].mean(axis=0))[:2], abs=0.15)


def test_status_names_the_markers(cell, run_main):
    _, output, _ = run_main(main, 'status', cell)
    assert 'markers: 0, 1, 2, 3' in output
    assert f'next: {full_command("calibrate", "base", "--markers", cell)}' in output


@pytest.mark.slow
def test_new_surface_drops_the_markers(cell, run_main):
    code, output, _ = run_main(main, 'board', '--camera', 'simulated', '-o', cell, '--force')
    assert code == 0
    assert 'left out of the file: the markers' in output
    assert MARKERS not in parts_of(read_parameter_file(cell).values)


@pytest.mark.slow
def test_markers_beside_the_board_are_learned_with_it(run_main):
    camera = Camera(lens=(0.0, 0.0))
    picture = camera.frame(board_on(Table()), np.random.default_rng(0))
    cv2.imwrite('board.png', picture)
    code, output, error = run_main(
        main, 'board', 'board.png', '--corners', '7x4', '--square-mm', 25, '-o', 'cell.yaml')
    assert code == 0, error
    assert 'marker 3: middle at' in output
    assert read_parameter_file('cell.yaml').values['markers.numbers'] == [0, 1, 2, 3]


def board_on(table):
    """Lay a board of 8 x 5 squares of 25 mm in the middle of a table."""
    top, left = (int(40 * length) for length in (15 + 8.5, 15 + 10))
    table.picture[top - 60:top + 560, left - 60:left + 860] = 0.75
    for row in range(5):
        for column in range(row % 2, 8, 2):
            table.picture[top + 100 * row:top + 100 * row + 100,
                          left + 100 * column:left + 100 * column + 100] = 0.04
    return table


@pytest.mark.parametrize('arguments, told', [
    (('markers', '--camera', 'simulated', '-o', 'new.yaml'), 'holds no surface'),
    (('markers', '--camera', 'simulated', '-o', 'cell.yaml'), 'exists already with the markers'),
    (('markers', 'grey.png', '-o', 'cell.yaml', '--force'), '0 of the markers 0 to 9 are seen'),
    (('markers', 'small.png', '-o', 'cell.yaml', '--force'), 'the picture is 320 x 240 px'),
    (('markers', 'none.png', '-o', 'cell.yaml', '--force'), 'none.png'),
    (('base', 'pairs.csv', '--markers', 'cell.yaml'), 'not a table'),
    (('sheet', '--markers', '--marker-mm', '90', '-o', 'm.pdf'), 'markers of 68 mm do'),
    (('sheet', '--markers', '--marker-mm', 'nan', '-o', 'm.pdf'), 'marker_mm')])
def test_wrong_input_is_one_sentence(cell, run_main, arguments, told):
    for name, shape in (('grey.png', (480, 640, 3)), ('small.png', (240, 320, 3))):
        cv2.imwrite(name, np.full(shape, 120, np.uint8))
    before = read_parameter_file(cell).values
    code, _, error = run_main(main, *arguments)
    assert code == 1
    assert told in error and error.count('\n') == 1
    assert read_parameter_file(cell).values == before


@pytest.mark.slow
def test_base_needs_markers(run_main):
    run_main(main, 'board', '--camera', 'simulated', '-o', 'plain.yaml')
    code, _, error = run_main(main, 'base', '--markers', 'plain.yaml')
    assert code == 1 and 'holds no markers: first add it with ' in error


@pytest.mark.parametrize('paper', ['A4', 'Letter'])
def test_printed_markers_are_found_on_the_sheet(run_main, paper):
    from camera_to_base.markers import find_markers
    code, _, error = run_main(main, 'sheet', '--markers', '--paper', paper, '-o', 'm.png')
    assert code == 0, error
    grey = cv2.resize(cv2.imread('m.png', cv2.IMREAD_GRAYSCALE), None, fx=0.4, fy=0.4,
                      interpolation=cv2.INTER_AREA)
    found = find_markers(grey)
    assert sorted(found) == [0, 1, 2, 3]
    for corners in found.values():
        sides_mm = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1) * 25.4 / 120
        assert np.abs(sides_mm - 40).max() < 0.5


@pytest.mark.slow
def test_without_aruco_one_sentence_says_what_to_install(cell, run_main, monkeypatch):
    monkeypatch.delattr(cv2, 'aruco')
    for command in (('markers', '--camera', 'simulated', '-o', cell, '--force'),
                    ('sheet', '--markers', '-o', 'm.pdf')):
        code, _, error = run_main(main, *command)
        assert code == 1
        assert 'built without markers: install' in error and error.count('\n') == 1
    code, _, error = run_main(main, 'board', '--camera', 'simulated', '-o', 'other.yaml')
    assert code == 0, error
