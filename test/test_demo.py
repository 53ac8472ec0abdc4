# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The demo: what it prints, its options, and what it has for itself."""

from io import StringIO
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
import time

from ament_index_python.packages import get_package_share_directory
from demo_terminal import Terminal
import pytest

ROOT = Path(__file__).parents[1]
TILTED = os.path.join(get_package_share_directory('camera_to_base'), 'config',
                      'simulated_tilted_camera.yaml')


def run_until(found, tmp_path, *options):
    """Run the demo until a line holds a text, and give all that it printed."""
    demo = subprocess.Popen(
        [sys.executable, str(ROOT / 'scripts' / 'demo.py'), *options], cwd=tmp_path, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    lines = []
    while found not in ''.join(lines[-1:]):
        lines.append(demo.stdout.readline())
        assert lines[-1], lines
    demo.send_signal(signal.SIGINT)
    rest, _ = demo.communicate(timeout=10.0)
    assert demo.returncode == 0
    return ''.join(lines) + rest


@pytest.mark.slow
def test_bumps_never_make_a_wrong_position(tmp_path):
    output = run_until('==> bump 2', tmp_path, '--bump')
    assert re.search(r'==> before the bumps: error [\d.]+ mm on average', output)
    assert re.search(r'==> bump 1: the camera was bumped: .* px, [\d.]+ mm on the table', output)
    errors = [float(error) for error in re.findall(r'error ([\d.]+) mm\n', output)]
    assert max(errors) < 1.0, output
    assert re.search(r'==> since bump 1: error [\d.]+ mm on average', output)
    largest, = re.findall(r'\d+ positions, largest error ([\d.]+) mm', output)
    assert max(errors) <= float(largest) < 1.0
    # The corrected camera was not told to be calibrated anew.
    assert '[ERROR]' not in output.partition('==> bump 2')[0], output


@pytest.mark.slow
def test_arm_picks_solid_objects_and_each_pick_is_true(tmp_path):
    # The sixth object lies elsewhere: the table was laid anew.
    output = run_until('==> pick 6', tmp_path, '--pick')
    tries = re.findall(
        r'==> (\w+) (\d+): the gripper closed ([\d.]+) mm from the true place; (\d+) of (\d+)',
        output)
    assert [number for _, number, *_ in tries] == list('123456')
    for what, number, away_mm, successes, count in tries:
        assert what == 'pick' and successes == count == number
        assert float(away_mm) < 1.0
    assert '==> 6 of 6 picks succeeded' in output
    assert output.count('picked at (') >= 5


@pytest.mark.slow
def test_picks_beside_the_true_place_are_not_counted(tmp_path):
    config = Path(TILTED).with_name('simulated_solid_objects.yaml').read_text()
    assert 'displacement_cm: [-17.8, 24.4, 0.0]' in config
    file = tmp_path / 'wrong.yaml'
    file.write_text(config.replace('[-17.8, 24.4, 0.0]', '[-17.3, 24.4, 0.0]'))
    output = run_until('==> miss 2', tmp_path, '--pick', '--params', str(file))
    assert re.search(r'==> miss 1: the gripper closed [45]\.\d+ mm from the true place; 0 of 1',
                     output)
    assert '==> 0 of 2 picks succeeded' in output and 'picked at' not in output.replace(
        'not picked at', '')


@pytest.mark.slow
def test_two_cameras_measure_the_heights_that_nobody_told(tmp_path):
    output = run_until('==> largest error', tmp_path, '--two')
    lines = re.findall(r'error ([\d.]+) mm;  height ([\d.]+) cm  true ([\d.]+) cm', output)
    assert len(lines) >= 3, output
    for place_mm, height_cm, true_cm in lines:
        assert float(place_mm) < 0.5 and abs(float(height_cm) - float(true_cm)) < 0.2
    assert re.search(r'positions, largest error [\d.]+ mm, of the height [\d.]+ mm', output)


@pytest.mark.slow
def test_two_demos_share_nothing_and_tell_their_addresses(tmp_path):
    alone = {name: value for name, value in os.environ.items() if name != 'ROS_DOMAIN_ID'}
    demos = [subprocess.Popen(
        [sys.executable, str(ROOT / 'scripts' / 'demo.py')], cwd=tmp_path, text=True, env=alone,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT) for _ in range(2)]
    until = time.monotonic() + 60.0
    while len(list(tmp_path.glob('*.png'))) < 2 and time.monotonic() < until:
        time.sleep(0.2)
    time.sleep(3.0)
    outputs = []
    for demo in demos:
        demo.send_signal(signal.SIGINT)
        outputs.append(demo.communicate(timeout=20.0)[0])
    for kind, pattern in (('domain', r'ROS domain (\d+)'), ('page', r'\| (http://\S+)'),
                          ('picture', r'annotated picture: (.*)')):
        found = [re.findall(pattern, output) for output in outputs]
        assert all(len(one) == 1 for one in found), outputs
        assert found[0] != found[1], (kind, outputs)
    for output in outputs:
        lines = output.splitlines()
        assert lines[-1].startswith('page: http://127.0.0.1:')
        assert re.fullmatch(r'\d+ positions, largest error 0.0\d mm', lines[-3]), lines
        assert 'NOT CALIBRATED' not in output


@pytest.mark.slow
def test_random_positions_are_marked_in_each_line(tmp_path):
    output = run_until('cm  RANDOM', tmp_path, 'random')
    assert re.search('base .* cm  RANDOM', output), output
    assert 'RANDOM: these are not the positions on your table' in output


def test_terminal_updates_one_line_below_those_that_stay(monkeypatch):
    screen = Screen()
    monkeypatch.setenv('COLUMNS', '40')
    terminal = Terminal(screen)
    terminal.update(['camera (1.00, 2.00)', 'base (3.00, 4.00)'])
    terminal.say('a message')
    terminal.update(['camera (1.00, 2.00)', 'base (5.00, 6.00)', 'error 0.10 mm'])
    assert screen.lines() == ['a message', 'base (5.00, 6.00)  error 0.10 mm']
    terminal.settle()
    terminal.frame(['an address'])
    assert screen.lines()[-4:-1] == ['+------------+', '| an address |', '+------------+']


def test_without_a_terminal_one_line_a_second_is_printed():
    file = StringIO()
    terminal = Terminal(file)
    for number in range(20):
        terminal.update([f'position {number}'])
    assert file.getvalue() == 'position 0\n'


class Screen(StringIO):
    """A terminal, as far as the demo uses it."""

    def isatty(self):
        return True

    def lines(self):
        """Give what can be seen."""
        return [line.rpartition('\r\x1b[K')[2] for line in self.getvalue().split('\n')]


@pytest.mark.slow
def test_parameter_file_is_used_by_both_nodes(tmp_path):
    file = tmp_path / 'cell.yaml'
    file.write_text(Path(TILTED).read_text())
    output = run_until('error', tmp_path, '--params', str(file))
    assert "on the source 'simulated'" in output
    error, = re.findall(r'error ([\d.]+) mm', output)[:1]
    assert float(error) < 1.0


@pytest.mark.parametrize('options, text', [
    (['--params', 'missing.yaml'], "'missing.yaml'"),
    (['--bump', 'random'], 'simulated camera only'),
    (['--pick', '0'], 'simulated camera only'),
    (['--pick', '--bump'], 'not allowed with'),
    (['--wrong'], 'unrecognized'),
])
def test_wrong_options_are_refused_in_a_sentence(tmp_path, options, text):
    demo = subprocess.run([sys.executable, str(ROOT / 'scripts' / 'demo.py'), *options],
                          cwd=tmp_path, text=True, capture_output=True, timeout=60.0)
    assert demo.returncode == 2
    assert text in demo.stderr and 'Traceback' not in demo.stderr


@pytest.mark.parametrize('options, code', [
    (['--help'], 0), (['--wrong'], 2), (['--params'], 2), (['one', 'two'], 2), ([''], 2)])
def test_script_explains_itself_before_it_installs_anything(options, code):
    script = subprocess.run([str(ROOT / 'scripts' / 'demo'), *options], text=True,
                            capture_output=True, timeout=10.0,
                            env={'PATH': '/usr/bin:/bin', 'PYTHON': 'no_such_python'})
    assert script.returncode == code
    assert '--bump' in script.stdout and '--pick' in script.stdout
    assert 'no_such_python' not in script.stderr
