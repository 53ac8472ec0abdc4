# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The surface as a nudged camera sees it, and whether two surfaces are the same."""

from functools import cached_property
from typing import Optional, Tuple

from camera_to_base.checks import finite_numbers, ImageSize
from camera_to_base.coordinate_transform import CameraPlace
from camera_to_base.errors import FrameSizeError, HorizonError
from camera_to_base.surface.distortion import RadialDistortion
from camera_to_base.surface.models import homogeneous, HomographySurface, Lens, Surface
from camera_to_base.surface.pinhole import nearest_pinhole, PinholeSurface
import cv2
import numpy as np

# Maps of whole pictures are computed on a grid, in px, and linearly between its places.
_STEP = 16

# Surfaces are compared at so many places of the picture, and are the same to this many cm.
_PLACES, _SAME_CM = 5, 1e-4
# Where the picture shows the horizon, the places lie closer to its centre, by halves.
_SHARES = 1.0, 0.5, 0.25, 0.125


class PictureMap:
    """
    Maps pixels of one picture of a plane to those of another, taken with the same lens.

    The pictures of a plane differ by a homography, once the lens's distortion is removed.

    :param matrix: Shape (3, 3), from undistorted px to undistorted px.
    :param lens: The distortion of both pictures; None for none.
    """

    def __init__(self, matrix: np.ndarray, lens: Optional[Lens] = None) -> None:
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
    def image_size(self) -> ImageSize:
        """Width and height of the pictures, in px."""
        return self._image_size

    @property
    def distortion(self) -> Optional[Lens]:
        """The lens's distortion; None for none."""
        return self._surface.distortion

    @cached_property
    def pinhole(self) -> Optional[PinholeSurface]:
        """The pinhole camera after the nudge; None where the calibration is of another model."""
        calibrated = self._surface.pinhole
        if calibrated is None:
            return None
        return nearest_pinhole(self, calibrated, self._image_size)

    @property
    def camera_place(self) -> Optional[CameraPlace]:
        """Where the camera is; with a model other than pinhole, where it was before the nudge."""
        if self.pinhole is not None:
            return self.pinhole.camera_place
        return self._surface.camera_place

    def locate(self, pixels: np.ndarray) -> np.ndarray:
        """Map pixels to the work surface, see :meth:`Surface.locate`."""
        pixels = finite_numbers('pixels', pixels, -1, 2)
        there = self._map.pixels(pixels)
        unseen = ~np.isfinite(there).all(axis=1)
        if unseen.any():
            u, v = pixels[unseen][0]
            raise HorizonError(f'pixel ({u:g}, {v:g}) does not look at the work surface')
        return self._surface.locate(there)

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Map points of the work surface to pixels, see :meth:`Surface.pixels`."""
        return self._map.inverse.pixels(self._surface.pixels(points))

    def for_image_size(self, image_size: ImageSize) -> 'NudgedSurface':
        """Give the model for pictures of a size, see :meth:`Surface.for_image_size`."""
        if tuple(image_size) != self._image_size:
            raise FrameSizeError(
                f'the frame is {image_size[0]} x {image_size[1]} px, but a nudge of the camera '
                f'was corrected for {self._image_size[0]} x {self._image_size[1]} px: set the '
                'camera to that size, or start the node again')
        return NudgedSurface(
            self._surface.for_image_size(image_size), self._map, self._image_size)


def towards_camera(surface: Surface) -> int:
    """
    Tell on which side of the surface the camera is.

    :returns: 1 where the camera frame's z points to it, -1 where z points away from it, as with x
        and y along u and v.
    """
    # A parallel surface has no picture size of its own, and no horizon.
    centre = (np.array(getattr(surface, 'image_size', (2, 2)), float) - 1) / 2
    middle, right, below = surface.locate(centre + [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]])
    (a, b), (c, d) = right - middle, below - middle
    return -1 if a * d - b * c > 0 else 1


def as_homography(surface: Surface, size: ImageSize) -> Optional[HomographySurface]:
    """
    Give a surface as a homography with the surface's lens.

    :param size: Width and height of the pictures, in px.
    :returns: None where it is none, as the polynomial.
    :raises FrameSizeError: If the surface does not hold for that size.
    """
    surface = surface.for_image_size(size)
    pixels, points = _located(surface, size)
    lens = surface.distortion or RadialDistortion.of_picture(size)
    if not len(pixels):
        return None
    matrix, _ = cv2.findHomography(lens.undistort(pixels), points)
    if matrix is None:
        return None
    found = HomographySurface(matrix, size, lens)
    return found if _agree(found.locate(pixels), points) else None


def is_same_surface(one: Surface, other: Surface, size: ImageSize) -> bool:
    """
    Tell whether two surfaces give the same points.

    :param size: Width and height of the pictures, in px.
    :raises FrameSizeError: If one does not hold for that size.
    """
    pixels, points = _located(one.for_image_size(size), size)
    try:
        return len(pixels) > 0 and _agree(other.for_image_size(size).locate(pixels), points)
    except HorizonError:
        return False


def _located(surface: Surface, size: ImageSize) -> Tuple[np.ndarray, np.ndarray]:
    # Places of the picture that show the surface, and their points; none where none do.
    centre = (np.array(size, float) - 1) / 2
    lines = np.linspace(-1, 1, _PLACES)
    offsets = np.stack(np.meshgrid(lines, lines), axis=2).reshape(-1, 2) * centre
    for share in _SHARES:
        try:
            return centre + share * offsets, surface.locate(centre + share * offsets)
        except HorizonError:
            continue
    return np.empty((0, 2)), np.empty((0, 2))


def _agree(points: np.ndarray, others: np.ndarray) -> bool:
    return bool(np.abs(points - others).max() <= _SAME_CM)
