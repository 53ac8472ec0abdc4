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

"""The work surface for raised objects, whose visible top is nearer to the camera."""

from typing import Optional, Sequence

from camera_to_base.checks import finite_numbers
from camera_to_base.errors import InvalidValueError
from camera_to_base.image_size import DEFAULT_IMAGE_SIZE, ImageSize
from camera_to_base.surface.models import Surface
import numpy as np


class RaisedSurface:
    """
    Maps a pixel that shows a point above the surface to the point of the surface below it.

    The camera is at height H above its foot point. Its ray through a point at height h meets the
    surface at `seen`. When the ray passes the point, it has covered (H - h) / H of its way down,
    and the same share of its way along the surface:

        point = foot + (seen - foot) * (1 - h / H)

    Without this correction, a point 10 cm from the foot is 7 mm off for h = 4 cm and H = 60 cm.

    An object's outline is that of its top face if only this face differs from the surface. If the
    side faces differ too, the outline reaches down to the surface, and its centre corresponds to
    about 0.6 of the height: 0.53 to 0.77 for discs and boxes 1.5 to 5 cm wide and 1 to 4 cm high,
    5 to 15 cm from the foot point of a camera at 60 cm.

    :param surface: Maps pixels to the work surface.
    :param object_height_cm: Height of the visible face above the surface, in cm.
    :param camera_height_cm: How far above the surface the camera is, in cm.
    :param camera_foot_cm: The point of the surface below the camera, x and y, in cm, in the camera
        frame; None for what the picture's centre looks at, as with a parallel camera.
    :param image_size: Width and height of the pictures, in px.
    :raises InvalidValueError: If the camera is not above the objects.
    """

    def __init__(
        self,
        surface: Surface,
        object_height_cm: float,
        camera_height_cm: float,
        camera_foot_cm: Optional[Sequence[float]] = None,
        image_size: ImageSize = DEFAULT_IMAGE_SIZE,
    ) -> None:
        self._surface, self.distortion = surface, surface.distortion
        self._object_height_cm = object_height_cm
        self._camera_height_cm = camera_height_cm
        if not object_height_cm < camera_height_cm:
            raise InvalidValueError(
                f"object_height_cm must be below the camera's height, {camera_height_cm:g} cm, "
                f'got {object_height_cm:g}')
        self.height_share = object_height_cm / camera_height_cm
        self._given_foot_cm = camera_foot_cm
        if camera_foot_cm is None:
            centre = np.subtract(image_size, 1) / 2
            camera_foot_cm = surface.locate([centre])[0]
        self._foot_cm = finite_numbers('camera_foot_cm', camera_foot_cm, 2)

    def locate(self, pixels: np.ndarray) -> np.ndarray:
        """Map pixels to the surface below what they show, see :meth:`Surface.locate`."""
        seen = self._surface.locate(pixels)
        return self._foot_cm + (seen - self._foot_cm) * (1 - self.height_share)

    @property
    def foot_cm(self) -> np.ndarray:
        """The point of the surface below the camera, shape (2,)."""
        return self._foot_cm

    @property
    def flat(self) -> Surface:
        """The work surface itself."""
        return self._surface

    def for_image_size(self, image_size: ImageSize) -> 'RaisedSurface':
        """Give the model for pictures of a size, see :meth:`Surface.for_image_size`."""
        return RaisedSurface(
            self._surface.for_image_size(image_size), self._object_height_cm,
            self._camera_height_cm, self._given_foot_cm, image_size)


def flat_surface(surface: Surface) -> Surface:
    """Give the work surface itself: the calibration, whatever the height of the objects is."""
    return getattr(surface, 'flat', surface)
