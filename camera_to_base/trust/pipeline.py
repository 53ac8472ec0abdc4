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

"""From frames to objects that an arm may follow: background, detection, view check, gate."""

from collections import Counter
import time
from typing import List, NamedTuple, Optional, Tuple

from camera_to_base.detection import (
    BackgroundTaker, check_frame, DetectorSettings, LocatedObject, ObjectLocator)
from camera_to_base.errors import CameraToBaseError, FrameSizeError, HorizonError
from camera_to_base.surface import Surface
from camera_to_base.trust.gate import PositionGate, Sighting
from camera_to_base.trust.held_back import HeldBack
from camera_to_base.trust.view_check import View, view_problem, ViewCheck
import numpy as np


class Limits(NamedTuple):
    """What a frame, a position or the view must keep to, see the node's parameters."""

    max_frame_age_s: float = 0.3
    confirm_jump_px: float = 8.0
    max_shift_px: float = 3.0
    max_changed_share: float = 0.7
    check_period_s: float = 2.0

    @property
    def for_recording(self) -> 'Limits':
        """The same without the view: no arm follows a recording, which is shown as it is."""
        return self._replace(max_shift_px=0.0)


class CameraPipeline:
    """
    Turns one frame after another into objects that can be believed.

    :param surface: Maps pixels to the work surface.
    :param detector: Which detector, and which objects count.
    :param background_frames: The first background is the median of this many frames.
    """

    def __init__(
        self,
        surface: Surface,
        detector: DetectorSettings = DetectorSettings(),
        limits: Limits = Limits(),
        background_frames: int = 1,
    ) -> None:
        self._gate = PositionGate(limits.max_frame_age_s, limits.confirm_jump_px)
        self.held_back = HeldBack()
        self.counts: Counter = Counter()
        self.size_problem: Optional[str] = None
        self.view: Optional[View] = None
        self.configure(surface, detector, limits)
        self.capture_background(background_frames)

    def configure(
        self, surface: Surface, detector: DetectorSettings, limits: Limits
    ) -> None:
        """Use other settings from the next frame on, with the same background."""
        self._surface, self._detector, self._limits = surface, detector, limits
        self._gate.configure(limits.max_frame_age_s, limits.confirm_jump_px)
        self._locator: Optional[ObjectLocator] = None
        self._checked_at = -np.inf

    def capture_background(self, frame_count: int) -> None:
        """Take the background anew, of the next frames; until then no objects are found."""
        self._taker: Optional[BackgroundTaker] = BackgroundTaker(frame_count)
        self.background: Optional[np.ndarray] = None

    def restore_background(self, background: np.ndarray, age_s: float) -> None:
        """
        Use a background that was taken before; the first frame's view is compared with it.

        :param background: Shape (h, w, 3), uint8, BGR.
        :param age_s: How long ago it was taken.
        """
        self._use_background(background, age_s)
        self.background_is_restored = True
        self._checked_at = -np.inf

    @property
    def background_problem(self) -> Optional[str]:
        """Why no background could be taken of the last frame; None where it could."""
        return self._taker.problem if self._taker is not None else None

    @property
    def background_age_s(self) -> float:
        """How long ago the background was taken, in s."""
        return time.monotonic() - self._background_taken_at

    @property
    def view_problem(self) -> Optional[str]:
        """Why the view cannot be believed; None where it can."""
        return self._gate.view_problem

    def process(self, frame: np.ndarray, taken_at: Optional[float] = None) -> Sighting:
        """
        Find the objects on a frame.

        :param taken_at: When a camera took it, by time.monotonic(); None for a file's frame.
        :returns: The objects, and why they may not be published where they may not.
        :raises CameraToBaseError: If the frame cannot be used.
        """
        try:
            sighting = self._see(frame, taken_at)
        except CameraToBaseError as error:
            self._note(str(error))
            raise
        self._note(sighting.held_back or sighting.beyond_horizon)
        return sighting

    def _note(self, reason: Optional[str]) -> None:
        # Background, size and view have sentences of their own.
        is_told = self.background is None or self.size_problem or self.view_problem
        self.held_back.note(None if is_told else reason)

    def _see(self, frame: np.ndarray, taken_at: Optional[float]) -> Sighting:
        check_frame(frame)
        self.counts['frames'] += 1
        if self.background is None and not self._take_background(
                frame, is_live=taken_at is not None):
            return Sighting([], 'the background is being taken')
        objects, beyond_horizon = self._locate(frame)
        self._check_view(frame)
        sighting = self._gate.judge(objects, taken_at)._replace(beyond_horizon=beyond_horizon)
        self._count(sighting)
        return sighting

    def _locate(self, frame: np.ndarray) -> Tuple[List[LocatedObject], Optional[str]]:
        self.size_problem = None
        try:
            return self._current_locator().locate(frame), None
        except HorizonError as error:
            return [], str(error)
        except FrameSizeError as error:
            # Another background does not change what the surface was calibrated for.
            cure = ', or clear the surface and call ~/capture_background' if self._locator else ''
            self.size_problem = f'{error}{cure}'
            raise

    def _count(self, sighting: Sighting) -> None:
        if sighting.objects:
            self.counts['frames with an object'] += 1
        if sighting.held_back is not None:
            self.counts[f'frames held back: {sighting.held_back}'] += 1

    def _take_background(self, frame: np.ndarray, is_live: bool) -> bool:
        background = self._taker.add(frame, confirm=is_live)
        if background is None:
            return False
        self._use_background(background)
        return True

    def _use_background(self, background: np.ndarray, age_s: float = 0.0) -> None:
        self.background = background
        self.background_is_restored = False
        self._view_check = ViewCheck(background)
        self._gate.view_problem, self.view = None, None
        self._checked_at = time.monotonic()
        self._background_taken_at = self._checked_at - age_s
        self._taker = self._locator = None

    def _current_locator(self) -> ObjectLocator:
        if self._locator is None:
            self._locator = ObjectLocator(self.background, self._surface, self._detector)
        return self._locator

    def _check_view(self, frame: np.ndarray) -> None:
        limits = self._limits
        if not limits.max_shift_px:
            self._gate.view_problem = None
        elif time.monotonic() - self._checked_at >= limits.check_period_s:
            self.view = self._view_check.compare(frame)
            self._checked_at = time.monotonic()
            self._gate.view_problem = view_problem(
                self.view, limits.max_shift_px, limits.max_changed_share)
