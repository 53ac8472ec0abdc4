# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.parameters import all_names, TRANSFORM_SPECS
from camera_to_base.parameters.command_line import (
    file_warnings, given_arguments, given_warnings, GivenArguments)
from camera_to_base.settings import CAMERA_SPECS
import pytest

NODE = '/cell/robot_base_publisher'
OWN = ['reach_cm', 'rotation_deg']
CAMERA = ['source', 'detector.threshold']


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / 'cell.yaml'
        path.write_text(text)
        return str(path)
    return write


def section(name, values):
    return f'{name}:\n  ros__parameters: {{{values}}}\n'


def warnings(given, path=None, others=CAMERA, arguments=()):
    files = ['--params-file', path] if path else []
    return given_warnings(NODE, given, ['node', '--ros-args', *files, *arguments], OWN, others)


@pytest.mark.parametrize('arguments, found', [
    ([], GivenArguments([], [])),
    (['node', '--params-file', 'a.yaml', '-p', 'x:=1'], GivenArguments([], [])),
    (['node', '--ros-args', '--params-file', 'a.yaml', '-p', 'x:=1', '-r', 'image:=/raw',
      '--param', 'other_node:y.z:=a:b'], GivenArguments(['a.yaml'], ['x', 'y.z'])),
    (['node', '--ros-args', '-p', 'x:=1', '--', '-p', 'y:=1'], GivenArguments([], ['x'])),
    (['node', '--ros-args', '--params-file'], GivenArguments([''], []))])
def test_parameters_are_found_in_a_command_line(arguments, found):
    assert given_arguments(arguments) == found


def test_every_unknown_name_is_told_with_the_nearest():
    assert warnings(['reach', 'rotation_deg', 'source', 'foo', 'threshold']) == [
        "there is no parameter 'foo', it is left out",
        "there is no parameter 'reach', it is left out: did you mean 'reach_cm'?",
        "there is no parameter 'threshold', it is left out: did you mean 'detector.threshold'?"]


def test_what_a_file_says_to_all_nodes_is_told_only_where_it_looks_like_ones_own(file):
    path = file(section('/**', 'reach: 3, source: 0, foo: 1, bar: 2') + section(
        NODE, 'bar: 3'))
    found = warnings(['reach', 'source', 'foo', 'bar', 'baz'], path, None, ['-p', 'baz:=1'])
    assert found == [
        "there is no parameter 'bar', it is left out",
        "there is no parameter 'baz', it is left out",
        "there is no parameter 'reach', it is left out: did you mean 'reach_cm'?"]


def test_what_the_camera_node_reads_is_not_told_by_the_transform_node(file):
    # ros2 run camera_to_base robot_base_publisher --ros-args --params-file cell.yaml
    names = all_names(CAMERA_SPECS)
    path = file(section('/**', ', '.join(f'{name}: 1' for name in names)))
    arguments = ['node', '--ros-args', '--params-file', path]
    assert given_warnings(NODE, names, arguments, all_names(TRANSFORM_SPECS), None) == []


@pytest.mark.parametrize('text', ['', '# nothing', '/**:\n', '/**:\n  ros__parameters: {}\n'])
def test_file_without_parameters_is_told(file, text):
    path = file(text)
    assert file_warnings(path, NODE) == [f"'{path}' holds no parameters"]


@pytest.mark.parametrize('name', [
    'robot_base_publsher', '/cell/robot_base_publishers', 'robot_base_publisher',
    '/other/robot_base_publisher'])
def test_file_for_a_node_of_nearly_this_name_is_told(file, name):
    path = file(section(name, 'reach_cm: 3') + section('usb_cam', 'framerate: 3'))
    assert file_warnings(path, NODE) == [
        f"'{path}' has parameters for '/{name.lstrip('/')}', and none for this node alone, "
        f"'{NODE}'"]


def test_misspelt_node_is_told_beside_a_section_for_all_nodes(file):
    everyone = section('/**', 'reach_cm: 3')
    assert len(file_warnings(file(everyone + section('robot_base_publsher', 'a: 3')), NODE)) == 1
    assert file_warnings(file(everyone + section(
        '/other/robot_base_publisher', 'a: 3')), NODE) == []
    assert file_warnings(file(section(NODE, 'a: 3') + section(
        '/cell/robot_base_publisher2', 'a: 3')), NODE) == []


@pytest.mark.parametrize('name', [
    '/**', '/cell/*', '/**/robot_base_publisher', NODE, '/cell:\n  robot_base_publisher',
    'camera_publisher', '/cell/camera_publisher', 'usb_cam'])
def test_file_for_this_node_or_for_quite_another_is_not_told(file, name):
    text = section(name, 'reach_cm: 3').replace('\n  ros__', '\n    ros__')
    assert file_warnings(file(text), NODE) == []


def test_file_that_cannot_be_read_is_left_to_ros(tmp_path):
    assert warnings(['reach_cm'], str(tmp_path / 'none.yaml')) == []
