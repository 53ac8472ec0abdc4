# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Tells whether the camera still looks at the surface from where the background was taken.

This is a yes or no for every frame that the quick look has not cleared, with a hand in view and on
a surface that shows little: 16 corners that agree on a shift, a rotation and a scale are enough,
found on an evened picture of 640 px at most. Where none agree, the share of the structure that is
still in its place decides. It knows no lens, and its shift is right to about a pixel: enough for a
limit of some px, not for a correction. That is measured by `nudge`, which in
return refuses most frames that this module can judge.
"""

from typing import List, NamedTuple, Optional, Tuple

from camera_to_base.detection import smoothed_noise
from camera_to_base.errors import Level, Reason
import cv2
import numpy as np

# The picture is made this long at most, in px; all lengths below are in its px.
_LONGEST, _SMALLEST = 640, 24
# Brightness that changes more slowly than this is light, what is finer is noise.
_LIGHT_WIDTH, _NOISE_SIGMA = 49, 1.5
# Detail is structure from this many standard deviations of the noise on, and from these levels.
_NOISE_DEVIATIONS, _FAINTEST_LEVELS = 4.0, 1.0
# Contrast is measured around each place: strong objects must not outshine a faint surface.
_PLACE_SIGMA, _GREY_LEVELS = 6.0, 60.0
# Corners are looked for in each cell, lest a cable or an arm in view has them all.
_CELLS, _CORNERS_PER_CELL, _CORNER_QUALITY, _CORNER_DISTANCE, _CORNER_SIZE = 4, 10, 0.1, 15, 11
# A higher pyramid finds larger shifts, and an object covers more of it.
_FLOW_WINDOW, _PYRAMID_LEVELS = (21, 21), (3, 5)
# How far a corner may be off after it was followed there and back, and off the common movement.
_THERE_AND_BACK_PX, _AGREE_PX = 1.0, 1.5
# On noise 5 corners agree by chance, and those of one object do not tell a rotation.
_LEAST_AGREEING, _LEAST_EXTENT = 16, 0.2
# A single mark tells nothing of the view: whatever is put on it has covered all there is.
_LEAST_STRUCTURE, _LEAST_SPREAD = 0.002, 0.5
# How much a place correlates with itself in noise or the dark, and with another place not.
_SAME_PLACE, _OTHER_PLACE = 0.5, 0.7


class View(NamedTuple):
    """
    How a frame's view compares to the background's.

    :param shift_px: How far the picture's centre or a corner has moved, the farthest of them, in
        px; None where it cannot be told.
    :param changed_share: How much of the background's structure is not there, 0..1.
    :param has_structure: Whether the background shows anything by which a shift could be told.
    :param matrix: Two rows of three numbers, maps the background's pixels to the frame's; None
        where it cannot be told.
    :param tells_all: Whether every movement could be told. Parallel lines tell none along them.
    """

    shift_px: Optional[float]
    changed_share: float
    has_structure: bool = True
    matrix: Optional[Tuple[Tuple[float, ...], ...]] = None
    tells_all: bool = True


class ViewCheck:
    """
    Compares frames with the background on what is not an object.

    Corners of the background are followed into the frame and back (optical flow, Lucas and
    Kanade 1981). The shift, rotation and scale on which most of them agree is the camera's
    (RANSAC): corners that an object or a hand covers do not agree with each other.

    :param background: Shape (h, w, 3), uint8, BGR.
    """

    def __init__(self, background: np.ndarray) -> None:
        height, width = background.shape[:2]
        self._scale = max(1.0, max(height, width) / _LONGEST)
        self._size = tuple(max(1, round(length / self._scale)) for length in (width, height))
        small = self._small(background)
        self._faintest = max(
            _FAINTEST_LEVELS, _NOISE_DEVIATIONS * smoothed_noise(small, _NOISE_SIGMA))
        self._detail = _detail(small)
        self._energy = _around(self._detail ** 2)
        self._picture = self._with_equal_contrast(self._detail, self._energy)
        # In a place of less energy noise alone would make a frame differ.
        self._structure = _without_edge((np.abs(self._detail) > self._faintest) & (
            self._energy > self._faintest ** 2 / 2))
        self._has_structure = bool(
            self._structure.mean() >= _LEAST_STRUCTURE
            and np.ptp(np.argwhere(self._structure), axis=0).max()
            >= _LEAST_SPREAD * max(self._size))
        self._corners = _find_corners(self._picture, self._structure)

    def compare(self, frame: np.ndarray) -> View:
        """
        Compare a frame of the background's size.

        A surface of one colour cannot tell a shift, neither can one that is mostly covered.
        """
        if min(self._size) < _SMALLEST:
            return View(None, 0.0, False)
        detail = _detail(self._small(frame))
        energy = _around(detail ** 2)
        picture = self._with_equal_contrast(detail, energy)
        # Lazy: the higher pyramid is for what the lower one cannot find.
        warps = (self._find_warp(picture, level) for level in _PYRAMID_LEVELS)
        warp = next((warp for warp in warps if warp is not None), None)
        changed_share = self._changed_share(detail, energy, warp)
        if warp is None:
            return View(None, changed_share, self._has_structure)
        return View(self._shift(warp), changed_share, self._has_structure,
                    tuple(map(tuple, (warp * (1, 1, self._scale)).tolist())))

    def _small(self, picture: np.ndarray) -> np.ndarray:
        grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
        return cv2.resize(grey, self._size, interpolation=cv2.INTER_AREA).astype(np.float32)

    def _with_equal_contrast(self, detail: np.ndarray, energy: np.ndarray) -> np.ndarray:
        contrast = np.sqrt(energy) + self._faintest
        return np.clip(128 + _GREY_LEVELS * detail / contrast, 0, 255).astype(np.uint8)

    def _find_warp(self, picture: np.ndarray, level: int) -> Optional[np.ndarray]:
        if len(self._corners) < _LEAST_AGREEING:
            return None
        flow = {'winSize': _FLOW_WINDOW, 'maxLevel': level}
        there, found, _ = cv2.calcOpticalFlowPyrLK(
            self._picture, picture, self._corners, None, **flow)
        back, found_back, _ = cv2.calcOpticalFlowPyrLK(
            picture, self._picture, there, None, **flow)
        missed_px = np.linalg.norm(back - self._corners, axis=2)
        followed = ((found & found_back) == 1) & (missed_px < _THERE_AND_BACK_PX)
        least_extent = _LEAST_EXTENT * max(self._size)
        return _consensus(self._corners[followed], there[followed], least_extent)

    def _changed_share(
        self, detail: np.ndarray, energy: np.ndarray, warp: Optional[np.ndarray]
    ) -> float:
        if not self._has_structure:
            return 0.0
        if warp is not None:
            detail = cv2.warpAffine(detail, warp, self._size,
                                    flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP)
            energy = _around(detail ** 2)
        # A correlation, as the light may have made the structure stronger or weaker.
        product = _around(detail * self._detail)
        least_correlation = _OTHER_PLACE if warp is None else _SAME_PLACE
        is_there = product > least_correlation * np.sqrt(energy * self._energy)
        # Of the background's own structure: elsewhere there is nothing that could be missed.
        return 1.0 - float(is_there[self._structure].mean())

    def _shift(self, warp: np.ndarray) -> float:
        width, height = self._size
        points = np.array([[0, 0, 1], [width, 0, 1], [0, height, 1], [width, height, 1],
                           [width / 2, height / 2, 1]])
        moved = points @ warp.T - points[:, :2]
        return float(np.hypot(*moved.T).max() * self._scale)


def _detail(picture: np.ndarray) -> np.ndarray:
    return (cv2.GaussianBlur(picture, (0, 0), _NOISE_SIGMA)
            - cv2.blur(picture, (_LIGHT_WIDTH, _LIGHT_WIDTH)))


def _around(values: np.ndarray) -> np.ndarray:
    return cv2.GaussianBlur(values, (0, 0), _PLACE_SIGMA)


def _without_edge(structure: np.ndarray) -> np.ndarray:
    # Light that changes evenly differs from its mean where that is cut off.
    inner, width = np.zeros_like(structure), _LIGHT_WIDTH // 2
    inner[width:-width, width:-width] = structure[width:-width, width:-width]
    return inner


def _find_corners(picture: np.ndarray, structure: np.ndarray) -> np.ndarray:
    # Corners of noise agree by chance, far away from the others.
    near = cv2.dilate(structure.astype(np.uint8), np.ones(_FLOW_WINDOW))
    height, width = (-(-length // _CELLS) for length in picture.shape)
    corners: List[np.ndarray] = [np.empty((0, 2), np.float32)]
    for v in range(0, picture.shape[0], height):
        for u in range(0, picture.shape[1], width):
            found = cv2.goodFeaturesToTrack(
                picture[v:v + height, u:u + width].copy(), _CORNERS_PER_CELL, _CORNER_QUALITY,
                _CORNER_DISTANCE, mask=near[v:v + height, u:u + width].copy(),
                blockSize=_CORNER_SIZE)
            if found is not None:
                corners.append(found[:, 0] + np.float32([u, v]))
    return np.concatenate(corners)[:, None]


def _consensus(
    here: np.ndarray, there: np.ndarray, least_extent: float
) -> Optional[np.ndarray]:
    if len(here) < _LEAST_AGREEING:
        return None
    warp, agree = cv2.estimateAffinePartial2D(here, there, ransacReprojThreshold=_AGREE_PX)
    if warp is None or agree.sum() < _LEAST_AGREEING:
        return None
    agreeing = here[agree.ravel() == 1]
    return warp if np.ptp(agreeing, axis=0).max() >= least_extent else None


def view_reason(view: View, max_shift_px: float, max_changed_share: float) -> Optional[Reason]:
    """
    Tell why positions cannot be believed.

    :returns: None where they can, or where it cannot be told.
    """
    if view.shift_px is not None and view.shift_px > max_shift_px:
        return Reason('view_moved', Level.ERROR, (
            f'the view has moved by {view.shift_px:.1f} px: move the camera back, or clear '
            'the surface, call ~/capture_background, and calibrate anew'))
    if view.changed_share > max_changed_share:
        return Reason('view_changed', Level.ERROR, (
            f'{view.changed_share:.0%} of the view differs from the background: uncover the '
            'surface, or clear it and call ~/capture_background'))
    return None
