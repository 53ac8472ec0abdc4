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
Square markers (ArUco) in a picture; the only module that knows OpenCV's interfaces to them.

OpenCV 4.7 and later have classes, 4.6 has functions. Where OpenCV was built without the module
aruco, everything else works.
"""

from types import ModuleType
from typing import Any, Collection, Dict, Optional, Tuple

from camera_to_base.errors import CalibrationError
import cv2
import numpy as np

# Cells along an edge of a marker, its black border included.
CELLS = 6
# The dictionaries of 4 x 4 bits are the beginnings of the longest one: marker 3 is the same in
# all of them.
MARKER_COUNT = 250
NO_ARUCO = (
    f'OpenCV {cv2.__version__} was built without markers: install python3-opencv of Ubuntu, or '
    'opencv-contrib-python-headless of the same version from PyPI')


# Markers are first looked for in a picture of at most this width: a marker that is 30 px wide
# there is decoded, and a larger picture takes longer.
_SEARCH_WIDTH = 800
# Windows of the searches' thresholds, the least, the largest and the step: markers on a table are
# larger than on a board.
_WINDOWS, _WINDOWS_THOROUGH = (13, 33, 20), (23, 53, 30)
# Share of a marker's outline: with the 0.125 of newer OpenCV the outline of the paper, a cell
# away, stands for the marker, and is not decoded.
_LEAST_DISTANCE_RATE = 0.05


def find_markers(grey: np.ndarray) -> Dict[int, np.ndarray]:
    """
    Find the markers in a picture, of 4 x 4 bits, with their corners to a fraction of a pixel.

    :param grey: Shape (h, w), uint8.
    :returns: By the marker's number its corners, shape (4, 2), u and v, in px: as it is printed,
        from the top left clockwise. A number that is there twice is left out.
    :raises CalibrationError: If OpenCV has no module aruco.
    """
    aruco = _aruco()
    parameters = _parameters(aruco)
    parameters.cornerRefinementMethod = aruco.CORNER_REFINE_SUBPIX
    return _detected(aruco, grey, parameters)


def search_markers(
    grey: np.ndarray, expected: Optional[Collection[int]] = None
) -> Dict[int, np.ndarray]:
    """
    Search a table for markers, in less time, with their corners to a few pixels.

    :param grey: Shape (h, w), uint8.
    :param expected: A large picture is searched in full size, too, if one of these is not found
        in a reduced one; None for always.
    :returns: As :func:`find_markers`.
    :raises CalibrationError: If OpenCV has no module aruco.
    """
    times = -(-grey.shape[1] // _SEARCH_WIDTH)
    small = cv2.resize(grey, (grey.shape[1] // times, grey.shape[0] // times),
                       interpolation=cv2.INTER_AREA) if times > 1 else grey
    scale = np.divide(grey.shape[::-1], small.shape[::-1])
    found = {number: (corners + 0.5) * scale - 0.5
             for number, corners in _searched(small, _WINDOWS).items()}
    if expected is not None and set(expected) <= set(found):
        return found
    more = _searched(grey, _WINDOWS_THOROUGH)
    return {number: corners for number, corners in {**more, **found}.items()
            if _is_same_place(corners, more.get(number, corners))}


def has_markers() -> bool:
    """Return whether OpenCV has the module aruco."""
    return hasattr(cv2, 'aruco')


def marker_cells(number: int) -> np.ndarray:
    """
    Return a marker to print.

    :param number: 0 to MARKER_COUNT - 1.
    :returns: Shape (6, 6), whether each cell is black, the border included.
    :raises CalibrationError: If OpenCV has no module aruco.
    """
    aruco = _aruco()
    draw = getattr(aruco, 'generateImageMarker', None) or aruco.drawMarker
    return draw(_dictionary(aruco), number, CELLS) < 128


def _searched(grey: np.ndarray, windows: Tuple[int, int, int]) -> Dict[int, np.ndarray]:
    aruco = _aruco()
    parameters = _parameters(aruco)
    least, largest, step = windows
    parameters.adaptiveThreshWinSizeMin = least
    parameters.adaptiveThreshWinSizeMax = largest
    parameters.adaptiveThreshWinSizeStep = step
    return _detected(aruco, grey, parameters)


def _detected(aruco: ModuleType, grey: np.ndarray, parameters: Any) -> Dict[int, np.ndarray]:
    if hasattr(aruco, 'ArucoDetector'):
        corners, ids, _ = aruco.ArucoDetector(_dictionary(aruco), parameters).detectMarkers(grey)
    else:
        corners, ids, _ = aruco.detectMarkers(grey, _dictionary(aruco), parameters=parameters)
    found: Dict[int, np.ndarray] = {}
    twice = set()
    for number, shown in zip([] if ids is None else ids.ravel().tolist(), corners):
        quad = shown.reshape(4, 2).astype(float)
        if not _is_same_place(found.setdefault(number, quad), quad):
            twice.add(number)
    return {number: quad for number, quad in found.items() if number not in twice}


def _is_same_place(one: np.ndarray, other: np.ndarray) -> bool:
    apart = np.linalg.norm(one.mean(axis=0) - other.mean(axis=0))
    return bool(apart < np.linalg.norm(one[0] - one[2]) / 4)


def _parameters(aruco: ModuleType) -> Any:
    make = getattr(aruco, 'DetectorParameters_create', None) or aruco.DetectorParameters
    parameters = make()
    parameters.minMarkerDistanceRate = _LEAST_DISTANCE_RATE
    return parameters


def _aruco() -> ModuleType:
    if not has_markers():
        raise CalibrationError(NO_ARUCO)
    return cv2.aruco


def _dictionary(aruco: ModuleType) -> Any:
    get = getattr(aruco, 'getPredefinedDictionary', None) or aruco.Dictionary_get
    return get(aruco.DICT_4X4_250)


def paper_corners(corners: np.ndarray) -> np.ndarray:
    """
    Return the corners of a marker's paper: of a white cell on each side of its black square.

    :param corners: Of the black square, shape (4, 2), in any unit.
    :returns: The same shape.
    """
    middle = corners.mean(axis=0)
    return middle + (CELLS + 2) / CELLS * (corners - middle)
