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

"""The objects of a frame as JSON."""

import math
from typing import Any, Dict, List, Optional, Sequence, Tuple

from camera_to_base.coordinate_transform import Pose
from camera_to_base.dashboard.live.frames import SeenFrame
from camera_to_base.dashboard.live.geometry import Geometry
from camera_to_base.ros import UncertainPose
from camera_to_base.uncertainty import error_ellipse
import numpy as np

_SHARE = 0.95
_MM_PER_CM = 10.0
# A base position belongs to a camera position that is transformed to this close to it.
_SAME_CM = 0.05
_DIGITS = 4


def objects_data(frame: SeenFrame, geometry: Optional[Geometry]) -> List[Dict[str, Any]]:
    """Describe the objects of a frame, the largest first; the ellipses contain 95 % of errors."""
    camera_poses = frame.camera or []
    bases = _bases(camera_poses, frame.base or [], geometry)
    pixels = _pixels([pose[:2] for pose in camera_poses], geometry)
    return [{
        'number': number + 1, 'pixel': pixels[number], 'camera': _flat(pose),
        'base': None if bases[number] is None else _in_space(bases[number], pose),
        'ellipse': _ellipse(number, pose, bases[number], frame),
    } for number, pose in enumerate(camera_poses)]


def left_out_data(frame: SeenFrame, geometry: Optional[Geometry]) -> List[Dict[str, Any]]:
    """Describe what was left out of a frame."""
    pixels = _pixels([(one.x, one.y) for one in frame.left_out], geometry)
    return [{'reason': one.kind, 'sentence': one.sentence, 'x': round(one.x, _DIGITS),
             'y': round(one.y, _DIGITS), 'pixel': pixel}
            for one, pixel in zip(frame.left_out, pixels)]


def _bases(
    camera_poses: Sequence[Pose], base_poses: Sequence[Pose], geometry: Optional[Geometry]
) -> List[Optional[Pose]]:
    # Positions beyond the reach are dropped, so the numbers of the two lists may differ.
    if len(camera_poses) == len(base_poses):
        return list(base_poses)
    if geometry is None or geometry.transform is None:
        return [None] * len(camera_poses)
    convert = geometry.transform.conversion.convert_point
    return [next((base for base in base_poses
                  if math.dist(base[:2], convert(*pose[:3])[:2]) < _SAME_CM), None)
            for pose in camera_poses]


def _ellipse(
    number: int, camera: Pose, base: Optional[Pose], frame: SeenFrame
) -> Optional[Dict[str, Any]]:
    if base is not None and frame.base_ellipses:
        return _ellipse_at(base, frame.base_ellipses, 'base')
    return _ellipse_at(camera, frame.camera_ellipses, 'camera')


def _ellipse_at(
    pose: Pose, ellipses: Sequence[UncertainPose], name: str
) -> Optional[Dict[str, Any]]:
    found = next((one for one in ellipses if math.dist(one.pose[:2], pose[:2]) < _SAME_CM), None)
    if found is None:
        return None
    ellipse = error_ellipse(found.covariance, _SHARE)
    return {'major_mm': round(_MM_PER_CM * ellipse.long, 3),
            'minor_mm': round(_MM_PER_CM * ellipse.short, 3),
            'angle_deg': round(math.degrees(ellipse.angle), 1), 'frame': name}


def _pixels(
    points: Sequence[Tuple[float, float]], geometry: Optional[Geometry]
) -> List[Optional[List[float]]]:
    if geometry is None or not points:
        return [None] * len(points)
    return [None if pixel is None else np.round(pixel, 1).tolist()
            for pixel in geometry.pixels(points)]


def _flat(pose: Pose) -> Dict[str, Any]:
    # An object without a direction has the identity's.
    yaw = None if pose.yaw == 0.0 else round(math.degrees(pose.yaw), 2)
    return {'x': round(pose.x, _DIGITS), 'y': round(pose.y, _DIGITS), 'yaw_deg': yaw}


def _in_space(base: Pose, camera: Pose) -> Dict[str, Any]:
    yaw = None if camera.yaw == 0.0 else round(math.degrees(base.yaw), 2)
    return {'x': round(base.x, _DIGITS), 'y': round(base.y, _DIGITS), 'yaw_deg': yaw}
