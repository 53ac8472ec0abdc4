# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Fusion: what two cameras or more see of the same objects.

In: silhouettes on the surface in the base frame, with their covariances, and where each camera is.
Out: each object's height, footprint, place and their uncertainty, and what does not fit together.

Callers: see the arrows in CONTRIBUTING. It imports numpy alone: the node `camera_fusion` starts
without OpenCV.
"""

from camera_to_base.fusion.cell import (
    FusedCell, FusedObject, FusedSighting, FusionLimits, NotFused)
from camera_to_base.fusion.frames import CameraFrame, ClockCheck, ClockError
from camera_to_base.fusion.matching import Group, match, Matches, Member
from camera_to_base.fusion.shape import Extent, Moments
from camera_to_base.fusion.solver import (
    KnownHeight, OUTLINE_PX, SeenOutline, Solution, solve, Viewpoint)
from camera_to_base.fusion.specs import fusion_settings, FUSION_SPECS, FusionSettings

__all__ = [
    'CameraFrame', 'ClockCheck', 'ClockError', 'Extent', 'FusedCell', 'FusedObject',
    'FusedSighting', 'FusionLimits', 'fusion_settings', 'FUSION_SPECS', 'FusionSettings', 'Group',
    'KnownHeight', 'match', 'Matches', 'Member', 'Moments', 'NotFused', 'OUTLINE_PX',
    'SeenOutline', 'Solution', 'solve', 'Viewpoint',
]
