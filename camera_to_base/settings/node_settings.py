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

"""Reads both nodes' settings from a parameter file, without ROS."""

from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import (
    all_names, checked_values, file_warnings, name_warnings, node_namespaces, read_node_parameters,
    read_sections, transform_node_settings, TRANSFORM_SPECS, TransformSettings, with_new_names)
from camera_to_base.settings.camera import camera_settings, CameraSettings
from camera_to_base.settings.camera_specs import CAMERA_SPECS

_CAMERA_NODE, _TRANSFORM_NODE = 'camera_publisher', 'robot_base_publisher'
_SPECS = {_CAMERA_NODE: CAMERA_SPECS, _TRANSFORM_NODE: TRANSFORM_SPECS}


class NodeSettings(NamedTuple):
    """
    The settings of both nodes.

    :param warnings: Sentences about names that no parameter has.
    """

    camera: CameraSettings
    transform: TransformSettings
    warnings: List[str]


def read_node_settings(path: Optional[str], namespace: Optional[str] = None) -> NodeSettings:
    """
    Read the settings that both nodes would have with a parameter file.

    :param path: The file; None for the defaults.
    :param namespace: The nodes' namespace; None for the one that the file names, if any.
    :raises CameraToBaseError: If there is no such file, or a value cannot be used.
    """
    values, warnings = {}, []
    for node, specs in _SPECS.items():
        given, told = _given(path, namespace, node) if path is not None else ({}, [])
        values[node] = checked_values(specs, given)
        warnings += [warning for warning in told if warning not in warnings]
    return NodeSettings(camera_settings(values[_CAMERA_NODE]),
                        transform_node_settings(values[_TRANSFORM_NODE]), warnings)


def _given(path: str, namespace: Optional[str], node: str) -> Tuple[Dict[str, Any], List[str]]:
    name = f'{_namespace(path, namespace)}/{node}'
    given, old_names = with_new_names(_SPECS[node], read_node_parameters(path, name))
    known = [name for specs in _SPECS.values() for name in all_names(specs)]
    return given, [*file_warnings(path, name), *old_names, *name_warnings(given, known)]


def _namespace(path: str, wanted: Optional[str]) -> str:
    found = node_namespaces(path, _SPECS)
    if wanted is not None:
        name = f'/{wanted.strip("/")}'.rstrip('/')
        if not any(section.stands_for(f'{name}/{node}')
                   for section in read_sections(path) for node in _SPECS):
            raise InvalidValueError(
                f"'{path}' has no parameters for nodes in the namespace '{wanted}', but for those "
                f'in {", ".join(name or "/" for name in found) or "none"}: choose one of these')
        return name
    if len(found) > 1:
        raise InvalidValueError(
            f"'{path}' has parameters for nodes in several namespaces: choose one with "
            f'--namespace: {", ".join(name or "/" for name in found)}')
    return found[0] if found else ''
