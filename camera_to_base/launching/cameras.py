# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""The cameras of a launch: as its arguments describe them, or a list of cameras, or a pair."""

import os
import re
from typing import Any, List, NamedTuple

from camera_to_base.errors import InvalidValueError
from camera_to_base.files import check_folder, write_files
from camera_to_base.parameters import load_yaml, parameter_text

# Packages of drivers, and their executables.
DRIVERS = {'usb_cam': 'usb_cam_node_exe', 'v4l2_camera': 'v4l2_camera_node'}

_NAME = re.compile(r'/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*', re.ASCII)
_BETWEEN = ','


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

    :param list_file: Path of a list of cameras, or parameter files with , between them, one for
        each camera that is fused, or empty.
    :param camera: The camera that the other launch arguments describe.
    :param default: The same with all arguments left at their defaults.
    :raises InvalidValueError: If a camera cannot be started as it is described.
    """
    if not list_file:
        return [_checked(camera)]
    if is_fused(list_file):
        return _fused_cameras(list_file, camera, default)
    for name, value in camera._asdict().items():
        if value != getattr(default, name):
            raise InvalidValueError(
                f"{name} belongs into '{list_file}', for each camera: leave out {name}:={value}")
    return read_cameras(list_file)


def is_fused(list_file: str) -> bool:
    """Tell whether what the cameras of a launch see is fused."""
    return _BETWEEN in list_file


def _fused_cameras(
    files: str, camera: LaunchedCamera, default: LaunchedCamera
) -> List[LaunchedCamera]:
    """Give each parameter file a camera, in a namespace of the file's name."""
    for name, value in camera._replace(source=default.source)._asdict().items():
        if value != getattr(default, name):
            raise InvalidValueError(
                f'{name} is one for all cameras: leave out {name}:={value}, each camera has the '
                'namespace of its parameter file')
    cameras = []
    for path in filter(None, map(str.strip, files.split(_BETWEEN))):
        stem = os.path.splitext(os.path.basename(path))[0]
        cameras.append(_checked(LaunchedCamera(path, camera.source, stem)))
    if len(cameras) < 2:
        raise InvalidValueError(f'cameras:={files}: what one camera sees cannot be fused, name '
                                'two parameter files')
    _refuse_repeated([one.namespace for one in cameras], files)
    return cameras


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
