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
How uncertain a surface is that touched markers gave.

The lens, the places of the markers, the size of the print and the touches are uncertain together:
what each of them leaves open follows from the equations of the fit. The lens may differ from the
fitted one in more ways than the model has, see `uncertainty.picture_warp`.
"""

from camera_to_base.calibration.markers.touched_problem import (
    INSET_DEVIATION_PX, INSET_PX, SIZE_DEVIATION, TouchedFit)
from camera_to_base.markers import outward_moves
from camera_to_base.uncertainty import (
    HOMOGRAPHY_NUMBERS, Lens, LENS_DEVIATIONS, scales_at, warp_design, WARP_NUMBERS)
import numpy as np

_FIRST_PLACE = WARP_NUMBERS + 2


def touched_error(fit: TouchedFit, touches: np.ndarray) -> np.ndarray:
    """
    Return the covariance of the picture's warp, for positions in the base frame.

    :param touches: Shape (n, 2), in cm.
    :returns: Shape (14, 14), see `uncertainty.picture_warp`.
    """
    lens, image_size = fit.surface.distortion, fit.surface.image_size
    count = len(touches)
    columns = _FIRST_PLACE + 3 * count
    corners = np.zeros((4 * count, 2, columns))
    corners[:, :, :WARP_NUMBERS] = -warp_design(
        fit.pixels, image_size, Lens(lens.coefficient, tuple(lens.centre)))
    corners[:, :, WARP_NUMBERS] = -outward_moves(fit.pixels)
    corners[:, :, WARP_NUMBERS + 1:] = np.linalg.solve(
        scales_at(fit.surface, fit.pixels), _point_moves(fit))
    touched = np.zeros((count, 2, columns))
    for number in range(count):
        first = _FIRST_PLACE + 3 * number
        touched[number, :, first:first + 2] = np.eye(2)
    radius = np.hypot(*image_size) / 2
    offset = (np.array(lens.centre) - (np.array(image_size) - 1) / 2) / radius
    # The lens, the inset and the size lie next to each other.
    deviations = np.array([*LENS_DEVIATIONS, INSET_DEVIATION_PX, SIZE_DEVIATION])
    expected = np.zeros((len(deviations), columns))
    expected[:, HOMOGRAPHY_NUMBERS:_FIRST_PLACE] = np.diag(1 / deviations)
    differs = np.array([lens.coefficient, *offset, 0, 0, 0, fit.inset_px - INSET_PX,
                        fit.size - 1]) / deviations
    design = np.concatenate([corners.reshape(-1, columns) / fit.corner_px,
                             touched.reshape(-1, columns) / fit.touch_cm, expected])
    residuals = np.concatenate([fit.residuals_px.ravel() / fit.corner_px,
                                (fit.places[:, :2] - touches).ravel() / fit.touch_cm,
                                differs])
    inverse = np.linalg.pinv(design.T @ design, hermitian=True)
    # What the residuals tell of the lens beyond the fitted model: the fit is off by as much.
    missed = (inverse @ (design.T @ residuals))[:WARP_NUMBERS]
    return inverse[:WARP_NUMBERS, :WARP_NUMBERS] + np.outer(missed, missed)


def _point_moves(fit: TouchedFit) -> np.ndarray:
    """Return how the size, and each marker's place and turn, move corners: (4 n, 2, 1 + 3 n)."""
    count = len(fit.places)
    arms = fit.points.reshape(count, 4, 2) - fit.places[:, None, :2]
    moves = np.zeros((count, 4, 2, 1 + 3 * count))
    moves[:, :, :, 0] = arms
    for number in range(count):
        first = 1 + 3 * number
        moves[number, :, :, first:first + 2] = np.eye(2)
        moves[number, :, 0, first + 2] = -arms[number, :, 1]
        moves[number, :, 1, first + 2] = arms[number, :, 0]
    return moves.reshape(4 * count, 2, 1 + 3 * count)
