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

"""Tells whether the camera still looks at the surface from where the background was taken."""

from typing import NamedTuple, Optional

import cv2
import numpy as np

_WIDTH, _SMALLEST = 320, 24
# Brightness that changes more slowly than this, in px of the small picture, is light, not place.
_LIGHT_SIGMA = 6.0
# Where an aligned frame differs from the background by more grey levels an object lies.
_OBJECT_LEVELS = 8.0
_FAINTEST_LEVELS, _LEAST_STRUCTURE = 2.0, 0.01
_CLIP_LEVELS = 30.0
# ECC stops after this many steps, or where its correlation grows by less.
_STEPS = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 100, 1e-6)
# Below this correlation the surface has too little on it for a comparison, or is another one.
_LOWEST_CORRELATION = 0.4


class View(NamedTuple):
    """
    How a frame's view compares to the background's.

    :param shift_px: How far the picture's centre or a corner has moved, the farthest of them, in
        px; None where it cannot be told.
    :param changed_share: How much of the background's structure is not there, 0..1.
    """

    shift_px: Optional[float]
    changed_share: float


class ViewCheck:
    """
    Compares frames with the background on what is not an object.

    The frame is aligned to the background by a shift and a rotation (ECC, Evangelidis and
    Psarakis 2008, which neither gain nor offset of the light changes), from where
    phase correlation places it and from where it was, with all of it and without what differs;
    the alignment that explains the most of the picture is done once more without the rest.

    :param background: Shape (h, w, 3), uint8, BGR.
    """

    def __init__(self, background: np.ndarray) -> None:
        self._scale = max(1.0, background.shape[1] / _WIDTH)
        # An object is a strong structure: on a faint surface it must not pull the alignment.
        self._limit = _CLIP_LEVELS
        deviation = float(self._structure(background).std())
        self._limit = min(_CLIP_LEVELS, max(_FAINTEST_LEVELS, 4 * deviation))
        self._object_levels = min(_OBJECT_LEVELS, max(_FAINTEST_LEVELS, 2 * deviation))
        self._small = self._structure(background)
        self._is_large_enough = min(self._small.shape) >= _SMALLEST
        if self._is_large_enough:
            self._window = cv2.createHanningWindow(self._small.shape[::-1], cv2.CV_32F)

    def compare(self, frame: np.ndarray) -> View:
        """
        Compare a frame of the background's size.

        A surface of one colour cannot tell a shift, neither can one that is mostly covered.
        """
        if not self._is_large_enough:
            return View(None, 0.0)
        small = self._structure(frame)
        still = np.eye(2, 3, dtype=np.float32)
        (du, dv), _ = cv2.phaseCorrelate(self._small, small, self._window)
        moved = np.array([[1, 0, du], [0, 1, dv]], np.float32)
        starts = [still, self._align(small, still, None), self._align(small, moved, None),
                  self._align(small, still, self._unchanged(small, still))]
        best = max((start for start in starts if start is not None),
                   key=lambda warp: self._unchanged(small, warp).mean())
        mask = self._unchanged(small, best)
        refined = self._align(small, best, mask)
        changed_share = self._changed_share(self._same(small, best))
        if refined is None:
            return View(None, changed_share)
        return View(self._shift(refined), changed_share)

    def _structure(self, picture: np.ndarray) -> np.ndarray:
        grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
        size = [max(1, round(length / self._scale)) for length in grey.shape[::-1]]
        small = cv2.resize(grey, size, interpolation=cv2.INTER_AREA).astype(np.float32)
        detail = small - cv2.GaussianBlur(small, (0, 0), _LIGHT_SIGMA)
        return np.clip(detail, -self._limit, self._limit)

    def _align(
        self, small: np.ndarray, start: np.ndarray, mask: Optional[np.ndarray]
    ) -> Optional[np.ndarray]:
        try:
            correlation, warp = cv2.findTransformECC(
                self._small, small, start.copy(), cv2.MOTION_EUCLIDEAN, _STEPS, mask, 5)
        except cv2.error:
            return None  # it does not converge where there is nothing to hold on to
        return warp if correlation > _LOWEST_CORRELATION else None

    def _unchanged(self, small: np.ndarray, warp: np.ndarray) -> np.ndarray:
        return cv2.erode(self._same(small, warp), np.ones((5, 5), np.uint8), borderValue=255)

    def _same(self, small: np.ndarray, warp: np.ndarray) -> np.ndarray:
        size = small.shape[1], small.shape[0]
        aligned = cv2.warpAffine(small, warp, size, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
                                 borderValue=1e6)
        return (np.abs(aligned - self._small) <= self._object_levels).astype(np.uint8) * 255

    def _changed_share(self, same: np.ndarray) -> float:
        # Of the background's own structure: elsewhere there is nothing that could be missed.
        structure = np.abs(self._small) > self._object_levels
        if structure.mean() < _LEAST_STRUCTURE:
            return 0.0
        return 1.0 - float(same[structure].mean()) / 255

    def _shift(self, warp: np.ndarray) -> float:
        height, width = self._small.shape
        points = np.array([[0, 0, 1], [width, 0, 1], [0, height, 1], [width, height, 1],
                           [width / 2, height / 2, 1]])
        moved = points @ warp.T.astype(float) - points[:, :2]
        return float(np.hypot(*moved.T).max() * self._scale)


def view_problem(view: View, max_shift_px: float, max_changed_share: float) -> Optional[str]:
    """
    Tell why positions cannot be believed.

    :returns: None where they can, or where it cannot be told.
    """
    if view.shift_px is not None and view.shift_px > max_shift_px:
        return (f'the view has moved by {view.shift_px:.1f} px: move the camera back, or clear '
                'the surface, call ~/capture_background, and calibrate anew')
    if view.shift_px is None and view.changed_share > max_changed_share:
        return (f'{view.changed_share:.0%} of the view differs from the background: uncover the '
                'surface, or clear it and call ~/capture_background')
    return None
