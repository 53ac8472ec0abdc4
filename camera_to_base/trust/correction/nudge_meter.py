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

"""
Measures how the camera was nudged: the homography between the background and a frame.

This is a measurement for the correction of positions: all eight numbers of the homography, on
undistorted pixels, to some hundredths of a px, with a covariance. It needs 50 corners that agree,
spread over the whole picture, and refuses anything less, so it cannot tell whether a covered or
faint view has moved: that question has `view.view_check`, which needs a third of the corners. One
method for both would either publish nothing where little is seen, or correct by an inexact shift.
"""

from typing import NamedTuple, Optional, Union

from camera_to_base.surface import PictureMap, RadialDistortion
from camera_to_base.trust.correction.corners import (
    corner_information, even_picture, EvenPicture, find_corners, follow, Pairs)
from camera_to_base.trust.correction.repeats import is_repeated
from camera_to_base.trust.correction.warp_fit import (
    first_homography, fit_warp, warp_matrix, WarpFit)
import cv2
import numpy as np

# Pictures are made this long at most, in px.
_LONGEST = 960
# So many corners must agree, and this share of those that both pictures show.
_LEAST_AGREEING, _LEAST_SHARE = 50, 0.5
# They must lie in so many of the picture's 4 x 3 blocks, and of the outer columns and rows.
_BLOCKS, _LEAST_BLOCKS, _LEAST_IN_BLOCK = (4, 3), 8, 2


class Nudge(NamedTuple):
    """
    How the camera was nudged.

    :param frame_from_background: Maps the background's pixels to the frame's.
    :param covariance: Of a warp of the frame, shape (8, 8), see `uncertainty`.
    """

    frame_from_background: PictureMap
    covariance: np.ndarray


class NudgeMeter:
    """
    Measures nudges against a background, on undistorted pixels.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param lens: The camera's; None for one without distortion.
    """

    def __init__(self, background: np.ndarray, lens: Optional[RadialDistortion]) -> None:
        height, width = background.shape[:2]
        self._size, self._lens = (width, height), lens
        self._scale = max(1.0, max(width, height) / _LONGEST)
        self._small_size = tuple(max(1, round(length / self._scale)) for length in self._size)
        self._grey = self._small_grey(background)
        self._even = even_picture(self._grey)
        self._corners = find_corners(self._even)

    def measure(self, frame: np.ndarray) -> Union[Nudge, str]:
        """
        Measure the nudge of a frame.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :returns: The nudge, or why it cannot be measured.
        """
        even = even_picture(self._small_grey(frame))
        first = self._first(even)
        if first is None:
            return _FEW
        warped = self._warped(first)
        here = first.pixels(self._full(self._corners))
        pairs = follow(warped, even, self._small(here[self._is_inside(here)]), is_close=True)
        if len(pairs.here) < _LEAST_AGREEING:
            return _FEW
        information = corner_information(warped, pairs.here) / self._scale ** 2
        pairs = Pairs(self._full(pairs.here), self._full(pairs.there))
        fit = fit_warp(pairs, information, self._size, self._lens)
        doubt = self._doubt(pairs, fit)
        if doubt is not None:
            return doubt
        if is_repeated(warped.levels, even.levels):
            return 'the pattern of the surface repeats itself'
        whole = PictureMap(warp_matrix(fit.numbers, self._size), self._lens).after(first)
        return Nudge(whole, fit.covariance)

    def _first(self, even: EvenPicture) -> Optional[PictureMap]:
        pairs = follow(self._even, even, self._corners, is_close=False)
        here, there = (self._undistorted(self._full(places)) for places in pairs)
        matrix = first_homography(here, there)
        return None if matrix is None else PictureMap(matrix, self._lens)

    def _warped(self, frame_from_background: PictureMap) -> EvenPicture:
        # The background as the camera sees it now.
        places = frame_from_background.inverse.grid(self._small_size, self._scale)
        return even_picture(cv2.remap(self._grey, places, None, cv2.INTER_CUBIC,
                                      borderMode=cv2.BORDER_REPLICATE))

    def _doubt(self, pairs: Pairs, fit: WarpFit) -> Optional[str]:
        agreeing = pairs.here[fit.agrees]
        if len(agreeing) < max(_LEAST_AGREEING, _LEAST_SHARE * len(pairs.here)):
            return _FEW
        blocks = np.zeros(_BLOCKS[::-1], int)
        columns, rows = (np.clip((along * count / length).astype(int), 0, count - 1)
                         for along, count, length in zip(agreeing.T, _BLOCKS, self._size))
        np.add.at(blocks, (rows, columns), 1)
        there = blocks >= _LEAST_IN_BLOCK
        is_spread = (there.sum() >= _LEAST_BLOCKS and there[[0, -1]].any(axis=1).all()
                     and there[:, [0, -1]].any(axis=0).all())
        return None if is_spread else 'the corners that agree are not spread over the picture'

    def _small_grey(self, picture: np.ndarray) -> np.ndarray:
        grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
        if self._scale == 1:
            return grey
        return cv2.resize(grey, self._small_size, interpolation=cv2.INTER_AREA)

    def _full(self, places: np.ndarray) -> np.ndarray:
        return (np.asarray(places, float) + 0.5) * self._scale - 0.5

    def _small(self, places: np.ndarray) -> np.ndarray:
        return (np.asarray(places, float) + 0.5) / self._scale - 0.5

    def _undistorted(self, pixels: np.ndarray) -> np.ndarray:
        return pixels if self._lens is None else self._lens.undistort(pixels)

    def _is_inside(self, pixels: np.ndarray) -> np.ndarray:
        with np.errstate(invalid='ignore'):
            return ((pixels >= 4) & (pixels < np.array(self._size) - 4)).all(axis=1)


_FEW = 'too few corners of the surface agree on one movement'
