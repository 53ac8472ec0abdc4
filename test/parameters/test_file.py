# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters.file import read_node_parameters
import pytest

NODE = '/cell_1/robot_base_publisher'
SECTIONS = {
    'all nodes': '/**: {ros__parameters: {reach_cm: 1.0, more: {a: [1.0, 2.0]}}}',
    'all nodes of a name': '/**/robot_base_publisher: {ros__parameters: {reach_cm: 2.0}}',
    'one level': '/*/robot_base_publisher: {ros__parameters: {reach_cm: 3.0}}',
    'full name': '/cell_1/robot_base_publisher: {ros__parameters: {reach_cm: 4.0}}',
    'no slash': 'cell_1/robot_base_publisher: {ros__parameters: {reach_cm: 5.0}}',
    'namespace of its own': 'cell_1: {robot_base_publisher: {ros__parameters: {reach_cm: 6.0}}}',
    'bare name': 'robot_base_publisher: {ros__parameters: {reach_cm: 7.0}}',
    'other namespace': '/cell_2/robot_base_publisher: {ros__parameters: {reach_cm: 8.0}}',
    'other node': '/**/camera_publisher: {ros__parameters: {reach_cm: 9.0}}',
    'dotted name': '/**: {ros__parameters: {more.a: 10.0}}',
    'later wins': '/**: {ros__parameters: {a: 1.0, b: 1.0}}\n'
                  '/cell_1/robot_base_publisher: {ros__parameters: {a: 2.0}}',
    'later wins, although it is for all': '/cell_1/robot_base_publisher: {ros__parameters: '
                                          '{a: 2.0}}\n/**: {ros__parameters: {a: 1.0}}',
}


@pytest.fixture
def write(tmp_path):
    def write_text(text):
        path = tmp_path / 'cell.yaml'
        path.write_text(text)
        return str(path)
    return write_text


@pytest.mark.parametrize('text', SECTIONS.values(), ids=SECTIONS)
def test_node_parameters_are_those_that_ros_gives_the_node(text, write):
    rclpy = pytest.importorskip('rclpy')
    path = write(text)
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node(
        'robot_base_publisher', namespace='cell_1', context=context,
        cli_args=['--ros-args', '--params-file', path],
        automatically_declare_parameters_from_overrides=True, start_parameter_services=False)
    given = {name: node.get_parameter(name).value
             for name in node.list_parameters([], 0).names}
    node.destroy_node()
    rclpy.shutdown(context=context)
    expected = read_node_parameters(path, NODE)
    assert {name: list(given[name]) if isinstance(value, list) else given[name]
            for name, value in expected.items()} == expected
    assert set(given) - {'use_sim_time', 'start_type_description_service'} == set(expected)


@pytest.mark.parametrize('text, value', [
    (SECTIONS['all nodes'], 1.0), (SECTIONS['one level'], 3.0),
    (SECTIONS['namespace of its own'], 6.0), (SECTIONS['bare name'], None)])
def test_sections_for_the_node_are_read_where_there_is_no_ros(text, value, write):
    assert read_node_parameters(write(text), NODE).get('reach_cm') == value


def test_root_node_takes_the_section_of_its_bare_name(write):
    assert read_node_parameters(
        write(SECTIONS['bare name']), '/robot_base_publisher') == {'reach_cm': 7.0}


def test_empty_section_gives_nothing(write):
    assert read_node_parameters(write('/**:\n  ros__parameters:\n'), NODE) == {}


@pytest.mark.parametrize('text', ['', 'reach_cm: 1.0', '- 1', '/**: {ros__parameters: 5}'])
def test_file_without_parameters_is_named(text, write):
    with pytest.raises(InvalidValueError, match="cell.yaml' is no parameter file"):
        read_node_parameters(write(text), NODE)


def test_file_that_is_no_yaml_is_named(write):
    with pytest.raises(InvalidValueError, match="cell.yaml' is no YAML"):
        read_node_parameters(write('/**: ['), NODE)


def test_file_that_would_take_minutes_is_refused_at_once(tmp_path):
    path = tmp_path / 'cell.yaml'
    path.write_text(f'/**: {{ros__parameters: {{surface.hull: {[1.25] * 100000}}}}}')
    with pytest.raises(InvalidValueError, match='characters, at most 200000 are read'):
        read_node_parameters(str(path), '/camera_publisher')
