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

"""The position of one object at rest, from the frames that show it."""

from typing import NamedTuple, Sequence, Tuple

from camera_to_base.errors import CalibrationError
import numpy as np

# Frames for a position, and those of them that may show nothing: a reflection, a passing shadow.
FRAMES = 20
_MOST_WITHOUT = 5
# A coin at rest is located to 0.01 to 0.1 mm from frame to frame; a hand moves it by more.
LARGEST_SPREAD_CM = 0.1

_Points = Sequence[Tuple[float, float]]


class Place(NamedTuple):
    """
    Where an object rests.

    :param x: Mean over the frames, in cm, in the camera frame.
    :param y: The same.
    :param spread_cm: Root of the mean squared distance from the mean.
    :param frame_count: Number of frames.
    """

    x: float
    y: float
    spread_cm: float
    frame_count: int


def measured_place(frames: Sequence[_Points]) -> Place:
    """
    Take the mean of an object's positions.

    :param frames: For each frame the positions of all objects on it, x and y, in cm.
    :raises CalibrationError: If there is no object, there are several, or it moves.
    """
    with_object = [points for points in frames if points]
    if len(frames) - len(with_object) > _MOST_WITHOUT or not with_object:
        raise CalibrationError(
            f'{len(frames) - len(with_object)} of {len(frames)} frames show no object: put one '
            'into the picture, and take your hand and the robot out of it')
    most = max(len(points) for points in with_object)
    if most > 1:
        raise CalibrationError(
            f'{most} objects are in the picture: leave only one, and take your hand and the robot '
            'out of it')
    points = np.array([points[0] for points in with_object])
    mean = points.mean(axis=0)
    spread = float(np.sqrt(np.mean(np.sum((points - mean) ** 2, axis=1))))
    if spread > LARGEST_SPREAD_CM:
        raise CalibrationError(
            f'the object has moved: its positions spread by {10 * spread:.1f} mm, allowed are '
            f'{10 * LARGEST_SPREAD_CM:g} mm: leave it alone while it is measured')
    return Place(float(mean[0]), float(mean[1]), spread, len(points))
