# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Measures how the camera was nudged: a homography on which corners of two pictures agree.

This is a measurement for the correction of positions: all eight numbers of the homography, on
undistorted pixels, to some hundredths of a px, with a covariance. It needs 50 corners that agree,
spread over the whole picture, and refuses anything less, so it cannot tell whether a covered or
faint view has moved: that question has `view.view_check`, which needs a third of the corners. One
method for both would either publish nothing where little is seen, or correct by an inexact shift.
"""

from typing import NamedTuple, Optional, Tuple, Union

from camera_to_base.detection import smoothed_noise
from camera_to_base.surface import PictureMap, RadialDistortion
from camera_to_base.uncertainty import Lens, warp_design
import cv2
import numpy as np

# Lengths are in px of the picture as it is given, of 960 px at most.
_LIGHT_WIDTH, _NOISE_SIGMA, _PLACE_SIGMA, _GREY_LEVELS = 49, 1.0, 6.0, 40.0
# Contrast that is less than this many levels, or deviations of the noise, is not made stronger.
_FAINTEST_LEVELS, _NOISE_DEVIATIONS = 1.0, 4.0
# Contrast above so many deviations of the noise is structure.
_STRUCTURE_DEVIATIONS = 2.0
# Corners are looked for in each cell, so that they are spread over the picture.
_CELL_PX, _CORNERS_PER_CELL, _QUALITY, _DISTANCE, _SIZE = 64, 6, 0.15, 8, 7
# None so close to the picture's edge: half its window would lie beyond.
_EDGE_PX = 8
# What noise of an even picture does to a shift; and what interpolation does, in px.
_SLOPE_NOISE, _MODEL_PX = 0.2, 0.03
# Of Lucas and Kanade: OpenCV's usual one, and a smaller one where the pictures nearly agree.
_WINDOW, _CLOSE_WINDOW = (21, 21), (17, 17)

# Shifts within this many px are looked at, in a picture that is made this long at most.
_REACH_PX, _LONGEST_REPEATED = 48, 480
# Another place looks the same where the pictures correlate there by this share of what they do in
# the place that was found.
_SAME_SHARE = 0.8

# Of a homography close to the identity.
NUMBERS = 8
# How far corners that agree may be off the first homography, which has no weights yet.
_AGREE_PX = 2.5
# Of reweighting the corners.
_ROUNDS = 8
# Cauchy's weights; squared deviations, in variances, of corners that do not agree; and the least
# variance, as a factor of what the corners' information says.
_HALF_WEIGHT, _DISAGREES, _LEAST_VARIANCE = 2.4, 9.0, 0.05
# What the corners of a block of the picture have in common is no noise.
_BIAS_BLOCKS, _LEAST_FOR_BIAS = (4, 3), 4

# Pictures are made this long at most, in px.
_LONGEST = 960
# So many corners must agree, and this share of those that both pictures show.
_LEAST_AGREEING, _LEAST_SHARE = 50, 0.5
# They must lie in so many of the picture's 4 x 3 blocks, and of the outer columns and rows.
_BLOCKS, _LEAST_BLOCKS, _LEAST_IN_BLOCK = (4, 3), 8, 2


class Pairs(NamedTuple):
    """
    Places of corners in two pictures.

    :param here: Shape (n, 2), in px, in the first picture.
    :param there: Shape (n, 2), in px, in the second.
    """

    here: np.ndarray
    there: np.ndarray


class EvenPicture(NamedTuple):
    """
    A picture with the same contrast everywhere, independent of the light.

    :param levels: Shape (h, w), uint8.
    :param is_structure: Of the same shape, uint8, 0 where only noise is seen.
    """

    levels: np.ndarray
    is_structure: np.ndarray


def even_picture(grey: np.ndarray) -> EvenPicture:
    """
    Give a picture the same contrast everywhere.

    :param grey: Shape (h, w), uint8.
    """
    levels = grey.astype(np.float32)
    detail = (cv2.GaussianBlur(levels, (0, 0), _NOISE_SIGMA)
              - cv2.blur(levels, (_LIGHT_WIDTH, _LIGHT_WIDTH)))
    contrast = np.sqrt(cv2.GaussianBlur(detail * detail, (0, 0), _PLACE_SIGMA))
    noise = smoothed_noise(levels, _NOISE_SIGMA, step=2)
    even = np.clip(128 + _GREY_LEVELS * detail / (
        contrast + max(_FAINTEST_LEVELS, _NOISE_DEVIATIONS * noise)), 0, 255)
    return EvenPicture(even.astype(np.uint8), (
        contrast > max(_FAINTEST_LEVELS / 2, _STRUCTURE_DEVIATIONS * noise)).astype(np.uint8))


def find_corners(picture: EvenPicture) -> np.ndarray:
    """
    Find corners that are spread over a picture.

    :returns: Shape (n, 2), float32, in px.
    """
    picture, mask = picture
    height, width = picture.shape
    found = [np.empty((0, 2), np.float32)]
    for top in range(_EDGE_PX, height - _EDGE_PX - 1, _CELL_PX):
        for left in range(_EDGE_PX, width - _EDGE_PX - 1, _CELL_PX):
            cell = (slice(top, min(top + _CELL_PX, height - _EDGE_PX)),
                    slice(left, min(left + _CELL_PX, width - _EDGE_PX)))
            corners = cv2.goodFeaturesToTrack(
                np.ascontiguousarray(picture[cell]), _CORNERS_PER_CELL, _QUALITY, _DISTANCE,
                mask=np.ascontiguousarray(mask[cell]), blockSize=_SIZE)
            if corners is not None:
                found.append(corners.reshape(-1, 2) + np.float32([left, top]))
    return np.concatenate(found)


def follow(here: EvenPicture, there: EvenPicture, corners: np.ndarray, *,
           is_close: bool) -> Pairs:
    """
    Follow corners from one even picture into another and back.

    :param corners: Shape (n, 2), float32, in px, in the first picture.
    :param is_close: Whether the pictures differ by a pixel at most.
    :returns: Those that come back to where they were.
    """
    if not len(corners):
        return Pairs(corners, corners)
    flow = {'winSize': _CLOSE_WINDOW if is_close else _WINDOW, 'maxLevel': 1 if is_close else 3,
            'criteria': (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 20, 0.005)}
    here, there = here.levels, there.levels
    begin = np.ascontiguousarray(corners, np.float32).reshape(-1, 1, 2)
    end, found, _ = cv2.calcOpticalFlowPyrLK(here, there, begin, None, **flow)
    back, found_back, _ = cv2.calcOpticalFlowPyrLK(there, here, end, None, **flow)
    missed_px = np.linalg.norm(back - begin, axis=2).ravel()
    came_back = (found.ravel() & found_back.ravel()) == 1
    kept = came_back & (missed_px < (0.3 if is_close else 1.0))
    return Pairs(begin[kept, 0].astype(float), end[kept, 0].astype(float))


def corner_information(picture: EvenPicture, corners: np.ndarray) -> np.ndarray:
    """
    Tell how well each corner tells its shift along u and v, up to a common factor.

    :param corners: Shape (n, 2), in px.
    :returns: Shape (n, 2, 2): an inverse covariance.
    """
    levels = picture.levels.astype(np.float32)
    du, dv = (cv2.Sobel(levels, cv2.CV_32F, *order, scale=1 / 8) for order in ((1, 0), (0, 1)))
    maps = corners.astype(np.float32).reshape(-1, 1, 2)
    uu, uv, vv = (cv2.remap(cv2.blur(product, _CLOSE_WINDOW), maps, None, cv2.INTER_LINEAR).ravel()
                  for product in (du * du, du * dv, dv * dv))
    slopes = np.array([[uu, uv], [uv, vv]], float).transpose(2, 0, 1)
    covariances = np.linalg.inv(slopes + 1e-3 * np.eye(2)) * _SLOPE_NOISE
    return np.linalg.inv(covariances + _MODEL_PX ** 2 * np.eye(2))


def is_repeated(here: np.ndarray, there: np.ndarray) -> bool:
    """
    Tell whether a picture agrees with another one at more than one shift.

    :param here: Shape (h, w), uint8, an even picture.
    :param there: Of the same shape; it shows the same, not shifted.
    """
    scale = min(1.0, _LONGEST_REPEATED / max(here.shape))
    small, other = (cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
                    .astype(np.float32) - 128 for picture in (here, there))
    reach = min(_REACH_PX, (min(small.shape) - 2) // 4)
    if reach < 2:
        return False
    inner = np.ascontiguousarray(small[reach:-reach, reach:-reach])
    likeness = cv2.matchTemplate(other, inner, cv2.TM_CCOEFF_NORMED)
    limit = _SAME_SHARE * likeness[reach, reach]
    count, labels = cv2.connectedComponents((likeness > limit).astype(np.uint8))
    return count != 2 or labels[reach, reach] == 0


class WarpFit(NamedTuple):
    """
    A small warp of a picture.

    :param numbers: Shape (8,), see `uncertainty.terms`.
    :param covariance: Of the numbers, shape (8, 8).
    :param agrees: Shape (n,), which corners agree.
    """

    numbers: np.ndarray
    covariance: np.ndarray
    agrees: np.ndarray


def first_homography(here: np.ndarray, there: np.ndarray) -> Optional[np.ndarray]:
    """
    Find the homography on which most pairs of undistorted places agree, by RANSAC.

    :param here: Shape (n, 2), in px.
    :param there: Shape (n, 2), in px.
    :returns: Shape (3, 3); None where there is none.
    """
    if len(here) < NUMBERS:
        return None
    matrix, _ = cv2.findHomography(here, there, cv2.RANSAC, _AGREE_PX, maxIters=1000)
    return matrix


def fit_warp(
    pairs: Pairs, information: np.ndarray, size: Tuple[int, int], lens: Optional[Lens]
) -> WarpFit:
    """
    Fit the warp that takes places to those close by, by least squares with robust weights.

    :param pairs: At least 8, in px of pictures of a size.
    :param information: Shape (n, 2, 2), how well each pair tells its shift, up to a factor.
    """
    design = warp_design(pairs.here, size, lens)[:, :, :NUMBERS]
    weighted = design.transpose(0, 2, 1) @ information
    shares = weighted @ design
    missed = pairs.there - pairs.here
    sides = (weighted @ missed[:, :, None])[:, :, 0]
    weights = np.ones(len(missed))
    for _ in range(_ROUNDS):
        numbers = np.linalg.lstsq(
            np.tensordot(weights, shares, 1), weights @ sides, rcond=None)[0]
        residuals = missed - design @ numbers
        squares = np.einsum('ni,nij,nj->n', residuals, information, residuals)
        # The median of the squares of two normal numbers is 1.39 variances.
        variance = max(float(np.median(squares)) / 1.39, _LEAST_VARIANCE)
        weights = 1 / (1 + squares / variance / _HALF_WEIGHT ** 2)
    agrees = squares < _DISAGREES * variance
    covariance = variance * np.linalg.pinv(
        np.tensordot(weights * agrees, shares, 1), hermitian=True)
    shared = _shared_variance(pairs.here[agrees], residuals[agrees], size)
    radius = np.hypot(*size) / 2
    covariance[[2, 5], [2, 5]] += shared / radius ** 2
    return WarpFit(numbers, covariance, agrees)


def warp_matrix(numbers: np.ndarray, size: Tuple[int, int]) -> np.ndarray:
    """
    Give a warp as a homography of undistorted px, shape (3, 3).

    :param numbers: Shape (8,).
    """
    width, height = size
    radius = np.hypot(width, height) / 2
    to_places = np.array([[1 / radius, 0, -(width - 1) / 2 / radius],
                          [0, 1 / radius, -(height - 1) / 2 / radius], [0, 0, 1]])
    warp = np.eye(3) + np.append(numbers, 0.0).reshape(3, 3)
    return np.linalg.inv(to_places) @ warp @ to_places


def _shared_variance(
    places: np.ndarray, residuals: np.ndarray, size: Tuple[int, int]
) -> float:
    # In px²: of the residuals' means over blocks, beyond what noise leaves of them.
    columns, rows = (np.clip((along * count / length).astype(int), 0, count - 1)
                     for along, count, length in zip(places.T, _BIAS_BLOCKS, size))
    blocks = rows * _BIAS_BLOCKS[0] + columns
    beyond = []
    for block in range(_BIAS_BLOCKS[0] * _BIAS_BLOCKS[1]):
        inside = residuals[blocks == block]
        if len(inside) >= _LEAST_FOR_BIAS:
            beyond.append(inside.mean(axis=0) ** 2 - inside.var(axis=0) / (len(inside) - 1))
    return max(0.0, float(np.mean(beyond))) if beyond else 0.0


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
