# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
from camera_to_base.parameters.spec import ParameterSpec
from camera_to_base.ros.parameters import NodeParameters
import pytest
from rcl_interfaces.msg import Parameter as ParameterMessage, ParameterType, ParameterValue
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
import yaml

# What YAML could take for a number, a truth or nothing, and what has no numbers to tell its type.
CAMERA_ARGUMENTS = [
    'source:=simulated', 'period:=2', 'background_frames:=3', 'wait_for_camera:=false',
    'camera_frame_id:="12"', "calibration.device:='on: ä #1.png'", 'detector.method:=tutorial',
    'detector.closing_size:=7', 'detector.max_area_cm2:=1e-7',
    'detector.min_area_cm2:=1e-8', 'surface.camera_foot_cm:=[]',
    'surface.hull:=[0.0, 0.5, 639.0, 1e-7, 320.0, 479.0]', 'surface.image_size:=[320, 240]',
    'surface.polynomial.y_of_v:=[6e-07, 1e22, -3.0]', 'simulated.diameters_cm:=[3, 2]',
    'displacement_cm:=[0.1, -1e-5, 0.0]', 'qos_overrides./mask.publisher.reliability:=best_effort']
BASE_ARGUMENTS = [
    'base_frame_id:="yes"', 'rotation_deg:=[180, 0, 33]', 'reach_cm:=75', 'use_sim_time:=true',
    'qos_overrides./pos_in_cam_frame.subscription.depth:=3']


def values_of(ros, node_name):
    """Ask a running node for all its parameters, as `ros2 param` does."""
    client = AsyncParameterClient(ros.node, node_name)
    assert ros.spin_until(client.services_are_ready)

    def answer(future):
        assert ros.spin_until(future.done)
        return future.result()

    names = sorted(answer(client.list_parameters()).result.names)
    return dict(zip(names, answer(client.get_parameters(names)).values))


def dump(node_name, values):
    """Write a node's parameters as `ros2 param dump` does: each part of a name is a level."""
    tree = {}
    for name, value in values.items():
        *levels, last = name.split('.')
        branch = tree
        for level in levels:
            branch = branch.setdefault(level, {})
        branch[last] = parameter_value_to_python(value)
    return yaml.dump({node_name: {'ros__parameters': tree}}, default_flow_style=False)


@pytest.mark.parametrize('node_class, node_name, arguments', [
    (CameraPublisher, '/camera_publisher', ['source:=random']),
    (CameraPublisher, '/camera_publisher', CAMERA_ARGUMENTS),
    (RobotBasePublisher, '/robot_base_publisher', []),
    (RobotBasePublisher, '/robot_base_publisher', BASE_ARGUMENTS)])
def test_node_that_is_started_with_the_dump_of_another_has_the_same_parameters(
        ros, tmp_path, monkeypatch, node_class, node_name, arguments):
    monkeypatch.chdir(tmp_path)
    ros.add(node_class, *(part for argument in arguments for part in ('-p', argument)))
    values = values_of(ros, node_name)
    assert {argument.split(':=')[0] for argument in arguments} <= set(values)
    (tmp_path / 'dump.yaml').write_text(dump(node_name, values))
    second = ros.add(node_class, '--params-file', str(tmp_path / 'dump.yaml'))
    found = second.get_parameters_by_prefix('')
    assert {name: each.get_parameter_value() for name, each in found.items()} == values


CAMERA = CameraPublisher, '/camera_publisher'
BASE = RobotBasePublisher, '/robot_base_publisher'


@pytest.mark.parametrize('kind', [ParameterType.PARAMETER_DOUBLE_ARRAY,
                                  ParameterType.PARAMETER_INTEGER_ARRAY])
@pytest.mark.parametrize('node_class, node_name, name, accepted', [
    (*CAMERA, 'surface.hull', True), (*CAMERA, 'surface.camera_foot_cm', True),
    (*CAMERA, 'surface.image_size', False), (*BASE, 'rotation_deg', False)])
