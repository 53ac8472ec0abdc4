# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Asks of every frame whether its view is that of the background."""

from typing import NamedTuple, Optional, Tuple

from camera_to_base.errors import Level, Reason
from camera_to_base.pipeline.sighting import Limits
from camera_to_base.pipeline.view.quick_look import QuickLook, ViewLook
from camera_to_base.pipeline.view.view_check import View, view_reason, ViewCheck
import cv2
import numpy as np

# The look clears a frame where this share of the structure agrees, on a motion of this share of
# view.max_shift_px: beyond, the look is not exact.
_LEAST_SHARE, _LARGEST_MOTION = 0.35, 0.65
# The full comparison counts where the look agrees with it once the frame is moved back: this share
# of the structure, and of the patches that have not changed, on so many px at most.
_LEAST_SHARE_OF_FULL, _LEAST_PATCHES, _LEFT_PX = 0.1, 0.6, 1.5
# Where the full comparison finds no shift, less structure counts if it agrees on less motion, and
# the less the more of the picture is as it was: share, share of view.max_shift_px, changed share.
_LESS = ((0.2, 0.4, 1.0), (0.1, 0.23, 0.5))
# A frame is moved back where it has shifted by more than this, in px: less is the look's error.
_LEAST_MOVED_PX = 0.8
# Where the view is not checked, a frame that has shifted by more than this shows another place.
_IN_PLACE_PX = 2.0


class FrameMotion(NamedTuple):
    """
    How the view of a frame has moved since the background was taken.

    :param shift_px: How far, as far as that is known, in px.
    :param is_in_place: Whether it can be compared with the background place by place.
    :param matrix: Shape (2, 3) or (3, 3), maps the background's pixels to the frame's; None where
        that is not known well.
    """

    shift_px: float = 0.0
    is_in_place: bool = True
    matrix: Optional[np.ndarray] = None

    def moved_back(self, frame: np.ndarray) -> np.ndarray:
        """
        Give the frame as the camera would see it from where the background was taken.

        An edge of the surface that has moved by a pixel would be an object to a detector.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :returns: The same array where it has hardly moved, or its motion is not known well.
        """
        if self.matrix is None or self.shift_px < _LEAST_MOVED_PX:
            return frame
        return _moved_back(frame, self.matrix)


