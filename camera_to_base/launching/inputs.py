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

"""Where a camera's node takes its frames from, and what that means for its process."""

import os
import signal
from typing import Any, Dict, List, NamedTuple, Tuple

from camera_to_base.launching.cameras import LaunchedCamera
from camera_to_base.launching.node_parameters import given_parameters, parameter, spec_of
from camera_to_base.sources import kind_of

# Both drivers publish under this relative name.
_DRIVER_TOPIC = 'image_raw'
# What a defect, in this package or in a library, ends a process with.
_CRASHES = (os.EX_SOFTWARE, *(-number for number in (
    signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL, signal.SIGSEGV)))


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
