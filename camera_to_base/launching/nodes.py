# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What a launch starts: parameters, remappings and command lines, and warnings of arguments."""

import math
import os
import signal
from typing import Any, Collection, Dict, Iterable, List, NamedTuple, Tuple

from camera_to_base.errors import InvalidValueError
from camera_to_base.launching.cameras import LaunchedCamera
from camera_to_base.parameters import (
    checked_values, misspelt_name, ParameterSpec, read_node_parameters, TRANSFORM_SPECS,
    unknown_name_text, with_new_names)
from camera_to_base.settings import CAMERA_SPECS
from camera_to_base.sources import kind_of

# Arguments that launch and launch_ros use themselves.
_OF_LAUNCH = {'emulate_tty', 'launch-prefix', 'launch-prefix-filter', 'ros_namespace'}

_SPECS = {'camera_publisher': CAMERA_SPECS, 'robot_base_publisher': TRANSFORM_SPECS}

# Both drivers publish under this relative name.
_DRIVER_TOPIC = 'image_raw'
# What a defect, in this package or in a library, ends a process with.
_CRASHES = (os.EX_SOFTWARE, *(-number for number in (
    signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL, signal.SIGSEGV)))


def unknown_arguments(
        given: Iterable[str], known: Collection[str], ours_alone: bool) -> List[str]:
    """
    List unknown arguments, which launch ignores: a default would be used instead.

    :param given: The names of all arguments of the launch.
    :param known: The names of ours.
    :param ours_alone: Whether all arguments are meant for this launch file; otherwise only names
        that look misspelt are listed.
    """
    unknown = (name for name in given if name not in {*known, *_OF_LAUNCH})
    return [name for name in unknown if ours_alone or misspelt_name(name, known)]


def argument_warnings(
        given: Iterable[str], known: Collection[str], ours_alone: bool) -> List[str]:
    """Warn of unknown arguments, see `unknown_arguments`."""
    return [unknown_name_text(name, misspelt_name(name, known), 'launch argument')
            for name in unknown_arguments(given, known, ours_alone)]


def is_wanted(name: str, value: str) -> bool:
    """
    Read a launch argument that is true or false.

    :raises InvalidValueError: If it is neither.
    """
    if value.lower() not in ('true', 'false'):
        raise InvalidValueError(f"{name} must be true or false, got '{value}'")
    return value.lower() == 'true'


def not_installed(package: str, argument: str, distribution: str) -> str:
    """
    Say that a package is missing, and what to do.

    :param argument: The launch argument that asks for it, as it was written.
    :param distribution: The ROS distribution, 'jazzy'.
    """
    return (f'{argument} needs the package {package}, which is not installed: '
            f"sudo apt install ros-{distribution}-{package.replace('_', '-')}")


def spec_of(node: str, name: str) -> ParameterSpec:
    """Return what a parameter of a node is."""
    return next(spec for spec in _SPECS[node] if spec.name == name)


def parameter(camera: LaunchedCamera, node: str, name: str) -> Any:
    """
    Return a parameter's value: the file's, or its default.

    :param node: The name of the node's executable.
    :raises InvalidValueError: If the file cannot be read, or the value is not allowed.
    """
    return checked_values([spec_of(node, name)], given_parameters(camera, node))[name]


def given_parameters(camera: LaunchedCamera, node: str) -> Dict[str, Any]:
    """
    Return the parameters that the file gives to a node.

    :raises InvalidValueError: If the file cannot be read.
    """
    namespace = f'/{camera.namespace}' if camera.namespace else ''
    given = read_node_parameters(camera.params_file, f'{namespace}/{node}')
    return with_new_names(_SPECS[node], given)[0]


class Frames(NamedTuple):
    """The names of the two coordinate frames of a camera."""

    base: str
    camera: str


def frames(camera: LaunchedCamera) -> Frames:
    """
    Return the names of a camera's coordinate frames.

    Cameras in different namespaces share one tf tree. If the file does not name the camera frame,
    its name gets the namespace as a prefix.

    :raises InvalidValueError: If the parameter file cannot be read.
    """
    own = parameter(camera, 'camera_publisher', 'camera_frame_id')
    if camera.namespace and 'camera_frame_id' not in given_parameters(camera, 'camera_publisher'):
        own = f'{camera.namespace}/{own}'
    return Frames(parameter(camera, 'robot_base_publisher', 'base_frame_id'), own)


