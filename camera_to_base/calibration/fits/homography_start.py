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

"""Start values of the homography fit, in closed form."""

from typing import List, Sequence, Tuple

from camera_to_base.calibration.fits.motion import moved, plane_motion
from camera_to_base.errors import CalibrationError
from camera_to_base.surface import homogeneous
import cv2
import numpy as np

OPEN = ('the points do not determine the surface, too many of them lie on one line: spread them '
        'over the picture')

# The homography from the first placement is poor far from it. In each round, homography and
# motions are computed from each other, with all points.
_ROUNDS = 5


def start_values(
    points: np.ndarray, pixels: np.ndarray, members: Sequence[np.ndarray]
) -> Tuple[np.ndarray, List[np.ndarray]]:
    """
    Compute a homography, and the motion of each further placement.

    :param points: Shape (n, 2), each in the coordinates of its placement.
    :param pixels: Shape (n, 2), without distortion.
    :param members: For each placement which of the points are its own, shape (n,).
    :returns: From the camera frame to pixels, shape (3, 3), and a motion each, see `moved`.
    :raises CalibrationError: If the points do not determine them.
    """
    homography = _direct(points[members[0]], pixels[members[0]])
    motions: List[np.ndarray] = []
    for _ in range(_ROUNDS if len(members) > 1 else 0):
        shown = homogeneous(np.linalg.inv(homography), pixels)
        shown = shown[:, :2] / shown[:, 2:]
        motions = [plane_motion(points[own], shown[own]) for own in members[1:]]
        placed = points.copy()
        for own, motion in zip(members[1:], motions):
            placed[own] = moved(points[own], motion)
        homography = _direct(placed, pixels)
        homography /= homography[2, 2]
    return homography, motions


def _direct(points: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    homography, _ = cv2.findHomography(points, pixels)
    if homography is None or not np.isfinite(homography).all():
        raise CalibrationError(OPEN)
    return homography
