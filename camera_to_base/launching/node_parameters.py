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

"""The parameters that a node gets from a camera's parameter file."""

from typing import Any, Dict

from camera_to_base.launching.cameras import LaunchedCamera
from camera_to_base.parameters import (
    checked_values, ParameterSpec, read_node_parameters, TRANSFORM_SPECS, with_new_names)
from camera_to_base.settings import CAMERA_SPECS

_SPECS = {'camera_publisher': CAMERA_SPECS, 'robot_base_publisher': TRANSFORM_SPECS}


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
