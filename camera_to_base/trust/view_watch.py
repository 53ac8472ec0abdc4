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

"""Asks every few seconds whether the view is still that of the background."""

import time
from typing import Optional

from camera_to_base.reason import Reason
from camera_to_base.trust.limits import Limits
from camera_to_base.trust.view_check import View, view_reason, ViewCheck
import numpy as np


class ViewWatch:
    """
    Compares frames with the background now and then, and keeps the answer in between.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param at_once: Whether the first frame is compared already.
    """

    def __init__(self, background: np.ndarray, limits: Limits, at_once: bool = False) -> None:
        self.view: Optional[View] = None
        self._check = ViewCheck(background)
        self._limits = limits
        self._reason: Optional[Reason] = None
        self._checked_at = -np.inf if at_once else time.monotonic()

    def configure(self, limits: Limits) -> None:
        """Use other limits from the next frame on."""
        self._limits, self._checked_at = limits, -np.inf

    def reason(self, frame: np.ndarray) -> Optional[Reason]:
        """
        Tell why the view of a frame cannot be believed.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        """
        limits = self._limits
        if not limits.max_shift_px:
            self._reason = None
        elif time.monotonic() - self._checked_at >= limits.check_period_s:
            self.view = self._check.compare(frame)
            self._checked_at = time.monotonic()
            self._reason = view_reason(
                self.view, limits.max_shift_px, limits.max_changed_share)
        return self._reason
