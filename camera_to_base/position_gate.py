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

"""Decides whether a position may be published."""

import time
from typing import Optional

from camera_to_base.detection import Pixel
from camera_to_base.jump_filter import JumpFilter


class PositionGate:
    """
    Lets positions through that an arm may follow.

    :param max_age_s: The oldest frame of a live camera that a position may come from.
    :param jump_radius_px: See :class:`JumpFilter`.
    """

    def __init__(self, max_age_s: float, jump_radius_px: float) -> None:
        self.view_problem: Optional[str] = None
        self.configure(max_age_s, jump_radius_px)

    def configure(self, max_age_s: float, jump_radius_px: float) -> None:
        """Use other limits from now on."""
        self._max_age_s = max_age_s
        self._jumps = JumpFilter(jump_radius_px)

    def reason(self, pixel: Pixel, taken_at: Optional[float]) -> Optional[str]:
        """
        Tell why the position of one frame is held back.

        :param pixel: Where the object was seen.
        :param taken_at: When the frame was taken, by time.monotonic(); None where a frame waits
            for its reader, as those of a file do: it is never too old, and nothing damages it.
        :returns: None where it may be published.
        """
        confirmed = taken_at is None or self._jumps.accepts(pixel)
        if self.view_problem is not None:
            return 'positions held back: the view has moved'
        if not confirmed:
            return 'positions held back: not confirmed by a second frame'
        if taken_at is not None and time.monotonic() - taken_at > self._max_age_s:
            return 'positions held back: detection took too long'
        return None
