# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""How uncertain a fitted pinhole camera is, as the parameters of a surface say it."""

from typing import Any, Dict, NamedTuple

from camera_to_base.calibration.pinhole_fit import PinholeFit
from camera_to_base.errors import HorizonError
from camera_to_base.surface import PinholeSurface
from camera_to_base.uncertainty import (
    CAMERA_COVARIANCE, place_95, scales_at, SURFACE_COVARIANCE, triangle_of, warp_design,
    WARP_NUMBERS)
import numpy as np

# Places of the picture, along its width and height, where the error is described.
_COLUMNS, _ROWS = 9, 7
# Of a standard deviation, for derivatives.
_STEP = 0.01


class CameraError(NamedTuple):
    """
    How uncertain a camera is.

    :param warp: Covariance of the picture's warp, shape (14, 14), see `uncertainty.terms`.
    :param place: Covariance of foot point and height, in cm, and of the focal length, in px, shape
        (4, 4).
    :param corner_px: Standard deviation of a corner's coordinate.
    """

    warp: np.ndarray
    place: np.ndarray
    corner_px: float

    @property
    def values(self) -> Dict[str, Any]:
        """Give the parameters, by full name."""
        return {SURFACE_COVARIANCE: triangle_of(self.warp),
                CAMERA_COVARIANCE: triangle_of(self.place)}

    def report(self, surface: PinholeSurface) -> Dict[str, Any]:
        """
        Return where the camera is, and how sure that is: the report's field `camera`.

        The keys that end in _95 say within how much the truth lies in 95 of 100 calibrations.
        """
        place = surface.camera_place
        return {'height_cm': round(place.height_cm, 4),
                'foot_cm': [round(value, 4) for value in place.foot_cm],
                'focal_px': round(float(np.mean(surface.lens.focal)), 3),
                **place_95(self.place)}


def camera_error(fit: PinholeFit) -> CameraError:
    """
    Tell how uncertain a fitted camera is.

    The covariance of the fit's equations, with the variance that left-out boards give; and by how
    much the camera would be another with all coefficients of the lens, which the data may not want
    although the lens has them.
    """
    problem, numbers = fit.problem, fit.numbers
    variance = fit.equations.variance(fit.left_out)
    camera = problem.camera
    covariance = fit.equations.covariance(variance)[camera, camera]
    pixels = _places(fit.surface)
    slopes = np.column_stack([
        (_effect(fit, pixels, numbers + step) - _effect(fit, pixels, numbers - step)) / (2 * _STEP)
        for step in _steps(covariance, problem.size)])
    scale = np.sqrt(np.diag(covariance))
    relative = covariance / scale[:, None] / scale
    found = slopes @ relative @ slopes.T
    if fit.richest is not None:
        missed = _effect_of(fit.richest.surface, fit, pixels)
        found += np.outer(missed, missed)
    return CameraError(found[:WARP_NUMBERS, :WARP_NUMBERS], found[WARP_NUMBERS:, WARP_NUMBERS:],
                       float(np.sqrt(variance)))


def _steps(covariance: np.ndarray, size: int) -> np.ndarray:
    """Return a small share of each of the camera's standard deviations, shape (s, size)."""
    steps = np.zeros((len(covariance), size))
    np.fill_diagonal(steps, _STEP * np.sqrt(np.diag(covariance)))
    return steps


def _effect(fit: PinholeFit, pixels: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    return _effect_of(fit.problem.surface(numbers), fit, pixels)


def _effect_of(surface: PinholeSurface, fit: PinholeFit, pixels: np.ndarray) -> np.ndarray:
    """Return by which warp, move and focal length another camera differs, shape (18,)."""
    there = surface.pixels(fit.surface.locate(pixels))
    seen = np.isfinite(there).all(axis=1)
    design = warp_design(pixels, surface.image_size, fit.surface.distortion)[seen]
    warp = np.linalg.lstsq(
        design.reshape(-1, WARP_NUMBERS), (pixels - there)[seen].ravel(), rcond=None)[0]
    place, known = surface.camera_place, fit.surface.camera_place
    return np.concatenate([
        warp, np.subtract(place.foot_cm, known.foot_cm), [
            place.height_cm - known.height_cm,
            surface.lens.focal[0] - fit.surface.lens.focal[0]]])


def _places(surface: PinholeSurface) -> np.ndarray:
    """Return pixels all over the picture that show the surface, shape (n, 2)."""
    width, height = surface.image_size
    places = np.stack(np.meshgrid(np.linspace(0, width - 1, _COLUMNS),
                                  np.linspace(0, height - 1, _ROWS)), axis=2).reshape(-1, 2)
    return np.array([place for place in places if _shows(surface, place)])


def _shows(surface: PinholeSurface, pixel: np.ndarray) -> bool:
    try:
        return bool(np.isfinite(scales_at(surface, pixel[None])).all())
    except HorizonError:
        return False
