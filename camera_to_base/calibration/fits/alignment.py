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

"""The rotation and the displacement that take points to others, and a rotation's angles."""

from typing import Tuple

import numpy as np


def align(points: np.ndarray, targets: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """
    Find the proper rotation and the displacement that take points to targets.

    Both may lie in a plane: a plane seen from behind is a rotation by 180 degrees about an axis in
    the plane, not a reflection.

    :param points: Shape (n, 3), not on one line.
    :param targets: Shape (n, 3), in the same unit.
    :returns: Rotation, shape (3, 3), and displacement, shape (3,).
    """
    from scipy.spatial.transform import Rotation

    centre, target_centre = points.mean(axis=0), targets.mean(axis=0)
    rotation = Rotation.align_vectors(targets - target_centre, points - centre)[0].as_matrix()
    return rotation, target_centre - rotation @ centre


def rotation_deg(rotation: np.ndarray) -> Tuple[float, float, float]:
    """
    Write a rotation as Rz(yaw) Ry(pitch) Rx(roll).

    Not by scipy's `as_euler`: it prints a warning if pitch is a right angle, as with a camera
    frame on a wall.

    :param rotation: Shape (3, 3), proper.
    :returns: Roll, pitch and yaw in degrees, -180 < roll, yaw <= 180 and -90 <= pitch <= 90.
    """
    level = np.hypot(rotation[0, 0], rotation[1, 0])
    pitch = np.arctan2(-rotation[2, 0], level)
    if level > 1e-9:
        roll = np.arctan2(rotation[2, 1], rotation[2, 2])
        yaw = np.arctan2(rotation[1, 0], rotation[0, 0])
    else:  # Roll and yaw turn about the same axis: roll takes the whole angle.
        roll, yaw = np.arctan2(-rotation[1, 2], rotation[1, 1]), 0.0
    return tuple(_upper_half_open(np.degrees(angle)) for angle in (roll, pitch, yaw))


def _upper_half_open(degrees):
    """Round to 1e-9 degrees, so that -180 + 1e-14 becomes 180, and -0.0 becomes 0."""
    rounded = round(float(degrees), 9)
    return 180.0 if rounded == -180.0 else rounded + 0.0
