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

"""Leaves out what belongs to a hand or an arm, or is touched or covered by it."""

from collections import deque
from functools import reduce
from typing import Deque, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection import Detection, Found, LeftOut, LocatedObject
from camera_to_base.reason import Level, Reason
from camera_to_base.trust.reaching_in import covers, ReachingIn
import cv2
import numpy as np

# So long what appears where something reached in may still belong to it: a hand that is lifted or
# drawn back.
_MEMORY_S = 1.0
# An object is at rest, and whole, while its area and centre stay this close, as a share and in px.
_SAME_AREA, _SAME_CENTRE_PX = 0.05, 2.0
# So long an object is known though it is not seen: something covers it.
_KNOWN_S = 10.0
_MOST_KNOWN = 100

_TOUCHED = Reason(
    'touched', Level.WARN, 'something that reaches in from the edge of the picture touches, '
    'covers or shades it: take hands and arms out of the view', is_passing=True)
_WAS_TOUCHED = Reason(
    'touched', Level.WARN, 'it appeared where something reached in less than a second ago',
    is_passing=True)


class _Known(NamedTuple):
    detection: Detection
    seen_at: float


class ArmCheck:
    """
    Tells free objects from what reaches in, what that touches, and what it leaves behind.

    :param background: Shape (h, w, 3), uint8, BGR.
    """

    def __init__(self, background: np.ndarray) -> None:
        self._reaching_in = ReachingIn(background)
        self._fills: Deque[Tuple[float, np.ndarray]] = deque()
        self._known: List[_Known] = []

    def check(self, frame: np.ndarray, found: Found, taken_at: Optional[float],
              shift_px: float = 0.0) -> Found:
        """
        Leave out what is not free.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :param taken_at: In s; None for a recording, of which each frame stands for itself.
        :param shift_px: How far the view has moved, in px.
        """
        if not found.objects and not found.left_out and not self._fills:
            return found
        fill = self._reaching_in.find(frame, shift_px)
        if taken_at is None:
            reasons = [_TOUCHED if self._is_covered(one, fill) else None
                       for one in found.objects]
        else:
            reasons = self._reasons(found.objects, fill, taken_at)
        return _divided(found, reasons)

    def _reasons(self, objects: Sequence[LocatedObject], fill: np.ndarray,
                 taken_at: float) -> List[Optional[Reason]]:
        while self._fills and not 0 <= taken_at - self._fills[0][0] <= _MEMORY_S:
            self._fills.popleft()
        recent = reduce(cv2.max, (mask for _, mask in self._fills), fill)
        if fill.any():
            self._fills.append((taken_at, fill))
        self._known = [known for known in self._known
                       if 0 <= taken_at - known.seen_at <= _KNOWN_S]
        return [self._reason(one, fill, recent, taken_at) for one in objects]

    def _reason(self, one: LocatedObject, fill: np.ndarray, recent: np.ndarray,
                taken_at: float) -> Optional[Reason]:
        known = next((known for known in self._known if _is_same(
            known.detection, one.detection)), None)
        if not self._is_covered(one, recent):
            self._know(known, one.detection, taken_at)
            return None
        if known is not None:
            # What it looked like when it was free stays the measure.
            self._know(known, known.detection, taken_at)
            return None
        return _TOUCHED if self._is_covered(one, fill) else _WAS_TOUCHED

    def _know(self, known: Optional[_Known], detection: Detection, taken_at: float) -> None:
        others = [other for other in self._known if other is not known]
        self._known = [_Known(detection, taken_at), *others][:_MOST_KNOWN]

    def _is_covered(self, one: LocatedObject, mask: np.ndarray) -> bool:
        return covers(mask, one.detection.outline, self._reaching_in.scale)


def _is_same(one: Detection, other: Detection) -> bool:
    moved = max(abs(one.centre.u - other.centre.u), abs(one.centre.v - other.centre.v))
    return (moved <= _SAME_CENTRE_PX
            and abs(one.area - other.area) <= _SAME_AREA * one.area)


def _divided(found: Found, reasons: Sequence[Optional[Reason]]) -> Found:
    pairs = list(zip(found.objects, reasons))
    touched = tuple(LeftOut(one.detection, reason) for one, reason in pairs if reason is not None)
    return Found([one for one, reason in pairs if reason is None], (*found.left_out, *touched))
