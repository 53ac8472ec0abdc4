# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""`calibrate` as one way: a file that grows, a board in several places, objects one by one."""

import io
import json
from pathlib import Path
import re

from camera_to_base.commands.calibrate.command import main
from camera_to_base.parameters.file import read_parameter_file
from camera_to_base.settings import read_node_settings
from camera_to_base.simulation.view import BoardView
import numpy as np
import pytest


class Person(io.TextIOBase):
    """
    Somebody at the terminal, who types what the simulated robot's display shows.

    :param answers: Further answers by the number of the question, from 0; the number of a question
        about a position counts all questions.
    """

    def __init__(self, capsys, answers):
        self._capsys, self._answers, self.said, self.count = capsys, answers, '', 0

    def readline(self):
        said = self._capsys.readouterr().err
        self.said += said
        number, self.count = self.count, self.count + 1
        assert self.count < 50, said
        if number in self._answers:
            return self._answers[number]
        shown = re.findall(r'shows: x (-?[\d.]+), y (-?[\d.]+) cm', self.said)
        return '{} {}\n'.format(*shown[-1]) if 'Touch' in said else '\n'


@pytest.fixture
def run(capsys, monkeypatch):
    """Run the command with somebody who answers; give code, output, and all that was asked."""
    def run_command(*arguments, answers={}):
        person = Person(capsys, answers)
        monkeypatch.setattr('sys.stdin', person)
        code = main([str(argument) for argument in arguments])
        output, error = capsys.readouterr()
        return code, output, person.said + error
    return run_command


def surface(run, *more, tilt=0):
    code, output, error = run('board', '--camera', 'simulated', '--simulated-tilt-deg', tilt,
                              '-o', 'cell.yaml', *more)
    assert code == 0, error
    return output


def live(run, *more, **answers):
    return run('base', '--live', 'cell.yaml', '--camera', 'simulated', *more, **answers)


def tip_errors_mm(tilt=0):
    """Return the errors in the base frame over the middle of the table."""
    settings = read_node_settings('cell.yaml')
    view = BoardView((640, 480), 36.0, tilt)
    u, v = np.meshgrid(np.linspace(100, 540, 8), np.linspace(80, 400, 6))
    pixels = np.stack([u.ravel(), v.ravel(), np.ones(u.size)])
    shown = view.surface_from_pixel @ pixels
    true_points = (shown[:2] / shown[2]).T * [1, -1] + [-17.8, 24.4]
    found = settings.camera.surface.locate(pixels[:2].T)
    base = np.array([settings.transform.base_point(*point) for point in found])[:, :2]
    return 10 * np.linalg.norm(base - true_points, axis=1)


@pytest.mark.slow
@pytest.mark.parametrize('tilt', [0, 30])
def test_three_commands_make_a_cell_whose_tip_is_right(run, tilt):
    assert run('sheet', '-o', 'board.pdf')[0] == 0
    surface(run, '--placements', 4, tilt=tilt)
    code, output, asked = live(run)
    assert code == 0, asked
    assert 'error at 5 points' in output and asked.count('Touch its middle') == 5
    assert tip_errors_mm(tilt).max() < 0.8
    held = read_parameter_file('cell.yaml').values
    assert held['source'] == held['calibration.device'] == 'simulated'
    assert {'surface.model', 'rotation_deg', 'displacement_cm'} <= set(held)


@pytest.mark.slow
def test_a_wrong_number_is_asked_for_again_and_a_wrong_pair_measured_again(run, simulated_surface):
    Path('cell.yaml').write_text(simulated_surface)
    code, output, asked = live(run, answers={1: 'ten\n', 3: '55 66\n', 6: '3\n'})
    assert code == 0, asked
    assert "as in 12.5 -3.4, got 'ten'" in asked
    assert 'row 3 does not belong to the others' in asked and 'Place 3 again' in asked
    assert asked.count('Place ') == 6
    assert tip_errors_mm().max() < 0.8


