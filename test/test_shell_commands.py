# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Commands that are named to a user can be pasted."""

from camera_to_base.shell_commands import full_command, run_command, with_full_commands
import pytest


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """Make a machine with the executables of a prefix, with the command ros2 or without it."""
    executables = tmp_path / 'prefix' / 'lib' / 'camera_to_base'
    tools = tmp_path / 'tools'
    for path in (executables / 'calibrate', executables / 'locate', tools / 'ros2'):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text('#!/bin/sh\n')
        path.chmod(0o755)
    monkeypatch.setattr('sys.argv', [str(executables / 'calibrate'), 'status'])

    def set_up(has_ros2, folders=''):
        monkeypatch.setenv('PATH', f'{tools if has_ros2 else ""}:{folders}')
        monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path / 'prefix'))
        return executables
    return set_up


def test_command_is_that_of_ros2_where_it_finds_the_package(machine, monkeypatch):
    machine(has_ros2=True)
    assert full_command('calibrate', 'status', 'my cell.yaml') == (
        "ros2 run camera_to_base calibrate status 'my cell.yaml'")
    assert run_command('cell.yaml', '0') == (
        'ros2 launch camera_to_base camera_to_base.launch.py params_file:=cell.yaml')
    monkeypatch.setenv('AMENT_PREFIX_PATH', '/opt/ros/jazzy')
    assert 'ros2 run' not in full_command('calibrate', 'status')


def test_command_is_the_path_that_was_typed_without_ros2(machine):
    folder = machine(has_ros2=False)
    assert full_command('calibrate', 'status') == f'{folder}/calibrate status'
    assert run_command('cell.yaml', 'simulated') == (
        f'{folder}/locate simulated --params-file cell.yaml')


def test_command_is_a_word_where_the_shell_finds_it(machine):
    folder = machine(has_ros2=False)
    machine(has_ros2=False, folders=folder)
    assert full_command('calibrate', 'status') == 'calibrate status'


def test_module_is_started_as_a_module(machine, monkeypatch):
    machine(has_ros2=False)
    monkeypatch.setattr('sys.argv', ['/somewhere/command.py'])
    assert full_command('locate', '0').endswith(' -m camera_to_base.commands.locate 0')


def test_sentences_get_full_commands_once(machine):
    machine(has_ros2=True)
    said = with_full_commands('make it with calibrate board -o a.yaml, or calibrate again')
    assert said == (
        'make it with ros2 run camera_to_base calibrate board -o a.yaml, or calibrate again')
    assert with_full_commands(said) == said


def test_service_is_called_by_the_name_of_the_node(machine):
    machine(has_ros2=False)
    sentence = 'clear the surface, and call ~/capture_background'
    assert with_full_commands(sentence, '/cell_1/camera_publisher') == (
        'clear the surface, and run: ros2 service call /cell_1/camera_publisher/'
        'capture_background std_srvs/srv/Trigger')
    assert with_full_commands(sentence) == 'clear the surface, and take the background again'
