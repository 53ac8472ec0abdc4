# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Square markers (ArUco) in a picture, with their corners to a few hundredths of a pixel.

OpenCV 4.7 and later have classes, 4.6 has functions. Where OpenCV was built without the module
aruco, everything else works.

Across an edge the light rises from the black border to the white margin. The step's place is taken
from the area below the profile, which blur does not move where the profile is of linear light: the
camera's gamma is undone. Of some dozens of places along an edge the line is fitted where the lens
has no distortion.
"""

from types import ModuleType
from typing import Any, Collection, Dict, NamedTuple, Optional, Tuple

from camera_to_base.errors import CalibrationError
from camera_to_base.surface import RadialDistortion
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

# Half the length of a profile: a share of a cell, within limits in px.
_PROFILE_SHARE, _LEAST_HALF_PX, _LARGEST_HALF_PX = 0.4, 1.5, 5.0
_STEP_PX = 0.5
# The ends of an edge are left out: there the profile shows the next edge.
_ALONG = np.linspace(0.1, 0.9, 40)
# A line through values along an edge, by least squares: values @ _SMOOTHER.
_LINE = np.vander(_ALONG, 2)
_SMOOTHER = (_LINE @ np.linalg.pinv(_LINE)).T
_MOST_ROUNDS, _STANDS_STILL_PX = 3, 0.2
# A place counts where it lies this near to its line, and an edge where most of its places count.
_OUTLIER, _LEAST_LIMIT_PX, _LARGEST_LIMIT_PX = 3.0, 0.08, 0.6
_LEAST_SHARE = 0.6
# Brightness of the margin minus that of the border, in grey levels.
_LEAST_CONTRAST = 15.0
# Of most cameras, and of sRGB.
_GAMMA = 2.2
_LIGHT = (np.arange(256) / 255) ** _GAMMA

# The numbers of markers that may lie on a table: a ChArUco board has those from 10 on.
TABLE_MARKERS = range(10)


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


def corners_by_edges(
    grey: np.ndarray, corners: np.ndarray, lens: RadialDistortion
) -> Optional[np.ndarray]:
    """
    Refine a marker's corners.

    :param grey: Shape (h, w), uint8.
    :param corners: Shape (4, 2), u and v, in px, a pixel or two off, clockwise as it is seen.
    :param lens: Edges are straight without its distortion.
    :returns: Shape (4, 2), in px; None if an edge is covered, or too faint.
    """
    edge_px = float(np.linalg.norm(corners - np.roll(corners, -1, axis=0), axis=1).min())
    half = min(max(_PROFILE_SHARE * edge_px / CELLS, _LEAST_HALF_PX), _LARGEST_HALF_PX)
    for _ in range(_MOST_ROUNDS):
        moved = _crossings(grey, corners, half, lens)
        if moved is None:
            return None
        step_px = float(np.linalg.norm(moved - corners, axis=1).max())
        if step_px > 2 * half:
            return None
        corners = moved
        if step_px < _STANDS_STILL_PX:
            break
    return corners


def _crossings(
    grey: np.ndarray, corners: np.ndarray, half: float, lens: RadialDistortion
) -> Optional[np.ndarray]:
    """Return where the lines along the edges cross, shape (4, 2), in px."""
    places = _step_places(grey, corners, half)
    if places is None:
        return None
    straight = lens.undistort(places.reshape(-1, 2)).reshape(places.shape)
    lines = _lines(straight)
    if lines is None:
        return None
    crossed = np.cross(np.roll(lines, 1, axis=0), lines)
    with np.errstate(all='ignore'):
        moved = lens.distort(crossed[:, :2] / crossed[:, 2:])
    return moved if np.isfinite(moved).all() else None


def _step_places(grey: np.ndarray, corners: np.ndarray, half: float) -> Optional[np.ndarray]:
    """Return where light rises across each edge, shape (4, n, 2), in px."""
    sides = np.roll(corners, -1, axis=0) - corners
    outwards = np.column_stack([sides[:, 1], -sides[:, 0]])
    outwards /= np.linalg.norm(sides, axis=1)[:, None]
    centres = corners[:, None] + _ALONG[:, None] * sides[:, None]
    steps = int(round(2 * half / _STEP_PX)) + 1
    offsets = np.linspace(-half, half, steps)
    profiles = _light(grey, centres[:, :, None] + offsets[:, None] * outwards[:, None, None])
    if profiles is None:
        return None
    ends = max(2, steps // 5)
    # Light changes little along an edge.
    dark = profiles[:, :, :ends].mean(axis=2) @ _SMOOTHER
    bright = profiles[:, :, -ends:].mean(axis=2) @ _SMOOTHER
    if (_grey_level(bright) - _grey_level(dark)).min() < _LEAST_CONTRAST:
        return None
    dark_share = (bright - profiles.mean(axis=2)) / (bright - dark)
    length = 2 * half * steps / (steps - 1)
    return centres + ((dark_share - 0.5) * length)[:, :, None] * outwards[:, None]


def _grey_level(light: np.ndarray) -> np.ndarray:
    return 255 * np.maximum(light, 0) ** (1 / _GAMMA)


def _light(grey: np.ndarray, places: np.ndarray) -> Optional[np.ndarray]:
    """Return the light at places (..., 2), 0 to 1; None if one is not in the picture."""
    flat = places.reshape(-1, 2)
    low, high = flat.min(axis=0), flat.max(axis=0)
    if not ((low >= 0).all() and (high <= np.subtract(grey.shape[::-1], 1)).all()):
        return None
    left, top = low.astype(int)
    right, bottom = high.astype(int) + 2
    part = _LIGHT[grey[top:bottom, left:right]].astype(np.float32)
    inside = (flat - (left, top)).astype(np.float32)
    # As rows of a picture that remap takes: fewer than 32,768 of each.
    found = cv2.remap(part, inside.reshape(places.shape[0], -1, 2), None, cv2.INTER_LINEAR,
                      borderMode=cv2.BORDER_REPLICATE)
    return found.reshape(places.shape[:-1]).astype(float)


def _lines(points: np.ndarray) -> Optional[np.ndarray]:
    """
    Fit a line to the points of each edge, without outliers.

    :param points: Shape (4, n, 2).
    :returns: Shape (4, 3), (a, b, c) with a x + b y + c = 0; None if points are in no line.
    """
    weights = np.ones(points.shape[:2])
    for _ in range(3):
        share = weights / weights.sum(axis=1)[:, None]
        centres = np.einsum('ij,ijk->ik', share, points)
        offsets = points - centres[:, None]
        xx, xy, yy = (np.einsum('ij,ij,ij->i', share, offsets[..., one], offsets[..., other])
                      for one, other in ((0, 0), (0, 1), (1, 1)))
        angles = np.arctan2(2 * xy, xx - yy) / 2
        normals = np.column_stack([-np.sin(angles), np.cos(angles)])
        away = np.abs(np.einsum('ijk,ik->ij', offsets, normals))
        limits = np.clip(_OUTLIER * 1.4826 * np.median(away, axis=1),
                         _LEAST_LIMIT_PX, _LARGEST_LIMIT_PX)
        weights = (away <= limits[:, None]).astype(float)
        if not (weights.mean(axis=1) >= _LEAST_SHARE).all():
            return None
    return np.column_stack([normals, -np.einsum('ik,ik->i', normals, centres)])


class SeenMarkers(NamedTuple):
    """
    Markers in a picture.

    :param corners: By the marker's number, shape (4, 2), u and v, in px, as it is printed from
        the top left clockwise.
    """

    corners: Dict[int, np.ndarray]


def see_markers(
    image: np.ndarray, lens: RadialDistortion, expected: Optional[Collection[int]] = None
) -> SeenMarkers:
    """
    Find the markers of a table.

    :param image: Shape (h, w, 3), uint8, BGR.
    :param lens: Of the camera; edges are straight without its distortion.
    :param expected: If all of these are found soon, no others are searched for; None for all.
    :raises CalibrationError: If OpenCV has no module aruco.
    """
    grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    refined = {number: corners_by_edges(grey, corners, lens)
               for number, corners in search_markers(grey, expected).items()
               if number in TABLE_MARKERS}
    return SeenMarkers({number: corners for number, corners in refined.items()
                        if corners is not None})
