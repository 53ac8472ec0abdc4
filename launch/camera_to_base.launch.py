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

"""Starts both nodes with one parameter file; each is started anew if it dies."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, OpaqueFunction, RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description() -> LaunchDescription:
    """Describe the two nodes and their arguments."""
    config = os.path.join(get_package_share_directory('camera_to_base'), 'config')
    camera = _node('camera_publisher', [
        LaunchConfiguration('params_file'),
        {'source': ParameterValue(LaunchConfiguration('source'), value_type=str)}])
    transform = _node('robot_base_publisher', [LaunchConfiguration('params_file')])
    return LaunchDescription([
        DeclareLaunchArgument(
            'params_file', default_value=os.path.join(config, 'overhead_camera.yaml'),
            description='Parameter file of both nodes.'),
        DeclareLaunchArgument(
            'source', default_value='auto',
            description='auto, random, simulated, a device index or path, a video or a URL.'),
        DeclareLaunchArgument(
            'namespace', default_value='', description='Namespace of nodes and topics.'),
        OpaqueFunction(function=_refuse_missing_file),
        camera,
        transform,
        RegisterEventHandler(OnProcessExit(target_action=camera, on_exit=_end_with_recording)),
    ])


def _refuse_missing_file(context):
    # launch_ros would only warn, and the nodes would run with the tutorial's calibration.
    path = LaunchConfiguration('params_file').perform(context)
    if not os.path.isfile(path):
        raise RuntimeError(f"params_file: there is no file '{path}'")


def _node(executable, parameters):
    return Node(
        package='camera_to_base', executable=executable, name=executable,
        namespace=LaunchConfiguration('namespace'), parameters=parameters, output='screen',
        respawn=True, respawn_delay=1.0)


def _end_with_recording(event, context):
    # A camera node that ends by itself, without an error, has played its recording to the end.
    if event.returncode == 0:
        return [EmitEvent(event=Shutdown(reason='the recording has ended'))]
    return None
