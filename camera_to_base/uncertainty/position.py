# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The uncertainty of a position in the camera frame: the terms of the picture, added up."""

from dataclasses import dataclass, field
import math
from typing import Dict, NamedTuple, Optional, Protocol, Tuple

from camera_to_base.checks import ImageSize
from camera_to_base.coordinate_transform import CameraPlace
from camera_to_base.errors import HorizonError
from camera_to_base.parameters import Values
from camera_to_base.uncertainty.covariance import (
    CAMERA_COVARIANCE, camera_covariance, CENTRE_FLOOR, FrameState, HEIGHT_TOLERANCE, LEAST_Z_CM,
    PositionCovariance, SURFACE_COVARIANCE, surface_covariance, UNKNOWN_POSITION)
from camera_to_base.uncertainty.terms import (
    centre_covariance, height_slopes, Lens, likely_place, Shape, Spread,
    TUTORIAL_FLOOR_PX, UNKNOWN_ANGLE, warp_design, yaw_variance)
import numpy as np

# The calibration's terms are the same within a square of this edge, in px, to a few percent.
_CELL_PX = 8
_MOST_CELLS = 20000
# A footprint's near side stays where it is seen, whatever the height is; its far side moves.
_CENTRE_SHARE = 0.5


class SurfaceModel(Protocol):
    """Maps pixels to the surface: a `Surface` of the room of that name, as far as is needed."""

    distortion: Optional[Lens]
    camera_place: Optional[CameraPlace]

    def locate(self, pixels: np.ndarray) -> np.ndarray:
        """Map pixels (n, 2), in px, to points (n, 2), in cm."""

    def for_image_size(self, image_size: ImageSize) -> 'SurfaceModel':
        """Give the model for pictures of a size."""


class _Place(NamedTuple):
    """
    What the calibration says about a place of the picture.

    :param scale: x and y, in cm, of a step of 1 px along u, then along v.
    :param surface: xx, xy and yy of the calibration's error, in cm².
    :param slope: How x and y move if the object is higher by 1 cm.
    """

    scale: Tuple[float, float, float, float]
    surface: Tuple[float, float, float]
    slope: Tuple[float, float]


