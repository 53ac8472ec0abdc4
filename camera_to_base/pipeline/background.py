# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The background: taken while the camera is at rest, kept with its age."""

import time
from typing import Optional

from camera_to_base.detection import BackgroundTaker
from camera_to_base.errors import Level, Reason
from camera_to_base.pipeline.stage import FrameRecord, Stage
from camera_to_base.pipeline.standpoint import Background
from camera_to_base.pipeline.view.quick_look import QuickLook
import numpy as np

# A camera that has swung stands still when nothing has moved for so long: at the end of a swing it
# is slow. A surface that moves by itself (a belt) does not come to rest at all.
_STILL_S, _LONGEST_WAIT_S = 0.5, 3.0
# So many pairs of frames in a row that have little in common are a movement; one may be damage.
_LEAST_DIFFERENT = 2

# The median of more frames outvotes a short movement, and to take it again would take long.
_MOST_RETAKEN = 50
_MOVING = Reason(
    'background_unsettled', Level.WARN,
    'taking the background: the view moves: wait until the camera stands still')


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


class BackgroundKeeper(Stage):
    """
    Takes backgrounds; holds frames back while there is none.

    :param confirm: Whether a frame counts only if the next one agrees with it.

    `current` is the background in use; None while one is taken. `frame_count` is the number of
    frames that the last one was made of.
    """

    def __init__(self, confirm: bool) -> None:
        self._confirm = confirm
        self.current: Optional[Background] = None
        self.frame_count = 0
        self._before: Optional[Background] = None
        self._taker: Optional[BackgroundTaker] = None
        self._rest = CameraAtRest()

    @property
    def reason(self) -> Optional[Reason]:
        """Why there is no background; None where there is one."""
        if self._taker is None:
            return None
        is_moving = self._rest.is_awaited and not self._taker.is_unsettled
        return _MOVING if is_moving else self._taker.reason

    def take(self, frame_count: int) -> None:
        """Take a background from the next frames."""
        self._before = self.current or self._before
        self._taker, self._rest = BackgroundTaker(frame_count), CameraAtRest()
        self.current = None

    def use(self, background: Background) -> None:
        """Use a background."""
        self.current, self._taker = background, None

    def keep_before(self) -> Optional[Background]:
        """Stop taking a background; give the one that was used before, None where none was."""
        if self.current is None and self._before is not None:
            self.use(self._before)
        return self.current

    def add(self, frame: np.ndarray, now: Optional[float]) -> Optional[Background]:
        """
        Add a frame while a background is taken.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param now: Its time, in s; None for a recording.
        :returns: The background if it is complete now.
        """
        picture = self._taker.add(frame, confirm=self._confirm)
        if picture is None:
            if self._taker.is_unsettled:
                self._rest.note_difference(frame, now)
            return None
        if self._confirm and not self._may_use(picture, frame, now):
            self._taker = self._taker.begun_again(frame)
            return None
        self.frame_count = self._taker.taken_count
        self.use(Background(picture, time.monotonic(), frame if self._confirm else None))
        return self.current

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Take the frame into the background while one is taken, and hold it back."""
        if self.current is None:
            taken = self.add(record.frame, record.now)
            if taken is not None:
                record = record._replace(standpoint=record.standpoint.with_background(taken))
        return record if self.reason is None else record.held(self.reason)

    def _may_use(self, picture: np.ndarray, frame: np.ndarray, now: float) -> bool:
        return self._taker.taken_count > _MOST_RETAKEN or self._rest.may_use(picture, frame, now)
