# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A pinhole camera with a known lens and a known pose over the work surface."""

from typing import Any, Dict, Mapping, Optional, Sequence

from camera_to_base.checks import finite_numbers, ImageSize
from camera_to_base.coordinate_transform import CameraPlace
from camera_to_base.errors import HorizonError, InvalidValueError
from camera_to_base.surface.lens import LensModel
from camera_to_base.surface.models import HomographySurface, Surface
import cv2
import numpy as np

# So many places across the picture, and down it, show where a nudged camera stands.
_PLACES = 5


class PinholeSurface(HomographySurface):
    """
    The work surface as a pinhole camera sees it: what camera_info holds, and the camera's pose.

    The camera frame lies on the surface (z = 0). Its z points to the camera where y turns left of
    x as the camera sees it, and away from it where y turns right, as with u and v.

    :param lens: Of the picture size that the calibration holds for.
    :param rotation: Shape (3,), rotation vector in rad; its matrix takes directions of the camera
        frame to the optical frame of the lens (z along the view, x right, y down).
    :param position_cm: Shape (3,), the lens in the camera frame, in cm: the foot point's x and y,
        and the height above the surface as z, negative where z points away from the camera.
    :raises InvalidValueError: If the camera stands on the surface, or does not look at it.
    """

    def __init__(
        self, lens: LensModel, rotation: Sequence[float], position_cm: Sequence[float]
    ) -> None:
        self.lens = lens
        self.rotation = finite_numbers('rotation', rotation, 3)
        self.position_cm = finite_numbers('camera_position_cm', position_cm, 3)
        if self.position_cm[2] == 0:
            raise InvalidValueError('camera_position_cm must have a height above the surface as '
                                    f'its third number, got {self.position_cm.tolist()}')
        self.optical_from_camera = cv2.Rodrigues(self.rotation)[0]
        columns = [*self.optical_from_camera.T[:2], -self.optical_from_camera @ self.position_cm]
        pixel_from_surface = lens.matrix @ np.column_stack(columns)
        middle = -self.optical_from_camera.T[:, 2] * self.position_cm[2]
        if not middle[2] > 0:
            raise InvalidValueError(
                'the camera does not look at the surface: surface.pinhole.rotation and '
                'surface.pinhole.camera_position_cm do not belong together')
        super().__init__(np.linalg.inv(pixel_from_surface), lens.image_size, lens)

    @property
    def pinhole(self) -> 'PinholeSurface':
        """Itself: see `NudgedSurface.pinhole`."""
        return self

    @property
    def camera_place(self) -> CameraPlace:
        """Where the camera is above the surface."""
        x, y, z = self.position_cm.tolist()
        return CameraPlace((x, y), abs(z))

    def pixels_of(self, points: np.ndarray) -> np.ndarray:
        """
        Return the pixels that show points above the surface.

        :param points: Shape (n, 3): x and y in the camera frame, and the height, in cm.
        :returns: Shape (n, 2), in px; NaN for a point that is not seen.
        """
        points = np.array(points, float)
        points[:, 2] *= np.sign(self.position_cm[2])
        return self.lens.project((points - self.position_cm) @ self.optical_from_camera.T)


def pinhole_of_values(values: Mapping[str, Any]) -> PinholeSurface:
    """
    Make the surface of its parameters.

    :param values: `surface.pinhole.…` and `surface.image_size`, by full name.
    :raises InvalidValueError: If they describe no camera above the surface.
    """
    prefix = 'surface.pinhole.'
    lens = LensModel.of_matrix(
        values['surface.image_size'], np.reshape(values[prefix + 'camera_matrix'], (3, 3)),
        values[prefix + 'distortion_coefficients'], values[prefix + 'distortion_model'])
    return PinholeSurface(
        lens, values[prefix + 'rotation'], values[prefix + 'camera_position_cm'])


def pinhole_values(surface: PinholeSurface) -> Dict[str, Any]:
    """Give the parameters that :func:`pinhole_of_values` makes the same surface of."""
    lens, prefix = surface.lens, 'surface.pinhole.'
    return {
        prefix + 'distortion_model': lens.model,
        prefix + 'camera_matrix': lens.matrix.ravel().tolist(),
        prefix + 'distortion_coefficients': list(lens.coefficients),
        prefix + 'rotation': surface.rotation.tolist(),
        prefix + 'camera_position_cm': surface.position_cm.tolist(),
    }


def nearest_pinhole(
    surface: Surface, calibrated: PinholeSurface, image_size: ImageSize
) -> Optional[PinholeSurface]:
    """
    Find the pose of a calibrated camera from the surface as it sees it now.

    :param surface: Flat; the same lens, such as a `NudgedSurface`.
    :param calibrated: Gives the lens, and the pose that the search starts from.
    :param image_size: Width and height of the pictures, in px.
    :returns: None where the picture shows no surface.
    """
    centre = np.subtract(image_size, 1) / 2
    lines = np.linspace(-0.8, 0.8, _PLACES)
    pixels = centre + np.stack(np.meshgrid(lines, lines), axis=2).reshape(-1, 2) * centre
    try:
        points = surface.locate(pixels)
    except HorizonError:
        return None
    lens, rotation = calibrated.lens, calibrated.rotation.copy()
    translation = -calibrated.optical_from_camera @ calibrated.position_cm
    straight, points = lens.undistort(pixels), np.column_stack([points, np.zeros(len(points))])
    rotation, translation = cv2.solvePnPRefineLM(
        points, straight, lens.matrix, np.zeros(4), rotation[:, None], translation[:, None])
    position = -cv2.Rodrigues(rotation)[0].T @ translation
    if not (np.isfinite(rotation).all() and np.isfinite(position).all()):
        return None
    return PinholeSurface(lens, rotation.ravel(), position.ravel())
