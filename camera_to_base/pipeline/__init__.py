# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The pipeline: decides whether the positions of a frame may be published.

In: frames. Out: one sighting for each frame, with its objects, or with the reason why none of them
may be published. There are checks for damage, a moved view, objects that reach in from the edge,
jumps, age and another camera. Each is a stage (`stage`): it takes the frame's record and returns
it; `pipeline` lists them in order. A nudge of the camera is corrected: a `standpoint` is a place
of the camera, with the surface and the background that hold there. Markers on the surface tell
where a camera stands that was moved farther.

Callers: `nodes` and `commands`. It imports only numpy and OpenCV.
"""

from camera_to_base.pipeline.arms import ArmCheck
from camera_to_base.pipeline.damage import DamageCheck
from camera_to_base.pipeline.detection_stage import FrameUncertainty
from camera_to_base.pipeline.gate import PositionGate
from camera_to_base.pipeline.markers import MarkerSettings
from camera_to_base.pipeline.own_camera import OwnCamera
from camera_to_base.pipeline.pipeline import CameraPipeline
from camera_to_base.pipeline.place import SurfaceInForce
from camera_to_base.pipeline.sighting import LIMIT_SPECS, Limits, make_limits, Sighting
from camera_to_base.pipeline.stage import FrameRecord
from camera_to_base.pipeline.standpoint import Standpoint
from camera_to_base.pipeline.view.correction import Correction, kept_values
from camera_to_base.pipeline.view.view_check import View, ViewCheck
from camera_to_base.pipeline.view.view_watch import ViewWatch

__all__ = [
    'ArmCheck', 'CameraPipeline', 'Correction', 'DamageCheck', 'FrameRecord', 'FrameUncertainty',
    'kept_values', 'LIMIT_SPECS', 'Limits', 'make_limits', 'MarkerSettings', 'OwnCamera',
    'PositionGate', 'Sighting', 'Standpoint', 'SurfaceInForce', 'View', 'ViewCheck', 'ViewWatch',
]
