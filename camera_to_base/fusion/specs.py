# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""The parameters of the node `camera_fusion`."""

from typing import List, NamedTuple, Tuple

from camera_to_base.errors import InvalidValueError
from camera_to_base.fusion.cell import FusionLimits
from camera_to_base.fusion.solver import KnownHeight
from camera_to_base.parameters import ParameterSpec, Values

_MOST_CAMERAS = 8

FUSION_SPECS: List[ParameterSpec] = [
    ParameterSpec('cameras', ['left', 'right'],
                  'Namespaces of the cameras to fuse; both nodes of each camera run there.',
                  lengths=tuple(range(2, _MOST_CAMERAS + 1)), constraints='each another one',
                  fixed=True),
    ParameterSpec('highest_object_cm', 10.0, 'No object is higher.', (0.1, 100.0), unit='cm'),
    ParameterSpec('one_camera_height_cm', [],
                  'The height of what one camera alone sees, and that was not measured before; '
                  'empty to leave it out.', (0.0, 100.0), unit='cm', lengths=(0, 1)),
    ParameterSpec('height_tolerance_cm', 0.1,
                  'Standard deviation of one_camera_height_cm.', (0.001, 100.0), unit='cm'),
    ParameterSpec('stamp_tolerance', 0.02,
                  'What moves is fused of frames that were taken within this time, and what rests '
                  'of any. Clocks that differ by more are reported.', (0.0, 10.0), unit='s'),
    ParameterSpec('max_silence', 0.5,
                  'A camera that gives nothing for longer is left out.', (0.05, 60.0), unit='s'),
]


class FusionSettings(NamedTuple):
    """
    The settings of `camera_fusion`.

    :param cameras: Namespaces, without a slash at the end.
    """

    cameras: Tuple[str, ...]
    limits: FusionLimits
    stamp_tolerance_s: float
    max_silence_s: float


def fusion_settings(values: Values) -> FusionSettings:
    """
    Make the settings from the parameters.

    :raises InvalidValueError: If a camera is named twice, or not at all.
    """
    cameras = tuple(name.rstrip('/') for name in values['cameras'])
    if len(set(cameras)) < len(cameras) or '' in cameras:
        raise InvalidValueError('parameter cameras must name the namespace of each camera once, '
                                f'such as [left, right], got {list(values["cameras"])}')
    height = values['one_camera_height_cm']
    known = KnownHeight(height[0], values['height_tolerance_cm']) if len(height) else None
    tolerance = values['stamp_tolerance']
    return FusionSettings(
        cameras, FusionLimits(values['highest_object_cm'], tolerance, known), tolerance,
        values['max_silence'])