@dataclass(frozen=True)
class PositionUncertainty:
    """
    How uncertain positions are in the camera frame.

    :param surface: Maps pixels to the surface.
    :param warp_covariance: Of the calibration, shape (14, 14), see `terms`.
    :param camera: Where the camera is; None where it is not known.
    :param centre_floor_px: What light does to a centre, see `terms`.
    :param height_tolerance_cm: Standard deviation of the objects' height.
    :param is_tutorial: Whether the detector is the tutorial's.
    :param place_covariance: Of the camera's foot point and height, shape (3, 3), in cm².
    """

    surface: SurfaceModel
    warp_covariance: np.ndarray
    camera: Optional[CameraPlace] = None
    centre_floor_px: float = 0.0
    height_tolerance_cm: float = 0.0
    is_tutorial: bool = False
    place_covariance: np.ndarray = field(
        default_factory=lambda: np.zeros((3, 3)), compare=False)
    _places: Dict = field(default_factory=dict, compare=False, repr=False)

    def covariance(self, shape: Shape, frame: FrameState) -> PositionCovariance:
        """Return the covariance of an object's position; all its numbers are finite."""
        u, v = shape.pixel
        place = self._place(frame.image_size, int(u // _CELL_PX), int(v // _CELL_PX))
        if place is None:
            return UNKNOWN_POSITION
        in_picture = self.in_picture(shape, frame)
        xx, xy, yy = _projected(in_picture, place.scale)
        x, y = place.slope
        height = self.height_tolerance_cm ** 2
        if shape.height_cm:
            xx, xy, yy = self._with_place((xx, xy, yy), shape.height_cm, (x, y), frame.image_size)
            x, y = _CENTRE_SHARE * x, _CENTRE_SHARE * y
        misfit = shape.misfit_cm ** 2
        found = PositionCovariance(
            xx + place.surface[0] + height * x * x + misfit,
            xy + place.surface[1] + height * x * y,
            yy + place.surface[2] + height * y * y + misfit, max(height, LEAST_Z_CM ** 2),
            min(yaw_variance(shape, in_picture) + self._rotation_variance, UNKNOWN_ANGLE))
        return found if all(map(math.isfinite, found)) else UNKNOWN_POSITION

    def _with_place(
        self, covariance: Tuple[float, float, float], height_cm: float,
        slope: Tuple[float, float], image_size: ImageSize,
    ) -> Tuple[float, float, float]:
        """Add what the error of the camera's place does to an object of a height."""
        _, camera = self._of_size(image_size)
        share = _CENTRE_SHARE * height_cm / camera.height_cm
        moves = share * np.array([[1.0, 0.0, -slope[0]], [0.0, 1.0, -slope[1]]])
        (xx, xy), (_, yy) = (moves @ self.place_covariance @ moves.T).tolist()
        return covariance[0] + xx, covariance[1] + xy, covariance[2] + yy

    def of_pixel(
        self, pixel: Tuple[float, float], image_size: ImageSize, height_cm: float = 0.0
    ) -> PositionCovariance:
        """Return the covariance of the position of a pixel that was not detected but given."""
        return self.covariance(Shape(pixel, 1.0, Spread(0.0, 0.0, 0.0), height_cm=height_cm),
                               FrameState(image_size))

    def in_picture(self, shape: Shape, frame: FrameState) -> Spread:
        """Return the covariance of an object's centre in the picture, with the view's shift."""
        floor_px = self.centre_floor_px
        if self.is_tutorial:
            floor_px = max(floor_px, TUTORIAL_FLOOR_PX)
        return centre_covariance(
            shape, frame.noise, math.hypot(floor_px, frame.shift_px, shape.doubt_px))

    def pixel_covariance(self, shape: Shape, frame: FrameState) -> Spread:
        """Return the covariance of a position, mapped back to the picture, in px²."""
        u, v = shape.pixel
        place = self._place(frame.image_size, int(u // _CELL_PX), int(v // _CELL_PX))
        found = self.covariance(shape, frame)
        x_u, x_v, y_u, y_v = place.scale if place is not None else (1.0, 0.0, 0.0, 1.0)
        size = x_u * y_v - x_v * y_u or 1.0
        inverse = y_v / size, -x_v / size, -y_u / size, x_u / size
        return Spread(*_projected(Spread(found.xx, found.xy, found.yy), inverse))

    def at_pixels(self, pixels: np.ndarray, image_size: ImageSize) -> np.ndarray:
        """
        Return what the calibration and the height make uncertain.

        :param pixels: Shape (n, 2), in px.
        :returns: Shape (n, 2, 2), of x and y, in cm².
        :raises HorizonError: If a pixel lies on the horizon or beyond it.
        """
        _, covariances, slopes = self._calibration_at(pixels, image_size)
        slopes = self.height_tolerance_cm * slopes
        return covariances + slopes[:, :, None] * slopes[:, None]

    @property
    def _rotation_variance(self) -> float:
        # A warp turns the picture by half the difference of its mixed numbers.
        warp = self.warp_covariance
        return float(warp[1, 1] + warp[3, 3] - 2 * warp[1, 3]) / 4

    def _place(self, image_size: ImageSize, column: int, row: int) -> Optional[_Place]:
        """Return the calibration's terms in a cell of the picture; None beyond the horizon."""
        key = image_size, column, row
        if key not in self._places:
            if len(self._places) > _MOST_CELLS:
                self._places.clear()
            self._places[key] = self._made_place(
                image_size, _CELL_PX * np.array([[column + 0.5, row + 0.5]]))
        return self._places[key]

    def _made_place(self, image_size: ImageSize, pixels: np.ndarray) -> Optional[_Place]:
        try:
            scales, covariances, slopes = self._calibration_at(pixels, image_size)
        except HorizonError:
            return None
        (xx, xy), (_, yy) = covariances[0].tolist()
        return _Place(tuple(scales[0].ravel().tolist()), (xx, xy, yy), tuple(slopes[0].tolist()))

    def _calibration_at(
        self, pixels: np.ndarray, image_size: ImageSize
    ) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return scales (n, 2, 2), covariances (n, 2, 2) and slopes (n, 2), see `_Place`."""
        surface, camera = self._of_size(image_size)
        scales = scales_at(surface, pixels)
        moves = scales @ warp_design(pixels, image_size, surface.distortion)
        return (scales, moves @ self.warp_covariance @ moves.transpose(0, 2, 1),
                height_slopes(surface.locate(pixels), camera))

    def _of_size(self, image_size: ImageSize) -> Tuple[SurfaceModel, CameraPlace]:
        found = self._places.get(image_size)
        if found is None:
            surface = self.surface.for_image_size(image_size)
            found = self._places[image_size] = (
                surface, self.camera or likely_place(surface.locate, image_size))
        return found


def _projected(spread: Spread, scale: Tuple[float, float, float, float]
               ) -> Tuple[float, float, float]:
    """Map a covariance in the picture to the surface: xx, xy and yy, in cm²."""
    (uu, uv, vv), (x_u, x_v, y_u, y_v) = spread, scale
    return (x_u * x_u * uu + 2 * x_u * x_v * uv + x_v * x_v * vv,
            x_u * y_u * uu + (x_u * y_v + x_v * y_u) * uv + x_v * y_v * vv,
            y_u * y_u * uu + 2 * y_u * y_v * uv + y_v * y_v * vv)


def scales_at(surface: SurfaceModel, pixels: np.ndarray) -> np.ndarray:
    """
    Return the steps on the surface that correspond to a step of 1 px.

    :param pixels: Shape (n, 2), in px.
    :returns: Shape (n, 2, 2); columns are x and y, in cm, of a step along u and along v.
    """
    steps = surface.locate((np.asarray(pixels)[:, None] + _STEPS).reshape(-1, 2))
    steps = steps.reshape(-1, 4, 2)
    return (steps[:, 0::2] - steps[:, 1::2]).transpose(0, 2, 1)


_STEPS = np.array([[0.5, 0], [-0.5, 0], [0, 0.5], [0, -0.5]])


def position_uncertainty(values: Values, surface: SurfaceModel) -> PositionUncertainty:
    """
    Make the uncertainty of positions in the camera frame.

    :param values: The camera node's parameters, by full name.
    :param surface: Made of the same parameters.
    :raises InvalidValueError: If surface.covariance or surface.camera_covariance is none.
    """
    return PositionUncertainty(
        surface, surface_covariance(values[SURFACE_COVARIANCE]), surface.camera_place,
        values[CENTRE_FLOOR], values[HEIGHT_TOLERANCE], values['detector.method'] == 'tutorial',
        camera_covariance(values[CAMERA_COVARIANCE])[:3, :3])
