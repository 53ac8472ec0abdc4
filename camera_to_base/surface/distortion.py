# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Radial lens distortion with one coefficient, in closed form both ways."""

from dataclasses import dataclass
from typing import Optional, Sequence, Tuple

from camera_to_base.checks import finite_number, finite_numbers
import numpy as np

# A stronger lens is not described by one coefficient.
LARGEST_COEFFICIENT = 2.0


@dataclass(frozen=True)
class RadialDistortion:
    """
    The division model: undistorted = centre + (pixel - centre) / (1 + coefficient r^2).

    r is the pixel's distance to the centre in units of `radius`. A negative coefficient is a
    barrel, as wide lenses have it; -0.2 moves a pixel at r = 1 outwards by a quarter.

    Source: A. Fitzgibbon, Simultaneous linear estimation of multiple view geometry and lens
    distortion, CVPR 2001.

    :param coefficient: No unit; 0 is a lens without distortion.
    :param centre: u and v, in px.
    :param radius: In px; half the picture's diagonal by this package's convention.
    """

    coefficient: float
    centre: Tuple[float, float]
    radius: float

    @classmethod
    def of_picture(
        cls, image_size: Tuple[int, int], coefficient: float = 0.0,
        centre: Optional[Sequence[float]] = None,
    ) -> 'RadialDistortion':
        """
        Make the distortion of a picture's lens; the radius is half the picture's diagonal.

        :param image_size: Width and height, in px.
        :param coefficient: At most `LARGEST_COEFFICIENT`, either sign.
        :param centre: u and v, in px; None for the picture's centre.
        :raises InvalidValueError: If a number is not finite, or the coefficient is no lens's.
        """
        if centre is None:
            centre = np.subtract(image_size, 1) / 2
        u, v = finite_numbers('distortion_centre', centre, 2).tolist()
        checked = finite_number(
            'distortion_coefficient', coefficient, -LARGEST_COEFFICIENT, LARGEST_COEFFICIENT)
        return cls(checked, (u, v), float(np.hypot(*image_size) / 2))

    def undistort(self, pixels: np.ndarray) -> np.ndarray:
        """
        Map pixels of the picture to those of a lens without distortion.

        :param pixels: Shape (n, 2), columns u and v, in px.
        :returns: Shape (n, 2), in px; NaN where the model has no answer, see `divide`.
        """
        if self.coefficient == 0:
            return np.asarray(pixels, float)
        offsets = (np.asarray(pixels, float) - self.centre) / self.radius
        return self.centre + self.radius * divide(offsets, self.coefficient)

    def distort(self, pixels: np.ndarray) -> np.ndarray:
        """
        Map pixels of a lens without distortion to those of the picture.

        :param pixels: Shape (n, 2), columns u and v, in px.
        :returns: Shape (n, 2), in px; NaN where the model has no answer, see `undivide`.
        """
        offsets = (np.asarray(pixels, float) - self.centre) / self.radius
        return self.centre + self.radius * undivide(offsets, self.coefficient)


def divide(offsets: np.ndarray, coefficient: float) -> np.ndarray:
    """
    Remove the distortion from offsets to its centre.

    The model is one-to-one for abs(coefficient) r^2 < 1: at -1 the undistorted pixel is at
    infinity, and beyond +1 pixels further out would come back in.

    :param offsets: Shape (n, 2), in units of the radius.
    :returns: Shape (n, 2); NaN where the model is not one-to-one.
    """
    share = coefficient * np.sum(offsets ** 2, axis=-1, keepdims=True)
    return offsets / np.where(np.abs(share) < 1, 1 + share, np.nan)


def undivide(offsets: np.ndarray, coefficient) -> np.ndarray:
    """
    Add the distortion to undistorted offsets: the smaller root of the model's quadratic.

    Written without a division by the coefficient, so that 0 needs no case of its own, and without
    `abs`, so that complex steps pass through it.

    :param offsets: Shape (n, 2), in units of the radius.
    :returns: Shape (n, 2); NaN where no pixel of the picture belongs to the offset.
    """
    root = 1 - 4 * coefficient * np.sum(offsets ** 2, axis=-1, keepdims=True)
    return offsets * 2 / (1 + np.sqrt(np.where(np.real(root) > 0, root, np.nan)))
