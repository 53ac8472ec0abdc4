# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""`calibrate base --from`: a camera gets its base frame from another one that has it."""

import os
import threading

from ament_index_python.packages import get_package_share_directory
from camera_to_base.commands.calibrate.command import main
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
from camera_to_base.parameters.file import read_parameter_file
import numpy as np
import pytest

FLAT = '-p', 'simulated.heights_cm:=[0.0]', '-p', 'simulated.layout:=3'


CONFIG = os.path.join(get_package_share_directory('camera_to_base'), 'config')


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Write right.yaml, which lacks the base frame."""
    monkeypatch.chdir(tmp_path)
    with open(os.path.join(CONFIG, 'simulated_right.yaml')) as file:
        text = file.read()
    lines = text[:text.index('    rotation_deg')].splitlines(keepends=True)
    (tmp_path / 'right.yaml').write_text(
        ''.join(line for line in lines if ' base: ' not in line))


@pytest.fixture
def cell(ros, folder):
    """Run two simulated cameras."""
    left = os.path.join(CONFIG, 'simulated_left.yaml')
    for name, file in (('left', left), ('right', 'right.yaml')):
        ros.add(CameraPublisher, '--params-file', file, '-r', f'__ns:=/{name}', *FLAT)
    ros.add(RobotBasePublisher, '--params-file', left, '-r', '__ns:=/left')
    ends = threading.Event()

    def live():
        while not ends.is_set():
            ros.executor.spin_once(timeout_sec=0.05)

    thread = threading.Thread(target=live, daemon=True)
    thread.start()
    yield
    ends.set()
    thread.join()


class Enter:
    """A person who presses Enter; the background may still be taken at first."""

    def __init__(self, times):
        self._left = times

    def readline(self):
        self._left -= 1
        return '\n' if self._left >= 0 else ''


@pytest.mark.slow
def test_flat_objects_that_both_see_give_the_base_frame(cell, capsys, monkeypatch):
    monkeypatch.setattr('sys.stdin', Enter(10))
    code = main(['base', '--from', '/left', 'right.yaml', '--live'])
    output, said = capsys.readouterr()
    assert code == 0, said
    assert 'topics /right/objects_in_cam_frame and /left/objects_in_robot_base_frame' in said
    assert 'error at 5 points' in output
    values = read_parameter_file('right.yaml').values
    np.testing.assert_allclose(values['displacement_cm'], [-17.8, 24.4, 0.0], atol=0.05)
    np.testing.assert_allclose(values['rotation_deg'], [180.0, 0.0, 0.0], atol=0.1)


@pytest.mark.slow
def test_a_camera_that_does_not_run_is_named(cell, capsys):
    assert main(['base', '--from', '/nobody', '--live', 'right.yaml']) == 1
    assert 'nobody publishes /nobody/objects_in_robot_base_frame' in capsys.readouterr().err


@pytest.mark.parametrize('more, told', [
    (['--from', '/left'], '--from takes the file of the camera that has no base frame'),
    (['--from', '/left', '--live', 'right.yaml', '--places', '4'], '--places must be 5 or more'),
    (['--from', '/left', '--live', 'right.yaml', '--robot-topic', '/tool'], 'not --robot-topic'),
    (['--live'], 'expected a table and a file to write')])
def test_options_that_do_not_go_together_are_refused(more, told, folder, capsys):
    assert main(['base', *more]) == 1
    assert told in capsys.readouterr().err