@pytest.mark.slow
def test_giving_up_writes_nothing(run, simulated_surface):
    Path('cell.yaml').write_text(simulated_surface)
    before = Path('cell.yaml').read_bytes()
    for answers, said in (({2: '55 66\n', 5: 'q\n'}, 'row 3 does not belong'),
                          ({2: ''}, 'the input has ended before all questions were answered')):
        code, output, asked = live(run, answers=answers)
        assert (code, output) == (1, '') and said in asked
        assert Path('cell.yaml').read_bytes() == before
        assert not Path('cell.yaml.bak').exists()
        assert 'The pairs so far are kept in cell_touched_pairs.csv' in asked
        Path('cell_touched_pairs.csv').unlink()


@pytest.mark.slow
def test_position_of_another_place_is_refused_at_once(run):
    surface(run, '--placements', 1)
    code, output, asked = live(run, answers={0: '-6.70 15.20\n', 1: '-6.70, 15.20\n'})
    assert code == 0, asked
    assert 'another place has this position, (-6.70, 15.20) cm, but the camera sees' in asked
    assert asked.count('Place ') == 5 and asked.count('Touch its middle') == 6
    assert tip_errors_mm().max() < 2.0


@pytest.mark.slow
def test_interrupted_calibration_goes_on_with_its_pairs(run):
    surface(run)
    code, _, asked = live(run, answers={2: ''})
    assert code == 1 and len(Path('cell_touched_pairs.csv').read_text().splitlines()) == 3
    code, _, asked = live(run)
    assert code == 0, asked
    assert '2 of 5 pairs are kept in cell_touched_pairs.csv' in asked
    assert [f'Place {number} of 5' in asked for number in (1, 2, 3, 4, 5)] == [
        False, False, True, True, True]
    assert tip_errors_mm().max() < 0.8 and not Path('cell_touched_pairs.csv').exists()


@pytest.mark.slow
def test_pairs_of_another_surface_are_not_used(run):
    surface(run)
    live(run, answers={2: ''})
    kept = Path('cell_touched_pairs.csv')
    kept.write_text(kept.read_text().replace(' rms ', ' RMS '))
    code, _, asked = live(run, answers={1: ''})
    assert 'were measured with another surface: they are not used' in asked


@pytest.mark.slow
def test_file_that_holds_no_kept_pairs_is_not_overwritten(run):
    surface(run)
    Path('cell_touched_pairs.csv').write_text('mine\n')
    code, output, error = live(run)
    assert (code, output) == (1, '') and "'cell_touched_pairs.csv' is there, which is no" in error
    assert Path('cell_touched_pairs.csv').read_text() == 'mine\n'


@pytest.mark.slow
def test_another_camera_is_told_and_strict_writes_nothing(run, simulated_surface):
    text = simulated_surface.replace('device: simulated', 'device: /dev/video7')
    Path('cell.yaml').write_text(text.replace('{device:', '{strict: true, device:'))
    code, output, asked = live(run, answers={0: 'q\n'})
    assert (code, output) == (1, '')
    assert "was made with '/dev/video7', but the frames come from 'simulated'" in asked
    Path('cell.yaml').write_text(text)
    code, output, asked = live(run)
    assert code == 0 and "was made with '/dev/video7'" in asked


@pytest.mark.slow
def test_base_frame_is_replaced_when_told_to_only(run, simulated_surface):
    Path('cell.yaml').write_text(simulated_surface)
    assert live(run)[0] == 0
    code, _, error = live(run)
    assert code == 1 and "'cell.yaml' exists already with the base frame" in error
    assert live(run, '--force')[0] == 0
    comments = read_parameter_file('cell.yaml').comments
    assert sum(line.startswith('rigid from') for line in comments) == 1


@pytest.mark.slow
def test_new_surface_drops_the_base_frame_with_a_word_and_keeps_other_parameters(
        run, simulated_surface):
    Path('cell.yaml').write_text(simulated_surface)
    live(run)
    text = Path('cell.yaml').read_text()
    Path('cell.yaml').write_text(text + '    detector: {faintest: 9.0}\n')
    code, _, error = run('board', '--camera', 'simulated', '-o', 'cell.yaml')
    assert code == 1 and 'exists already with the surface and the base frame' in error
    output = surface(run, '--force')
    assert 'warning: left out of the file: the base frame' in output
    held = read_parameter_file('cell.yaml').values
    assert held['detector.faintest'] == 9.0
    assert not set(held) & {'rotation_deg', 'base_covariance', 'calibration.base'}
    assert 'rotation_deg' in read_parameter_file('cell.yaml.bak').values


