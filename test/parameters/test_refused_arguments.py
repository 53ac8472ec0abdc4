# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.parameters import argument_problem
import pytest


def problem(*arguments):
    return argument_problem(['camera_publisher', '--ros-args', *arguments])


@pytest.mark.parametrize('arguments, sentence', [
    (['-p', 'source:='], 'parameter source has no value: write -p source:=VALUE, or leave it out'),
    (['-p', 'source=0'], "expected -p NAME:=VALUE, got '-p source=0'"),
    (['-p', 'displacement_cm:=[-17.8, 24.4, 0]'],
     'all numbers of the list displacement_cm must be of one kind, got [-17.8, 24.4, 0]: '
     'write [-17.8, 24.4, 0.0]'),
    (['-r', 'image=/camera'], "expected -r OLD_NAME:=NEW_NAME, got '-r image=/camera'"),
])
def test_wrong_argument_is_named_with_what_to_write(arguments, sentence):
    assert problem(*arguments) == sentence


@pytest.mark.parametrize('rule, part', [
    ('__ns:=cell_1', "begins with '/'"), ('__ns:=/1', "got '/1'"), ('__node:=9a', "got '9a'"),
    ('camera_publisher:__node:=a-b', "got 'a-b'")])
def test_name_that_ros_does_not_take_is_told_with_the_rule_for_names(rule, part):
    assert part in problem('-r', rule)


@pytest.mark.parametrize('content, part', [
    (None, 'No such file'),
    ('source: simulated', "no 'ros__parameters:'"),
    ('/**:\n  ros__parameters:\n    source: [a', 'line 3'),
    ('/**:\n  ros__parameters:\n\tsource: 0', 'line 3, column 1'),
    ('/**:\n  ros__parameters:\n    surface: {a: [1, 2.0]}',
     'the list surface.a must be of one kind, got [1, 2.0]: write [1.0, 2.0]'),
])
def test_parameter_file_that_ros_cannot_read_is_named_with_the_place(content, part, tmp_path):
    path = tmp_path / 'cell.yaml'
    if content is not None:
        path.write_text(content)
    assert str(path) in problem('--params-file', str(path))
    assert part in problem('--params-file', str(path))


def test_right_arguments_and_those_outside_of_ros_args_are_no_problem():
    assert problem('-p', 'source:=0', '-p', 'a:b:=[1, 2]', '-r', '__ns:=/cell/left', '-r',
                   'image:=/camera/image_raw', '--', '-p', 'source=0') is None
