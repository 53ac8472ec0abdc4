# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The demo's options: a parameter file, and bumps of the simulated camera."""

import os
from pathlib import Path
import re
import signal
import subprocess
import sys

from ament_index_python.packages import get_package_share_directory
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
    output = run_until('==> since bump 1', tmp_path, '--bump')
    assert re.search(r'==> before the bumps: error [\d.]+ mm on average', output)
    assert re.search(r'==> bump 1: the camera was bumped: .* px, [\d.]+ mm on the table', output)
    errors = [float(error) for error in re.findall(r'error ([\d.]+) mm\n', output)]
    assert max(errors) < 1.0, output


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
    assert '--bump' in script.stdout and 'no_such_python' not in script.stderr
