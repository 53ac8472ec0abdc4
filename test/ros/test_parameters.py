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

from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
import pytest
from rclpy.parameter import parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
import yaml

# What YAML could take for a number, a truth or nothing, and what has no numbers to tell its type.
CAMERA_ARGUMENTS = [
    'source:=simulated', 'period:=2', 'background_frames:=3', 'wait_for_camera:=false',
    'camera_frame_id:="12"', "annotated_picture:='on: ä #1.png'", 'detector.method:=tutorial',
    'detector.closing_size:=7', 'detector.max_area_cm2:=1e-7', 'surface.camera_foot_cm:=[]',
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
