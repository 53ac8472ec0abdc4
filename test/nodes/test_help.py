# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import os
import re
import subprocess

from ament_index_python.packages import get_package_prefix
from camera_to_base.fusion import FUSION_SPECS
from camera_to_base.nodes.help import NODE_HELP, plain_arguments
from camera_to_base.parameters.transform import TRANSFORM_SPECS
from camera_to_base.settings import CAMERA_SPECS
import pytest
from rclpy.utilities import remove_ros_args

NODES = {'camera_fusion': 'camera_fusion', 'camera_publisher': 'camera_publisher',
         'robot_base_publisher': 'robot_base_publisher',
         'robotic_arm_publishing_subscriber': 'robot_base_publisher'}
SPECS = {'camera_publisher': CAMERA_SPECS, 'robot_base_publisher': TRANSFORM_SPECS,
         'camera_fusion': FUSION_SPECS}

every_executable = pytest.mark.parametrize('executable', [*NODES, 'calibrate', 'locate'])


def run(executable, *arguments):
    path = os.path.join(get_package_prefix('camera_to_base'), 'lib', 'camera_to_base', executable)
    # Where ROS starts, it refuses a domain such as this.
    return subprocess.run([path, *arguments], env={**os.environ, 'ROS_DOMAIN_ID': 'nowhere'},
                          capture_output=True, text=True, timeout=20.0)


@pytest.mark.parametrize('option', ['-h', '--help'])
@every_executable
def test_help_explains_with_an_example_and_ends_with_0_without_ros(executable, option):
    process = run(executable, option)
    assert process.returncode == 0 and process.stderr == ''
    assert process.stdout.startswith('usage: ')
    # An example is a line that can be copied: it starts with the command.
    command = {'calibrate': 'calibrate (board|points)', 'locate': r'locate \w+\.mp4'}.get(
        executable, f'ros2 run camera_to_base {executable} --ros-args')
    assert re.search(rf'^ +{command} .*', process.stdout, re.MULTILINE)
    assert max(map(len, process.stdout.splitlines())) < 100


@pytest.mark.parametrize('command', ['board', 'points', 'base', 'check'])
def test_each_command_of_calibrate_has_an_example(command):
    assert re.search(rf'^  calibrate {command} \S+', run('calibrate', command, '--help').stdout,
                     re.MULTILINE)


@pytest.mark.parametrize('executable, node', NODES.items())
def test_help_after_ros_arguments_is_the_same(executable, node):
    text = run(executable, '--ros-args', '-p', 'source:=simulated', '--help').stdout
    assert text == run(executable, '--help').stdout
    assert f'ros2 param describe /{node} NAME' in text


@pytest.mark.parametrize('node', SPECS)
def test_parameters_that_help_names_are_those_of_the_node(node):
    block, = re.findall(r'used most:\n((?: .*\n)+)', NODE_HELP[node])
    named = re.findall(r'^  (\S+)', block, re.MULTILINE)
    assert len(named) >= 3
    assert set(named) <= {spec.name for spec in SPECS[node]}


@pytest.mark.parametrize('arguments, wrong', [
    (['--sorce', 'simulated'], '--sorce'),
    (['-p', 'source:=simulated'], '-p'),
    (['source:=simulated'], 'source:=simulated'),
    (['--ros-args', '-p', 'source:=simulated', '--', '--sorce'], '--sorce')])
def test_argument_that_ros_would_not_see_is_one_clear_line_and_exit_code_1(arguments, wrong):
    process = run('camera_publisher', *arguments)
    assert process.returncode == 1 and process.stdout == ''
    assert process.stderr == (
        f"camera_publisher: expected ROS arguments only, after --ros-args, got '{wrong}': "
        'see camera_publisher --help\n')


@pytest.mark.parametrize('arguments, plain', [
    ([], []),
    (['--ros-args'], []),
    (['--ros-args', '-p', 'a:=1', '--'], []),
    (['--ros-args', '-p', 'a:=1', '--ros-args', '-r', 'b:=c'], []),
    (['a', '--ros-args', '-p', 'a:=1', '--', 'b', '--ros-args', '--', 'c'], ['a', 'b', 'c'])])
def test_plain_arguments_are_those_that_ros_leaves(arguments, plain):
    assert plain_arguments(arguments) == plain == remove_ros_args(['exe', *arguments])[1:]
