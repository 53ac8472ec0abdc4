# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Starts both nodes with one parameter file, and optional drivers, tf and RViz.

A node that dies is restarted; a node that cannot start ends the launch.
"""

import atexit
import functools
import os
import shutil
import sys
import tempfile

from ament_index_python.packages import (
    get_package_prefix, get_package_share_directory, PackageNotFoundError)
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.files import shared_memory_environment
from camera_to_base.launching import (
    argument_warnings, check_frames, choose_cameras, driver_parameters, DRIVERS, frames,
    fusion_parameters, image_input, is_fused, is_wanted, kept_background, LaunchedCamera,
    make_params_file, not_installed, plays_recording, recording_failure, transform_arguments,
    unknown_arguments)
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, OpaqueFunction
from launch.events import matches_action, Shutdown
from launch.events.process import ShutdownProcess
from launch.logging import get_logger
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

CONFIG = os.path.join(get_package_share_directory('camera_to_base'), 'config')
LARGE_PICTURES = os.path.join(CONFIG, 'fastdds', 'large_pictures.xml')
DEFAULT = LaunchedCamera(os.path.join(CONFIG, 'overhead_camera.yaml'))


def generate_launch_description() -> LaunchDescription:
    """Describe the arguments; what is started follows from their values."""
    arguments = [
        DeclareLaunchArgument(
            'params_file', default_value=DEFAULT.params_file,
            description='Parameter file of both nodes. With dashboard:=true it is made if it does '
                        'not exist.'),
        DeclareLaunchArgument(
            'source', default_value=DEFAULT.source,
            description='auto (then a source in the parameter file holds), random, simulated, a '
                        'device index or path, a video or a URL.'),
        DeclareLaunchArgument(
            'namespace', default_value=DEFAULT.namespace,
            description='Namespace of nodes and topics.'),
        DeclareLaunchArgument(
            'image_topic', default_value=DEFAULT.image_topic,
            description='Take frames from this topic: sensor_msgs/CompressedImage where it ends '
                        'in /compressed, and sensor_msgs/Image elsewhere.'),
        DeclareLaunchArgument(
            'camera_driver', default_value=DEFAULT.camera_driver,
            description='Start this driver for the device that source names, and take frames '
                        'from its topic: usb_cam, v4l2_camera or none.'),
        DeclareLaunchArgument(
            'cameras', default_value='',
            description='A list of cameras in YAML, instead of all arguments above: see '
                        'config/two_cameras.yaml. Or two parameter files with , between them: '
                        'cameras that look at one table, and camera_fusion.'),
        DeclareLaunchArgument(
            'publish_tf', default_value='false',
            description='Publish the transform of the parameter file on /tf_static.'),
        DeclareLaunchArgument(
            'rviz', default_value='false', description='Start RViz, one window for each camera.'),
        DeclareLaunchArgument(
            'dashboard', default_value='false',
            description='Start the dashboard, a page for all cameras; its address is printed.'),
    ]
    names = [argument.name for argument in arguments]
    return LaunchDescription([
        *arguments, *(OpaqueFunction(function=function, args=[names])
                      for function in (_warn, _start))])


def _warn(context, names):
    for warning in argument_warnings(context.launch_configurations, names, _ours_alone()):
        get_logger('camera_to_base').warning(warning)


def _ours_alone():
    # If another launch file includes this one, its arguments are among the given ones.
    return {'camera_to_base', 'camera_to_base.launch.py'} <= set(sys.argv)


def _start(context, names):
    # The camera node publishes no random positions if something was given in vain.
    given = context.launch_configurations
    unknown = {name: ParameterValue(given[name], value_type=str)
               for name in unknown_arguments(given, names, _ours_alone())}
    camera = LaunchedCamera(*(_value(context, name) for name in LaunchedCamera._fields))
    has_dashboard = is_wanted('dashboard', _value(context, 'dashboard'))
    if has_dashboard and not _value(context, 'cameras'):
        _make_params_file(camera)
    cameras = choose_cameras(_value(context, 'cameras'), camera, DEFAULT)
    playing, folder = set(cameras), _folder_of_this_launch()
    actions = []
    for number, camera in enumerate(cameras):
        background_file = os.path.join(folder, f'background_{number}.png')
        actions += _camera_actions(camera, playing, background_file, unknown)
    if is_fused(_value(context, 'cameras')):
        actions.append(_fusion(cameras))
    if is_wanted('publish_tf', _value(context, 'publish_tf')):
        _require('tf2_ros', 'publish_tf:=true')
        check_frames(cameras)
        actions += [_transform_publisher(camera) for camera in cameras]
    if is_wanted('rviz', _value(context, 'rviz')):
        _require('rviz2', 'rviz:=true')
        actions += [_rviz(camera) for camera in cameras]
    if has_dashboard:
        actions.append(_dashboard(cameras))
    return actions


def _make_params_file(camera):
    made = make_params_file(camera)
    if made:
        get_logger('camera_to_base').warning(made)


def _folder_of_this_launch():
    folder = tempfile.mkdtemp(prefix='camera_to_base_')
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _camera_actions(camera, playing, background_file, unknown):
    source, remappings = image_input(camera)
    # A node drops messages that are stamped in another frame.
    camera_frame = {'camera_frame_id': ParameterValue(frames(camera).camera, value_type=str)}
    actions = [
        _node(
            camera, 'camera_to_base', 'camera_publisher', remappings=remappings,
            on_exit=functools.partial(_end_with_recordings, camera, playing),
            parameters=[camera.params_file, {
                'source': ParameterValue(source, value_type=str),
                **camera_frame, **kept_background(camera, background_file), **unknown}]),
        _node(camera, 'camera_to_base', 'robot_base_publisher', on_exit=_end_without_start,
              parameters=[camera.params_file, camera_frame]),
    ]
    if camera.has_driver:
        _require(camera.camera_driver, f'camera_driver:={camera.camera_driver}')
        actions.append(_node(
            camera, camera.camera_driver, DRIVERS[camera.camera_driver], camera.camera_driver,
            parameters=[driver_parameters(camera)],
            additional_env=shared_memory_environment(LARGE_PICTURES, os.environ)))
    return actions


def _transform_publisher(camera):
    return _node(camera, 'tf2_ros', 'static_transform_publisher',
                 on_exit=_end_without_start, arguments=transform_arguments(camera))


def _node(camera, package, executable, name=None, **options):
    return Node(
        package=package, executable=executable, name=name or executable,
        namespace=camera.namespace, output='screen', respawn=True, respawn_delay=0.5, **options)


def _fusion(cameras):
    return Node(
        package='camera_to_base', executable='camera_fusion', name='camera_fusion',
        output='screen', respawn=True, respawn_delay=0.5, on_exit=_end_without_start,
        parameters=[fusion_parameters(cameras)])


def _rviz(camera):
    # Its topics are relative names, so that they follow the namespace. It has no name, because
    # each of its nodes would get it. It is not restarted when the user closes the window.
    return Node(
        package='rviz2', executable='rviz2', namespace=camera.namespace, output='screen',
        arguments=['-d', os.path.join(CONFIG, 'camera_to_base.rviz'),
                   '-f', frames(camera).base])


def _dashboard(cameras):
    # The file that is installed with the package is not one to write to.
    own = [camera.params_file for camera in cameras if camera.params_file != DEFAULT.params_file]
    files = '; '.join(f'/{camera.namespace.strip("/")}={camera.params_file}' for camera in cameras
                      if camera.params_file in own)
    return Node(
        package='camera_to_base', executable='dashboard', name='dashboard', output='screen',
        respawn=True, respawn_delay=0.5, on_exit=_end_without_start, parameters=[
            *own, {'params_file': own[0] if len(own) == 1 == len(cameras) else '',
                   'params_files': files}])


def _require(package, argument):
    try:
        get_package_prefix(package)
    except PackageNotFoundError:
        raise InvalidValueError(
            not_installed(package, argument, os.environ.get('ROS_DISTRO', 'jazzy'))) from None


def _value(context, name):
    return LaunchConfiguration(name).perform(context)


def _end_with_recordings(camera, playing, event, context):
    _end_without_start(event, context)
    failure = recording_failure(camera, event.returncode)
    if failure and not context.is_shutdown:
        raise CameraToBaseError(failure)
    # With other sources, 0 means that a signal ended the node: it is restarted.
    if event.returncode != 0 or not plays_recording(camera):
        return None
    playing.discard(camera)
    if playing:
        return EmitEvent(event=ShutdownProcess(process_matcher=matches_action(event.action)))
    return EmitEvent(event=Shutdown(reason='the recordings have ended'))


def _end_without_start(event, context):
    # Drivers are excluded: their exit code 1 may mean that the camera was unplugged.
    if event.returncode == 1 and not context.is_shutdown:
        raise CameraToBaseError(
            f'{event.action.node_name} cannot start, as it says itself: the launch ends')
