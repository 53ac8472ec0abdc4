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

"""Follows corners of one picture into another, whatever the light of each."""

from typing import NamedTuple

from camera_to_base.trust.noise import smoothed_noise
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
