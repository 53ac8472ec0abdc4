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

"""A measured nudge as what it does to positions, and the surface that follows from it."""

from typing import NamedTuple

from camera_to_base.errors import HorizonError
from camera_to_base.image_size import ImageSize
from camera_to_base.reason import Level, Reason
from camera_to_base.surface import NudgedSurface, Surface
from camera_to_base.trust.correction.nudge_meter import Nudge
from camera_to_base.trust.surface_in_force import SurfaceInForce
from camera_to_base.uncertainty import (
    radius_for, scales_at, warp_design, WARP_NUMBERS)
import numpy as np

# The error is that of an ellipse with so many of all errors, at the worst of these places.
_SHARE, _PLACES = 0.99, (7, 5)
_MM_PER_CM = 10.0


class Correction(NamedTuple):
    """
    What a nudge does to positions.

    :param nudge: As it was measured.
    :param shift_px: How far the picture's centre or a corner has moved, the farthest of them.
    :param shift_mm: How far positions would be off without the correction, at worst.
    :param error_mm: Which error of the correction one of a hundred positions exceeds, where it is
        the largest.
    :param deviation_px: Standard deviation of the correction, where it is the largest.
    """

    nudge: Nudge
    shift_px: float
    shift_mm: float
    error_mm: float
    deviation_px: float

    @property
    def reason(self) -> Reason:
        """Tell that positions are corrected."""
        return Reason('view_corrected', Level.WARN, (
            f'the camera was nudged by {self.shift_px:.1f} px ({self.shift_mm:.1f} mm): positions '
            f'are corrected, to about {max(self.error_mm, 0.1):.1f} mm: move the camera back, or '
            'keep the correction with `calibrate keep FILE` or on the dashboard (otherwise, after '
            'a restart, only a background_file tells that it was nudged)'))


def correction_of(nudge: Nudge, surface: Surface, size: ImageSize) -> Correction:
    """
    Tell what a nudge does to positions.

    :param surface: Maps the background's pixels to the work surface.
    :param size: Width and height of the pictures, in px.
    """
    surface = surface.for_image_size(size)
    places = _places(size)
    frame_places = nudge.frame_from_background.pixels(places)
    shift_px = float(np.hypot(*(frame_places - places).T).max())
    nudge = _with_foot(nudge, shift_px * surface.height_share, size)
    covariances = _covariances(nudge, frame_places, size)
    moved_cm, errors_cm = [0.0], [0.0]
    for place, there, covariance in zip(places, frame_places, covariances):
        try:
            moved = surface.locate(there[None]) - surface.locate(place[None])
            scale = scales_at(surface, place[None])[0]
        except HorizonError:
            continue
        moved_cm.append(float(np.hypot(*moved[0])))
        errors_cm.append(radius_for(_SHARE) * _deviation(scale @ covariance @ scale.T))
    return Correction(
        nudge, shift_px, _MM_PER_CM * max(moved_cm),
        _MM_PER_CM * max(errors_cm), max(map(_deviation, covariances)))


def corrected_surface(
    correction: Correction, base: SurfaceInForce, size: ImageSize
) -> SurfaceInForce:
    """
    Give the surface that holds for the nudged camera.

    :param base: That which holds for the background.
    :param size: Width and height of the pictures, in px.
    """
    nudge = correction.nudge
    background_from_frame = nudge.frame_from_background.inverse
    covariance = np.zeros((WARP_NUMBERS, WARP_NUMBERS))
    count = len(nudge.covariance)
    covariance[:count, :count] = nudge.covariance
    if base.covariance is not None:
        covariance += base.covariance
    before = base.frame_from_calibrated
    return SurfaceInForce(
        NudgedSurface(base.surface, background_from_frame, size), covariance, correction.reason,
        base.replaces, nudge.frame_from_background if before is None
        else nudge.frame_from_background.after(before))


def _with_foot(nudge: Nudge, foot_px: float, size: ImageSize) -> Nudge:
    # A camera that was shifted, not turned, has another foot point: raised objects move by this.
    covariance = nudge.covariance.copy()
    covariance[[2, 5], [2, 5]] += (foot_px / 2 / (np.hypot(*size) / 2)) ** 2
    return nudge._replace(covariance=covariance)


def _places(size: ImageSize) -> np.ndarray:
    columns, rows = (np.linspace(0, length - 1, count) for length, count in zip(size, _PLACES))
    return np.stack(np.meshgrid(columns, rows), axis=2).reshape(-1, 2)


def _covariances(nudge: Nudge, frame_places: np.ndarray, size: ImageSize) -> np.ndarray:
    # Of the places, shape (n, 2, 2), in px².
    design = warp_design(
        frame_places, size, nudge.frame_from_background.lens)[:, :, :len(nudge.covariance)]
    return design @ nudge.covariance @ design.transpose(0, 2, 1)


def _deviation(covariance: np.ndarray) -> float:
    return float(np.sqrt(max(np.linalg.eigvalsh(covariance)[-1], 0.0)))
