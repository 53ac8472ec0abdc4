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

"""How uncertain a calibration is: the covariances that the nodes need."""

from typing import Sequence, Union

from camera_to_base.calibration.fits.rigid_fit import RigidFit
from camera_to_base.surface import (
    HomographySurface, ImageSize, MatchedPoints, PointPairs, PolynomialSurface)
from camera_to_base.uncertainty import (
    base_error, fit_error, FitError, scales_at, warp_design)
import numpy as np

# The usual error of a coordinate: corners are found by the command, points are clicked.
_EXPECTED_PX = {'corner': 0.15, 'row': 0.5}


def surface_error(
    surface: Union[HomographySurface, PolynomialSurface], matched: MatchedPoints,
    image_size: ImageSize, points_are: str, counts: Sequence[int] = (),
) -> FitError:
    """
    Estimate how uncertain a fitted surface is.

    :param surface: Fitted to the points.
    :param image_size: Width and height of the picture, in px.
    :param points_are: 'corner' or 'row', the report's word for a point.
    :param counts: How many of the points belong to each placement of a board, in order; the
        places of all but the first were fitted, too. Empty for one placement.
    """
    cm_per_px = scales_at(surface, matched.pixels)
    errors_cm = matched.points - surface.locate(matched.pixels)
    residuals = np.linalg.solve(cm_per_px, errors_cm[:, :, None])[:, :, 0]
    design = warp_design(matched.pixels, image_size, surface.distortion)
    motions = np.linalg.solve(cm_per_px, _motion_design(matched.points, counts))
    return fit_error(np.concatenate([design, motions], axis=2), residuals, matched.points,
                     expected_px=_EXPECTED_PX[points_are])


def transform_error(pairs: PointPairs, fit: RigidFit) -> np.ndarray:
    """Estimate the covariance of a fitted base transform, see `base_error`."""
    is_flat = not (pairs.camera_points[:, 2].any() or pairs.base_points[:, 2].any())
    return base_error(pairs.camera_points @ fit.rotation.T, fit.left_out_residuals, is_flat)


def _motion_design(points: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Return how the shift and the turn of each further placement move points, (n, 2, 3 m)."""
    design = np.zeros((len(points), 2, 3 * max(len(counts) - 1, 0)))
    starts = np.cumsum([0, *counts])
    for number, (start, end) in enumerate(zip(starts[1:-1], starts[2:])):
        offsets = points[start:end] - points[start:end].mean(axis=0)
        part = design[start:end, :, 3 * number:3 * number + 3]
        part[:, 0, 0] = part[:, 1, 1] = 1.0
        part[:, 0, 2], part[:, 1, 2] = -offsets[:, 1], offsets[:, 0]
    return design
