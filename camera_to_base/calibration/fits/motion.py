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

"""Motions of a board on the surface: a turn and a shift."""

import numpy as np


def moved(points: np.ndarray, motion: np.ndarray) -> np.ndarray:
    """
    Turn points about the origin, and shift them.

    :param points: Shape (n, 2).
    :param motion: The angle from x towards y in rad, and the shift in x and y; complex numbers
        are allowed, for derivatives.
    :returns: Shape (n, 2).
    """
    cos, sin = np.cos(motion[0]), np.sin(motion[0])
    return points @ np.array([[cos, sin], [-sin, cos]]) + motion[1:]


def plane_motion(points: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """
    Find the motion that takes points to targets, by least squares.

    :param points: Shape (n, 2).
    :param targets: Shape (n, 2).
    :returns: Angle and shift, shape (3,), see :func:`moved`.
    """
    centre, target_centre = points.mean(axis=0), targets.mean(axis=0)
    product = (points - centre).T @ (targets - target_centre)
    angle = np.arctan2(product[0, 1] - product[1, 0], product[0, 0] + product[1, 1])
    turned = moved(centre[None], np.array([angle, 0.0, 0.0]))[0]
    return np.array([angle, *(target_centre - turned)])