class ViewWatch:
    """
    Compares each frame with the background: a quick look first, all of it where that is not sure.

    A frame is cleared where its shift was measured and is within the limit. On a surface without
    structure nothing can be measured, nor along the lines of one that has nothing but parallel
    lines: there frames are not held back.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param witness: See :class:`QuickLook`.

    `view` is what was found of the last frame, and `motion` what follows for its pixels.
    """

    def __init__(
        self, background: np.ndarray, limits: Limits, witness: Optional[np.ndarray] = None
    ) -> None:
        self.view: Optional[View] = None
        self._is_in_place = True
        self._matrix: Optional[np.ndarray] = None
        self._held_back: Optional[Reason] = None
        self._look = QuickLook(background, witness)
        self._check = ViewCheck(background)
        self._limits = limits

    @property
    def motion(self) -> FrameMotion:
        """How the view of the last frame has moved."""
        shift_px = (self.view.shift_px or 0.0) if self.view is not None else 0.0
        return FrameMotion(shift_px, self._is_in_place, self._matrix)

    def configure(self, limits: Limits) -> None:
        """Use other limits from the next frame on."""
        self._limits = limits

    def reason(self, frame: np.ndarray, in_full: bool = True) -> Optional[Reason]:
        """
        Tell why the view of a frame cannot be believed.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :param in_full: Whether to compare all of it where the look is not sure. Otherwise it is
            held back for the same reason as the frame before it, if that was held back.
        """
        self._matrix = None
        look = self._looked(frame)
        if not self._limits.max_shift_px:
            self.view = None
            self._is_in_place = not self._look.surface_moves and (look is None or (
                look.share >= _LEAST_SHARE and look.shift_px <= _IN_PLACE_PX))
            return None
        reason = self._held_back = self._checked(frame, look, in_full)
        self._is_in_place = reason is None and not self._look.surface_moves
        return reason

    def _checked(
        self, frame: np.ndarray, look: Optional[ViewLook], in_full: bool
    ) -> Optional[Reason]:
        if look is None:
            self.view = View(None, 0.0, has_structure=False)
            return None
        if self._is_sure(look):
            self.view = View(look.shift_px, 1 - look.share, tells_all=self._look.tells_all)
            self._matrix = look.matrix
            self._look.learn(look)
            return None
        if self._held_back is not None and not in_full:
            return self._held_back
        return self._full_reason(frame, look)

    def _looked(self, frame: np.ndarray) -> Optional[ViewLook]:
        glance = self._look.glance(frame)
        is_enough = glance is not None and (
            not self._limits.max_shift_px or self._is_sure(glance))
        return glance if is_enough else self._look.look(frame)

    def _is_sure(self, look: ViewLook) -> bool:
        limits = self._limits
        return (look.share >= max(_LEAST_SHARE, 1 - limits.max_changed_share)
                and look.shift_px <= _LARGEST_MOTION * limits.max_shift_px)

    def _full_reason(self, frame: np.ndarray, look: ViewLook) -> Optional[Reason]:
        limits = self._limits
        view = self._check.compare(frame)._replace(
            has_structure=True, tells_all=self._look.tells_all)
        if not view.tells_all:
            # The full comparison takes a step from line to line for none.
            view = view._replace(shift_px=None, matrix=None)
        matrix, left = look.matrix, None
        if view.shift_px is not None and view.shift_px <= limits.max_shift_px:
            matrix = np.array(view.matrix)
            # What is left of the motion is small enough for the look; it tells a tilt, too.
            left = self._look.look(_moved_back(frame, matrix))
            if _is_tilt(left):
                matrix = np.vstack([matrix, (0.0, 0.0, 1.0)]) @ left.matrix
                view = view._replace(shift_px=_farthest_px(matrix, frame.shape[1::-1]))
        self.view = view
        reason = view_reason(view, limits.max_shift_px, limits.max_changed_share)
        if reason is not None:
            return reason
        is_cleared = (_agrees(left, view.changed_share) if view.shift_px is not None
                      else self._is_likely(look, view.changed_share))
        if not is_cleared:
            self._look.learn_noise(frame)
            return _unknown(look)
        self._matrix = matrix
        self._look.learn(look if left is None else left, in_full=True)
        return None

    def _is_likely(self, look: ViewLook, changed_share: float) -> bool:
        return any(
            look.share >= share and changed_share <= most_changed
            and look.shift_px <= motion * self._limits.max_shift_px
            for share, motion, most_changed in _LESS)


def _is_tilt(left: ViewLook) -> bool:
    return left.share >= _LEAST_SHARE and len(left.matrix) == 3


def _agrees(left: ViewLook, changed_share: float) -> bool:
    return _is_tilt(left) or (
        left.share >= _LEAST_SHARE_OF_FULL and left.shift_px <= _LEFT_PX
        and left.patch_share >= _LEAST_PATCHES * (1 - changed_share))


def _moved_back(frame: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    warp = cv2.warpAffine if len(matrix) == 2 else cv2.warpPerspective
    return warp(frame, matrix, frame.shape[1::-1],
                flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE)


def _farthest_px(matrix: np.ndarray, size: Tuple[int, int]) -> float:
    # Of the picture's corners and its centre, shape (3, 3).
    width, height = size
    places = np.array([[[0, 0], [width, 0], [0, height], [width, height],
                        [width / 2, height / 2]]], float)
    return float(np.linalg.norm(cv2.perspectiveTransform(places, matrix) - places, axis=2).max())


def _unknown(look: ViewLook) -> Reason:
    return Reason('view_unknown', Level.WARN, (
        f'whether the view has moved cannot be told, {look.share:.0%} of its structure is in '
        'place: uncover the surface, or clear it and call ~/capture_background'), is_passing=True)