@pytest.mark.slow
def test_parameters_of_ones_own_are_kept_without_force(run):
    Path('cell.yaml').write_text('/**:\n  ros__parameters: {reach_cm: 80.0}\n')
    surface(run)
    assert read_parameter_file('cell.yaml').values['reach_cm'] == 80.0


def test_table_of_pairs_uses_the_surface_that_the_file_holds(run, simulated_surface):
    Path('cell.yaml').write_text(simulated_surface)
    Path('pairs.csv').write_text(
        'x_cam_cm,y_cam_cm,x_base_cm,y_base_cm\n1,1,1,-1\n9,1,9,-1\n9,6,9,-6\n1,6,1,6\n')
    code, output, error = run('base', 'pairs.csv', '-o', 'cell.yaml')
    assert code == 1 and 'no rigid transform fits' in error
    Path('pairs.csv').write_text(
        'x_cam_cm,y_cam_cm,x_base_cm,y_base_cm\n1,1,1,-1\n9,1,9,-1\n9,6,9,-6\n1,6,1,-6\n')
    code, output, error = run('base', 'pairs.csv', '-o', 'cell.yaml')
    assert code == 0 and 'without --surface' not in output
    assert 'surface.model' in read_parameter_file('cell.yaml').values


@pytest.mark.parametrize('arguments, said', [
    (('base', '-o', 'a.yaml'), 'expected a table and a file to write'),
    (('base', 'a.csv', '--live', 'cell.yaml'), 'alone, not a table'),
    (('base', '--live', 'none.yaml'), "there is no file 'none.yaml': first make it with"),
    (('base', '--live', 'empty.yaml'), "'empty.yaml' holds no surface: first add it"),
    (('base', '--live', 'cell.yaml', '--places', '2'), '--places must be 3 or more, got 2'),
    (('base', '--live', 'cell.yaml', '--camera', 'random'), 'is no camera that can be opened'),
    (('base', '--live', 'cell.yaml', '--camera', '/dev/video99'), 'cannot open camera'),
    (('board', 'a.png', '--placements', '2', '-o', 'a.yaml'), '--placements needs --camera'),
    (('board', '--camera', 'simulated', '--placements', '0', '-o', 'a.yaml'), 'must be 1..20'),
])
def test_what_cannot_be_done_is_one_sentence(run, arguments, said, simulated_surface):
    Path('cell.yaml').write_text(simulated_surface)
    Path('empty.yaml').write_text('/**:\n  ros__parameters: {reach_cm: 80.0}\n')
    before = {path: path.read_bytes() for path in Path().iterdir()}
    code, output, error = run(*arguments)
    assert (code, output) == (1, '')
    assert said in error
    assert {path: path.read_bytes() for path in Path().iterdir()} == before


@pytest.mark.slow
def test_report_names_what_the_board_did_not_cover(run):
    code, output, _ = run(
        'board', '--camera', 'simulated', '--placements', 1, '--json', '-o', 'cell.yaml')
    report = json.loads(output)
    assert report['covered_map'] == ['. + .', '+ # +', '. + .']
    assert 'top left' in report['not_covered'] and 'middle' not in report['not_covered']


@pytest.mark.slow
def test_status_says_what_the_nodes_log(run, simulated_surface):
    Path('cell.yaml').write_text(simulated_surface)
    live(run)
    _, output, _ = run('status', 'cell.yaml')
    said = read_node_settings('cell.yaml')
    assert output.startswith(said.camera.calibrated_for.summary)
    assert said.transform.calibration == said.camera.calibrated_for.summary
    assert 'rms' in output.splitlines()[0] and 'base frame of 20' in output.splitlines()[0]