def test_client_may_clear_a_list_and_the_node_lives(
        ros, kind, node_class, node_name, name, accepted):
    arguments = ['-p', 'source:=random', '-p', 'surface.hull:=[0.0, 0.0, 9.0, 0.0, 9.0, 9.0]']
    node = ros.add(node_class, *(arguments if node_class is CameraPublisher else []))
    before = node.get_parameter(name).value
    client = AsyncParameterClient(ros.node, node_name)
    assert ros.spin_until(client.services_are_ready)
    future = client.set_parameters([ParameterMessage(name=name, value=ParameterValue(type=kind))])
    assert ros.spin_until(future.done)
    result, = future.result().results
    assert result.successful == accepted and bool(result.reason) != accepted
    assert list(node.get_parameter(name).value) == ([] if accepted else list(before))
    assert node._settings is not None


def test_cleared_hull_warns_of_nothing_any_more(ros):
    node = ros.add(CameraPublisher, '-p', 'source:=random',
                   '-p', 'surface.hull:=[0.0, 0.0, 9.0, 0.0, 9.0, 9.0]')
    assert node._settings.hull is not None
    cleared = Parameter('surface.hull', Parameter.Type.DOUBLE_ARRAY, [])
    assert node.set_parameters([cleared])[0].successful
    assert node._settings.hull is None


class Renamed(Node):
    """A node whose parameter was called `reach` before."""

    def __init__(self, **options):
        super().__init__('renamed', **options)
        specs = [ParameterSpec('reach_cm', 9.0, '', (0, 99), old_names=('reach',))]
        self.parameters = NodeParameters(self, specs, dict, cli_args=options.get('cli_args'))


def test_old_name_works_at_the_start_and_later_with_a_warning(ros):
    log = ros.listen_to_log('renamed')
    node = ros.add(Renamed, '-p', 'reach:=3')
    assert node.parameters.current == {'reach_cm': 3.0}
    assert node.get_parameter('reach_cm').value == 3.0 and not node.has_parameter('reach')
    result, = node.set_parameters([Parameter('reach', value=4)])
    assert result.successful and node.parameters.current == {'reach_cm': 4.0}
    assert ros.spin_until(lambda: len(log) == 2)
    assert all("'reach' is called 'reach_cm' now" in line.text for line in log)


def test_what_a_file_says_in_vain_is_told(ros, tmp_path):
    log = ros.listen_to_log('camera_publisher')
    path = tmp_path / 'cell.yaml'
    path.write_text('/**:\n  ros__parameters: {surface: 5, reach: 3, reach_cm: 9, foo: 1}\n'
                    '/camera_publisher:\n  ros__parameters: {threshold: 5, period: 2}\n')
    ros.add(CameraPublisher, '-p', 'source:=random', '--params-file', str(path))
    texts = [
        "there is no parameter 'foo', it is left out",
        "there is no parameter 'reach', it is left out: did you mean 'reach_cm'?",
        "there is no parameter 'surface', it is left out: did you mean 'surface.model'?",
        "there is no parameter 'threshold', it is left out: did you mean 'detector.threshold'?"]
    assert ros.spin_until(lambda: set(texts) <= {line.text for line in log})
    assert sum('there is no parameter' in line.text for line in log) == len(texts)


def test_node_name_that_is_misspelt_in_a_file_is_told(ros, tmp_path):
    log = ros.listen_to_log('robot_base_publisher')
    path = tmp_path / 'cell.yaml'
    path.write_text('/robot_base_publsher:\n  ros__parameters: {reach_cm: 5.0}\n')
    ros.add(RobotBasePublisher, '--params-file', str(path))
    assert ros.spin_until(lambda: any(
        "has parameters for '/robot_base_publsher'" in line.text for line in log))


@pytest.mark.parametrize('node_class, node_name', [CAMERA, BASE])
def test_one_file_for_both_nodes_is_no_reason_to_warn(ros, tmp_path, node_class, node_name):
    log = ros.listen_to_log(node_name.strip('/'))
    path = tmp_path / 'cell.yaml'
    path.write_text('/**:\n  ros__parameters: {source: random, reach_cm: 50, use_sim_time: false, '
                    'simulated.yaw_deg: 3, view: {max_shift_px: 1}}\n')
    ros.add(node_class, '--params-file', str(path))
    assert ros.spin_until(lambda: any('publishing on' in line.text or 'RANDOM' in line.text
                                      for line in log))
    assert not any('there is no' in line.text or 'cell.yaml' in line.text for line in log)
