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

"""
Settings of the nodes: their parameters as frozen values.

In: parameter values by name. Out: the parameter list of `camera_publisher`, the settings of both
nodes, and the source that a name stands for. The parameters of each part are in its own room.

Callers: `nodes`, `commands`, `launching` and the tools that write documentation.
"""

from camera_to_base.settings.camera import CalibratedFor, camera_settings, CameraSettings
from camera_to_base.settings.camera_specs import CAMERA_SPECS
from camera_to_base.settings.named_source import NamedSource, open_named_source
from camera_to_base.settings.node_settings import NodeSettings, read_node_settings

__all__ = [
    'CalibratedFor', 'camera_settings', 'CAMERA_SPECS', 'CameraSettings', 'NamedSource',
    'NodeSettings', 'open_named_source', 'read_node_settings',
]
