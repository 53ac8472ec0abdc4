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

"""The work surface as a nudged camera sees it: a homography before the calibrated surface."""

from typing import Optional

from camera_to_base.checks import finite_numbers
from camera_to_base.errors import FrameSizeError, HorizonError
from camera_to_base.image_size import ImageSize
from camera_to_base.surface.distortion import RadialDistortion
from camera_to_base.surface.models import homogeneous, Surface
from camera_to_base.surface.raised import flat_surface
import cv2
import numpy as np

# Maps of whole pictures are computed on a grid, in px, and linearly between its places.
_STEP = 16


class PictureMap:
    """
    Maps pixels of one picture of a plane to those of another, taken with the same lens.

    The pictures of a plane differ by a homography, once the lens's distortion is removed.

    :param matrix: Shape (3, 3), from undistorted px to undistorted px.
    :param lens: The distortion of both pictures; None for none.
    """

    def __init__(self, matrix: np.ndarray, lens: Optional[RadialDistortion] = None) -> None:
        self.matrix = np.asarray(matrix, float) / matrix[2, 2]
        self.lens = lens

    @property
    def inverse(self) -> 'PictureMap':
        """The map back."""
        return PictureMap(np.linalg.inv(self.matrix), self.lens)

    def after(self, other: 'PictureMap') -> 'PictureMap':
        """Give the map that first maps by another one of the same lens."""
        return PictureMap(self.matrix @ other.matrix, self.lens)

    def pixels(self, pixels: np.ndarray) -> np.ndarray:
        """
        Map pixels.

        :param pixels: Shape (n, 2), columns u and v, in px, as the lens shows them.
        :returns: Shape (n, 2); NaN for a pixel that the other picture cannot show.
        """
        pixels = np.asarray(pixels, float)
        if self.lens is not None:
            pixels = self.lens.undistort(pixels)
        with np.errstate(invalid='ignore', divide='ignore', over='ignore'):
            scaled = homogeneous(self.matrix, pixels)
            depth = np.where(scaled[:, 2:] > 0, scaled[:, 2:], np.nan)
            pixels = scaled[:, :2] / depth
        return pixels if self.lens is None else self.lens.distort(pixels)

    def grid(self, size: ImageSize, scale: float = 1.0) -> np.ndarray:
        """
        Map every pixel of a picture.

        :param size: The picture's width and height, in px.
        :param scale: By how much it is smaller than the pictures of the map.
        :returns: Shape (h, w, 2), float32, in px of a picture that is as much smaller.
        """
        width, height = size
        columns, rows = (_STEP * np.arange(-1, length // _STEP + 3) + (_STEP - 1) / 2
                         for length in (width, height))
        places = np.stack(np.meshgrid(columns, rows), axis=2).reshape(-1, 2)
        there = (self.pixels((places + 0.5) * scale - 0.5) + 0.5) / scale - 0.5
        there = there.reshape(len(rows), len(columns), 2).astype(np.float32)
        whole = cv2.resize(there, None, fx=_STEP, fy=_STEP, interpolation=cv2.INTER_LINEAR)
        return np.ascontiguousarray(whole[_STEP:_STEP + height, _STEP:_STEP + width])


class NudgedSurface:
    """
    A calibrated surface, seen by its camera after a nudge.

    :param surface: As calibrated.
    :param calibrated_from_frame: Maps the nudged camera's pixels to those of the calibration.
    :param image_size: Width and height of the pictures that the map was measured on, in px.
    """

    def __init__(
        self, surface: Surface, calibrated_from_frame: PictureMap, image_size: ImageSize
    ) -> None:
        self._surface, self._map = surface, calibrated_from_frame
        self._image_size = tuple(image_size)

    @property
    def distortion(self) -> Optional[RadialDistortion]:
        """The lens's distortion; None for none."""
        return self._surface.distortion

    @property
    def height_share(self) -> float:
        """The height of the objects as a share of the camera's."""
        return self._surface.height_share

    @property
    def flat(self) -> 'NudgedSurface':
        """The work surface itself."""
        return NudgedSurface(flat_surface(self._surface), self._map, self._image_size)

    def locate(self, pixels: np.ndarray) -> np.ndarray:
        """Map pixels to the work surface, see :meth:`Surface.locate`."""
        pixels = finite_numbers('pixels', pixels, -1, 2)
        there = self._map.pixels(pixels)
        unseen = ~np.isfinite(there).all(axis=1)
        if unseen.any():
            u, v = pixels[unseen][0]
            raise HorizonError(f'pixel ({u:g}, {v:g}) does not look at the work surface')
        return self._surface.locate(there)

    def for_image_size(self, image_size: ImageSize) -> 'NudgedSurface':
        """Give the model for pictures of a size, see :meth:`Surface.for_image_size`."""
        if tuple(image_size) != self._image_size:
            raise FrameSizeError(
                f'the frame is {image_size[0]} x {image_size[1]} px, but a nudge of the camera '
                f'was corrected for {self._image_size[0]} x {self._image_size[1]} px: set the '
                'camera to that size, or start the node again')
        return NudgedSurface(
            self._surface.for_image_size(image_size), self._map, self._image_size)
