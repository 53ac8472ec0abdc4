# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
What the launch file asks: which cameras to start, and with which arguments.

In: launch arguments, and the parameter file that they name. Out: parameters, remappings, command
lines and environment of the processes to start, and warnings of arguments that do not exist.

Caller: `launch/camera_to_base.launch.py`.
"""

import math
import os
import re
import signal
from typing import Any, Collection, Dict, Iterable, List, NamedTuple, Tuple

from camera_to_base.errors import InvalidValueError
from camera_to_base.files import check_folder, write_files
from camera_to_base.parameters import (
    checked_values, load_yaml, misspelt_name, parameter_text, ParameterSpec, read_node_parameters,
    TRANSFORM_SPECS, unknown_name_text, with_new_names)
from camera_to_base.settings import CAMERA_SPECS
from camera_to_base.sources import kind_of

# Arguments that launch and launch_ros use themselves.
_OF_LAUNCH = {'emulate_tty', 'launch-prefix', 'launch-prefix-filter', 'ros_namespace'}

# Packages of drivers, and their executables.
DRIVERS = {'usb_cam': 'usb_cam_node_exe', 'v4l2_camera': 'v4l2_camera_node'}

_NAME = re.compile(r'/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*', re.ASCII)

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


class LaunchedCamera(NamedTuple):
    """
    One camera: its nodes share a namespace and a parameter file.

    :param params_file: Path of the parameter file.
    :param source: The camera node's parameter `source`; with a driver, the driver's device.
    :param namespace: Namespace of nodes and topics; empty for the root.
    :param image_topic: The topic that frames come from, or empty.
    :param camera_driver: The driver that is started, or 'none'.
    """

    params_file: str
    source: str = 'auto'
    namespace: str = ''
    image_topic: str = ''
    camera_driver: str = 'none'

    @property
    def has_driver(self) -> bool:
        """Tell whether a driver is to be started."""
        return self.camera_driver != 'none'

    @property
    def device(self) -> str:
        """Path of the device that a driver opens; by default the first one."""
        if self.source == 'auto':
            return '/dev/video0'
        return f'/dev/video{self.source}' if self.source.isdigit() else self.source


def make_params_file(camera: LaunchedCamera) -> str:
    """
    Make the parameter file of a camera, if it does not exist, for the dashboard to save to.

    It names the source; all other parameters have their defaults.

    :returns: A sentence that says so; '' if the file exists.
    :raises InvalidValueError: If it cannot be written.
    """
    path = camera.params_file
    if os.path.lexists(path):
        return ''
    check_folder(path, 'the parameter file')
    write_files({path: parameter_text({'source': camera.source}, []).encode()})
    return f"params_file '{path}' is new: the dashboard saves the calibration to it"


def choose_cameras(
    list_file: str, camera: LaunchedCamera, default: LaunchedCamera
) -> List[LaunchedCamera]:
    """
    Choose the cameras of a launch.

    :param list_file: Path of a list of cameras, or empty.
    :param camera: The camera that the other launch arguments describe.
    :param default: The same with all arguments left at their defaults.
    :raises InvalidValueError: If a camera cannot be started as it is described.
    """
    if not list_file:
        return [_checked(camera)]
    for name, value in camera._asdict().items():
        if value != getattr(default, name):
            raise InvalidValueError(
                f"{name} belongs into '{list_file}', for each camera: leave out {name}:={value}")
    return read_cameras(list_file)


def read_cameras(path: str) -> List[LaunchedCamera]:
    """
    Read a list of cameras.

    :raises InvalidValueError: If the file cannot be read, or a camera of it cannot be started.
    """
    entries = load_yaml(path, 'list of cameras')[1]
    if not isinstance(entries, list) or not entries:
        raise InvalidValueError(
            f"'{path}' is no list of cameras: it must hold '- namespace: ...' for each of them")
    cameras = []
    for number, entry in enumerate(entries, start=1):
        try:
            cameras.append(_checked(_from_entry(entry, os.path.dirname(path))))
        except InvalidValueError as error:
            raise InvalidValueError(f"camera {number} in '{path}': {error}") from error
    _refuse_repeated([camera.namespace for camera in cameras], path)
    return cameras


def _from_entry(entry: Any, directory: str) -> LaunchedCamera:
    if not isinstance(entry, dict):
        raise InvalidValueError(f"expected 'namespace: ...' and so on, got {entry!r}")
    for name, value in entry.items():
        if name not in LaunchedCamera._fields:
            raise InvalidValueError(
                f"there is no '{name}', only {', '.join(LaunchedCamera._fields)}")
        if type(value) not in (str, int) or value == '':
            raise InvalidValueError(f'{name} must be a text, got {value!r}')
    for name in ('namespace', 'params_file'):
        if name not in entry:
            raise InvalidValueError(f'{name} is missing')
    if not {'source', 'image_topic'} & set(entry):
        raise InvalidValueError('it needs a source or an image_topic of its own')
    camera = LaunchedCamera(**{name: str(value) for name, value in entry.items()})
    return camera._replace(params_file=os.path.join(directory, camera.params_file))


def _checked(camera: LaunchedCamera) -> LaunchedCamera:
    if not os.path.isfile(camera.params_file):
        raise InvalidValueError(
            f"params_file: there is no file '{camera.params_file}': make it with ros2 run "
            f'camera_to_base calibrate board --camera 0 -o {camera.params_file}')
    camera = camera._replace(namespace=camera.namespace.strip('/'))
    for name in ('namespace', 'image_topic'):
        value = getattr(camera, name)
        if value and not _NAME.fullmatch(value):
            raise InvalidValueError(
                f"{name} must be made of letters, digits, '_' and '/', and no part of it may "
                f'start with a digit, got {value!r}')
    if camera.has_driver:
        _check_driver(camera)
    elif camera.image_topic and camera.source != 'auto':
        raise InvalidValueError(
            f"frames come from the image_topic '{camera.image_topic}' or from the source "
            f"'{camera.source}': leave out one of them")
    return camera


def _check_driver(camera: LaunchedCamera) -> None:
    if camera.camera_driver not in DRIVERS:
        raise InvalidValueError(
            f"camera_driver must be {', '.join(DRIVERS)} or none, got '{camera.camera_driver}'")
    if not camera.device.startswith('/dev/'):
        raise InvalidValueError(
            f"{camera.camera_driver} opens a device, and the source '{camera.source}' is none: "
            'use a number or a path such as /dev/video0')


def _refuse_repeated(namespaces: List[str], path: str) -> None:
    for namespace in namespaces:
        if namespaces.count(namespace) > 1:
            raise InvalidValueError(
                f"two cameras in '{path}' have the namespace '{namespace}': give each its own")


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
