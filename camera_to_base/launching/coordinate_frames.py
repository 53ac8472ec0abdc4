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

"""The coordinate frames of the cameras, and the transform between those of each camera."""

import math
from typing import Dict, List, NamedTuple

from camera_to_base.errors import InvalidValueError
from camera_to_base.launching.cameras import LaunchedCamera
from camera_to_base.launching.node_parameters import given_parameters, parameter


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
