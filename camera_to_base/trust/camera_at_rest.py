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

"""Tells whether the camera stands still while the background is taken."""

from typing import Optional

from camera_to_base.trust.view.quick_look import QuickLook
import numpy as np

# A camera that has swung stands still when nothing has moved for so long: at the end of a swing it
# is slow. A surface that moves by itself (a belt) does not come to rest at all.
_STILL_S, _LONGEST_WAIT_S = 0.5, 3.0
# So many pairs of frames in a row that have little in common are a movement; one may be damage.
_LEAST_DIFFERENT = 2


class CameraAtRest:
    """
    Follows the view from when it is first seen to move until it has been at rest for a while.

    Without structure a movement cannot be seen. `is_awaited` tells whether the rest is waited for.
    """

    def __init__(self) -> None:
        self.is_awaited = False
        self._different_count = 0
        self._began_at = self._since = 0.0
        self._seen: Optional[_Seen] = None

    def note_difference(self, frame: np.ndarray, now: float) -> None:
        """
        Note that a frame has little in common with the one before it.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param now: Its time, in s.
        """
        self._different_count += 1
        if self._different_count >= _LEAST_DIFFERENT:
            self._await(frame, now)

    def may_use(self, background: np.ndarray, witness: np.ndarray, now: float) -> bool:
        """
        Tell whether a background may be used.

        :param background: Shape (h, w, 3), uint8, BGR.
        :param witness: The frame after it, of the same shape.
        :param now: Its time, in s.
        """
        self._different_count = 0
        if (self._seen or _Seen(background)).has_moved(witness):
            self._await(witness, now)
        self.is_awaited = self._seen is not None and (
            now - self._since < _STILL_S and now - self._began_at < _LONGEST_WAIT_S)
        return not self.is_awaited

    def _await(self, frame: np.ndarray, now: float) -> None:
        if self._seen is None:
            self._began_at = now
        self._seen, self._since, self.is_awaited = _Seen(frame), now, True


class _Seen:
    """What the camera saw when the view was last seen to move."""

    def __init__(self, frame: np.ndarray) -> None:
        self._shape, self._look = frame.shape, QuickLook(frame)

    def has_moved(self, frame: np.ndarray) -> bool:
        return frame.shape != self._shape or self._look.has_moved(frame)
