# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
A calibrated surface with markers on it, and the calibration that is computed anew from them.

The markers' corners are as uncertain as the surface that they were learned with, and as the lens,
which both surfaces share. Both errors are those of one warp, `surface.covariance`, so what they do
in the new picture follows from it.
"""

from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, NamedTuple, Optional

from camera_to_base.checks import ImageSize
from camera_to_base.markers.find import see_markers
from camera_to_base.markers.fit import (
    Corners, judge_markers, known_markers, MarkerFit, MarkerLens, MarkerVerdict, moved_place,
    names_of)
from camera_to_base.parameters import Values
from camera_to_base.surface import (
    HomographySurface, Hull, make_hull, make_surface, PictureMap, RadialDistortion, Surface,
    surface_values)
from camera_to_base.uncertainty import (
    HOMOGRAPHY_NUMBERS, scales_at, SURFACE_COVARIANCE, surface_covariance, triangle_of,
    warp_design, WARP_NUMBERS)
import numpy as np

# Standard deviation up to which a surface computed anew is used, where it is the largest between
# the markers.
_LARGEST_ERROR_MM = 3.0


def marker_surface(values: Values) -> Surface:
    """Make the surface that markers lie on: flat, whatever the height of the objects is."""
    return make_surface(values)


def lens_of_values(values: Values) -> MarkerLens:
    """Return the calibrated lens; one without distortion where the model has none."""
    size = tuple(values['surface.image_size'])
    return marker_surface(values).distortion or RadialDistortion.of_picture(size)


def new_surface_values(values: Values, fit: MarkerFit) -> Dict[str, Any]:
    """
    Give the parameters of a surface computed anew.

    :param values: The calibration's parameters, by full name: those that the markers' corners
        were learned with.
    :param fit: The new surface.
    :returns: Those parameters of `surface.*` that differ.
    """
    calibrated, size = marker_surface(values), tuple(values['surface.image_size'])
    covariance = new_covariance(
        fit, calibrated, surface_covariance(values[SURFACE_COVARIANCE]), size)
    found = {**surface_values(fit.surface, Hull(fit.pixels)), SURFACE_COVARIANCE: triangle_of(
        covariance), 'surface.hull': _moved_hull(values, calibrated, fit.surface)}
    if values['surface.camera_height_cm']:
        foot_cm, height_cm = moved_place(values, calibrated, fit.surface)
        found.update({'surface.camera_height_cm': height_cm, 'surface.camera_foot_cm': foot_cm})
    return found


def deviation_cm(surface: Surface, covariance: np.ndarray, points: np.ndarray) -> float:
    """
    Return the standard deviation of positions by a surface, where it is the largest, in cm.

    :param covariance: Of the picture's warp, shape (14, 14).
    :param points: Where to look, shape (n, 2), in cm.
    """
    pixels = surface.pixels(points)
    moves = scales_at(surface, pixels) @ warp_design(
        pixels, surface.image_size, surface.distortion)
    squares = np.linalg.eigvalsh(moves @ covariance @ moves.transpose(0, 2, 1))
    return float(np.sqrt(squares.max()))


def _moved_hull(values: Values, calibrated: Surface, surface: Surface) -> List[float]:
    """Return the calibrated area in the new picture; [] for everywhere."""
    hull = make_hull(values)
    if hull is None:
        return []
    corners = surface.pixels(calibrated.locate(hull.corners))
    # Corners beyond the new horizon are not seen.
    corners = corners[np.isfinite(corners).all(axis=1)]
    return np.round(corners, 2).ravel().tolist() if len(corners) > 2 else []


def new_covariance(
    fit: MarkerFit, calibrated: Surface, calibrated_covariance: np.ndarray, image_size: ImageSize
) -> np.ndarray:
    """
    Return how uncertain the new surface is.

    :param fit: The new surface.
    :param calibrated: The flat surface that the markers' corners were learned with.
    :param calibrated_covariance: Of the calibrated picture's warp, shape (14, 14).
    :returns: Of the new picture's warp, shape (14, 14), see `uncertainty.terms`.
    """
    there = calibrated.pixels(fit.points)
    old = warp_design(there, image_size, calibrated.distortion)
    new = warp_design(fit.pixels, image_size, fit.surface.distortion)
    # How the calibration's errors move the corners in the new picture.
    moves = np.linalg.solve(scales_at(fit.surface, fit.pixels), scales_at(calibrated, there) @ old)
    lens_columns = np.s_[HOMOGRAPHY_NUMBERS:]
    moves[:, :, lens_columns] -= new[:, :, lens_columns]
    change = np.zeros((WARP_NUMBERS, WARP_NUMBERS))
    change[:HOMOGRAPHY_NUMBERS] = fit.gain @ moves.reshape(-1, WARP_NUMBERS)
    change[lens_columns, lens_columns] = np.eye(WARP_NUMBERS - HOMOGRAPHY_NUMBERS)
    covariance = change @ calibrated_covariance @ change.T
    covariance[:HOMOGRAPHY_NUMBERS, :HOMOGRAPHY_NUMBERS] += fit.variance * fit.gain @ fit.gain.T
    return covariance


class MarkerLook(NamedTuple):
    """
    What a picture shows of the markers.

    :param seen: By number, shape (4, 2), in px.
    """

    seen: Corners
    verdict: MarkerVerdict


class NewSurface(NamedTuple):
    """
    A surface computed anew.

    :param surface: As `make_surface` gives it.
    :param covariance: Of a warp of the picture, shape (14, 14).
    :param frame_from_calibrated: Maps the pixels of the calibrated camera to those of this one.
    :param values: The parameters that it differs in, by full name.
    """

    surface: Surface
    covariance: np.ndarray
    frame_from_calibrated: PictureMap
    values: Mapping[str, Any]


@dataclass(frozen=True)
class MarkedSurface:
    """
    A calibrated surface with markers.

    :param values: The calibration's parameters, by full name.
    :param corners: By number, shape (4, 2), in cm.
    """

    values: Values = field(repr=False)
    corners: Corners = field(compare=False)

    @classmethod
    def of(cls, values: Values) -> Optional['MarkedSurface']:
        """
        Make it of its parameters; None where there are no markers.

        :raises InvalidValueError: If the parameters do not belong together.
        """
        corners = known_markers(values)
        own = {name: value for name, value in values.items()
               if name.startswith(('surface.', 'markers.'))}
        return cls(own, corners) if corners else None

    def look(
        self, image: np.ndarray, frame_from_calibrated: Optional[PictureMap] = None,
        tolerance_px: float = 0.0,
    ) -> MarkerLook:
        """
        Look for the markers, and compare them with the surface in use.

        :param image: Shape (h, w, 3), uint8, BGR, of the calibration's size.
        :param frame_from_calibrated: Where the camera stands; None for where it was calibrated.
        :param tolerance_px: See :func:`judge_markers`.
        :raises CalibrationError: If OpenCV has no module aruco.
        """
        seen = see_markers(image, self._lens, expected=self.corners).corners
        return MarkerLook(seen, self.judge(seen, frame_from_calibrated, tolerance_px))

    def judge(
        self, seen: Corners, frame_from_calibrated: Optional[PictureMap] = None,
        tolerance_px: float = 0.0,
    ) -> MarkerVerdict:
        """Compare seen markers with a surface, see :meth:`look`."""
        flat = marker_surface(self.values)
        shown = {number: flat.pixels(corners) for number, corners in self.corners.items()}
        if frame_from_calibrated is not None:
            shown = {number: frame_from_calibrated.pixels(pixels)
                     for number, pixels in shown.items()}
        verdict = judge_markers(
            self.corners, shown, seen, tuple(self.values['surface.image_size']), self._lens,
            tolerance_px=tolerance_px)
        return verdict if verdict.fit is None else self._if_exact(verdict)

    @property
    def surface(self) -> Surface:
        """The surface as it is calibrated."""
        return make_surface(self.values)

    def anew(self, fit: MarkerFit) -> NewSurface:
        """Make the surface that a fit has found."""
        values = new_surface_values(self.values, fit)
        matrix = (np.linalg.inv(fit.surface.surface_from_pixel)
                  @ _matrix(marker_surface(self.values)))
        covariance = surface_covariance(values[SURFACE_COVARIANCE])
        return NewSurface(make_surface({**self.values, **values}), covariance,
                          PictureMap(matrix, self._lens), values)

    def _if_exact(self, verdict: MarkerVerdict) -> MarkerVerdict:
        """Give the verdict if positions between the markers would be exact enough."""
        if not self.values[SURFACE_COVARIANCE]:
            return verdict  # How exact the calibration is, is not known.
        fit = verdict.fit
        covariance = new_covariance(
            fit, marker_surface(self.values), surface_covariance(self.values[SURFACE_COVARIANCE]),
            fit.surface.image_size)
        between = np.concatenate(list(self.corners.values()))
        error_mm = 10 * deviation_cm(fit.surface, covariance, between)
        if error_mm <= _LARGEST_ERROR_MM:
            return verdict
        unseen = sorted(set(self.corners) - set(fit.numbers))
        return MarkerVerdict(trouble=(
            f'by {names_of(fit.numbers)}, positions are exact to {error_mm:.1f} mm only'
            + (f' ({names_of(unseen)} not used)' if unseen else '')))

    @property
    def _lens(self) -> MarkerLens:
        return lens_of_values(self.values)


def _matrix(surface: Surface) -> np.ndarray:
    """Return the map from undistorted pixels to cm, shape (3, 3)."""
    if isinstance(surface, HomographySurface):
        return surface.surface_from_pixel
    scale = float(surface.locate([[1.0, 0.0]])[0, 0])
    return np.diag([scale, scale, 1.0])