def check_frames(cameras: List[LaunchedCamera]) -> None:
    """
    Check that the frame names of all cameras differ.

    :raises InvalidValueError: If two frames have the same name.
    """
    seen: Dict[str, LaunchedCamera] = {}
    for camera in cameras:
        base, own = frames(camera)
        if own == base:
            raise InvalidValueError(
                f"camera_frame_id and base_frame_id are both '{own}': give them different names")
        if own in seen:
            raise InvalidValueError(
                f"the cameras in '{seen[own].namespace}' and '{camera.namespace}' both have the "
                f"camera_frame_id '{own}': give each its own in its params_file")
        seen[own] = camera


def transform_arguments(camera: LaunchedCamera) -> List[str]:
    """
    Make the command line of tf2_ros's static_transform_publisher.

    It turns about the fixed axes x, y and z, as `rotation_deg` does; it takes rad and m.

    :raises InvalidValueError: If the parameter file cannot be read, or has no such transform.
    """
    x, y, z = (length / 100 for length in parameter(
        camera, 'robot_base_publisher', 'displacement_cm'))
    roll, pitch, yaw = map(math.radians, parameter(
        camera, 'robot_base_publisher', 'rotation_deg'))
    base, own = frames(camera)
    return [
        '--x', f'{x:.12g}', '--y', f'{y:.12g}', '--z', f'{z:.12g}',
        '--roll', f'{roll:.12g}', '--pitch', f'{pitch:.12g}', '--yaw', f'{yaw:.12g}',
        '--frame-id', base, '--child-frame-id', own]


class ImageInput(NamedTuple):
    """
    Where the camera node takes frames from.

    :param source: Its parameter.
    :param remappings: The topic that it subscribes to, and the one that it is to listen to.
    """

    source: str
    remappings: List[Tuple[str, str]]


def image_input(camera: LaunchedCamera) -> ImageInput:
    """
    Return where the camera node takes frames from: an image topic, or its own source.

    Without a launch argument, the source of the parameter file is used.

    :raises InvalidValueError: If the parameter file cannot be read.
    """
    topic = camera.image_topic or (_DRIVER_TOPIC if camera.has_driver else '')
    if not topic:
        in_file = parameter(camera, 'camera_publisher', 'source')
        named = camera.source != spec_of('camera_publisher', 'source').default
        return ImageInput(camera.source if named else in_file, [])
    if topic.endswith('/compressed'):
        return ImageInput('compressed_topic', [('image/compressed', topic)])
    return ImageInput('topic', [('image', topic)])


def fusion_parameters(cameras: List[LaunchedCamera]) -> Dict[str, Any]:
    """
    Make the parameters of the node that fuses what cameras see.

    :raises InvalidValueError: If a file cannot be read, or does not tell which camera is meant.
    """
    for camera in cameras:
        if image_input(camera).source == spec_of('camera_publisher', 'source').default:
            raise InvalidValueError(
                f"'{camera.params_file}' does not name its source: with two cameras each file "
                'must, such as source: /dev/video2')
    return {'cameras': [f'/{camera.namespace}' for camera in cameras]}


def plays_recording(camera: LaunchedCamera) -> bool:
    """
    Tell whether a camera node ends by itself, with its source.

    :raises InvalidValueError: If the parameter file cannot be read.
    """
    return kind_of(image_input(camera).source).ends


def recording_failure(camera: LaunchedCamera, exit_code: int) -> str:
    """
    Tell why a camera node that died is not started again: its recording would kill it again.

    :param exit_code: Negative after a signal.
    :returns: '' for a node that is started again.
    """
    if exit_code not in _CRASHES or not plays_recording(camera):
        return ''
    cause = f'signal {-exit_code}' if exit_code < 0 else f'exit code {exit_code}'
    return (f"camera_publisher has died ({cause}) while it played '{image_input(camera).source}'"
            ': the launch ends')


def kept_background(camera: LaunchedCamera, path: str) -> Dict[str, str]:
    """
    Make the parameter with which a restarted camera node keeps its background.

    :param path: A .png file for this camera and this launch.
    :returns: Empty where the parameter file names a file, or no camera gives the frames.
    :raises InvalidValueError: If the parameter file cannot be read.
    """
    is_live = kind_of(image_input(camera).source).is_live
    named = 'background_file' in given_parameters(camera, 'camera_publisher')
    return {'background_file': path} if is_live and not named else {}


def driver_parameters(camera: LaunchedCamera) -> Dict[str, Any]:
    """
    Make a driver's parameters: its device, and the picture size of the calibration.

    :raises InvalidValueError: If the parameter file cannot be read, or has no proper size.
    """
    width, height = parameter(camera, 'camera_publisher', 'surface.image_size')
    if camera.camera_driver == 'usb_cam':
        return {'video_device': camera.device, 'image_width': width, 'image_height': height}
    return {'video_device': camera.device, 'image_size': [width, height]}
