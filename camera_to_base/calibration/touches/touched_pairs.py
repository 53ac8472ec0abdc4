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

"""Pairs of points: objects that the camera has seen and the robot has touched."""

from typing import Any, Mapping, NamedTuple, Sequence, Tuple

from camera_to_base.calibration.base_calibration import calibrate_base
from camera_to_base.calibration.result import Calibration
from camera_to_base.calibration.touches.touch_plan import Suggestion
from camera_to_base.surface import PointPairs
import numpy as np


class TouchedPair(NamedTuple):
    """
    A place of the object in both frames.

    :param suggestion: Where it was to be put.
    :param camera_point: x and y, in cm, in the camera frame.
    :param base_point: x and y, in cm, in the base frame.
    """

    suggestion: Suggestion
    camera_point: Tuple[float, float]
    base_point: Tuple[float, float]


def point_pairs(pairs: Sequence[TouchedPair], rows: Sequence[int] = ()) -> PointPairs:
    """
    Return the points of pairs, which lie on the surface and on the table of the base frame.

    :param rows: What messages call the pairs; 1 to n by default.
    """
    camera = [(*pair.camera_point, 0.0) for pair in pairs]
    base = [(*pair.base_point, 0.0) for pair in pairs]
    return PointPairs(np.array(camera).reshape(-1, 3), np.array(base).reshape(-1, 3), tuple(rows))


def calibrate_touches(
    pairs: PointPairs, surface_values: Mapping[str, Any], base_z: str
) -> Calibration:
    """
    Fit the base frame to pairs, see :func:`calibrate_base`.

    :param surface_values: The parameters of the surface that the camera points were measured with.
    :param base_z: Direction of the base frame's z at the table: 'up' or 'down'.
    """
    return calibrate_base(
        pairs, source='objects that the robot touched', base_z=base_z,
        surface_values=surface_values, points_are='place')
