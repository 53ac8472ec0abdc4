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
"""Asks the markers where the camera stands: at each new background, and where the view asks."""

import time
from typing import NamedTuple, Optional

from camera_to_base.errors import CameraToBaseError
from camera_to_base.markers import Corners, has_markers, MarkedSurface, MarkerLook, Verdict
from camera_to_base.reason import Reason
from camera_to_base.trust.markers.clearance import is_clear
from camera_to_base.trust.markers.marker_places import MarkerPlaces
from camera_to_base.trust.markers.marker_reasons import (
    background_awaited, by_markers, disagree, marker_moved, unclear, without_aruco)
from camera_to_base.trust.markers.stillness import Stillness
from camera_to_base.trust.stage import FrameRecord, Stage
from camera_to_base.trust.standpoint import Background, Standpoint
from camera_to_base.trust.surface_in_force import SurfaceInForce
import numpy as np

# Kinds of reasons that say that the view is not that of the background.
_ELSEWHERE = ('view_moved', 'view_changed', 'view_unknown')
# The markers are looked for at most this often while something is unclear, and in peace.
_PERIOD_S, _PERIOD_IN_PEACE_S = 0.5, 5.0
# A new surface is believed in after this time, in which markers and picture stand still.
_STILL_S = 1.5


class MarkerSettings(NamedTuple):
    """
    Markers on the surface.

    :param marked: The calibration with its markers.
    :param retakes: Whether a new background may be taken without being asked for.
    :param background_frames: It is the median of this many frames.
    """

    marked: MarkedSurface
    retakes: bool = False
    background_frames: int = 1


class MarkerWatch(Stage):
    """
    Follows the markers.

    A surface is computed anew for a background that the markers were not yet compared with: only
    then the background and the surface are of the same place. At other times the markers tell why
    there must be a new background, and whether one of them was moved.

    :param settings: See :class:`MarkerSettings`; None for no markers.

    `doubt` is why positions are published with a warning, or None.
    """

    sees_held_back = True

    def __init__(self, settings: Optional[MarkerSettings]) -> None:
        self._settings = settings
        self._background: Optional[Background] = None
        self._places = MarkerPlaces({})
        self._start()

    def configure(self, settings: Optional[MarkerSettings]) -> None:
        """Use other settings from the next frame on; None for no markers."""
        before, self._settings = self._settings, settings
        if settings is None or before is None:
            self._background = None
        elif settings.marked == before.marked:
            return
        self._start()

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Judge a frame, also one whose view is not that of the background."""
        background = record.standpoint.taken
        if self._settings is None or background is None:
            return record
        if background is not self._background:
            self._background = background
            self._start()
        if record.reason is not None and record.reason.kind not in _ELSEWHERE:
            return record
        if not has_markers():
            # As on a surface without markers.
            self.doubt = without_aruco()
            return record
        now = time.monotonic() if record.taken_at is None else record.taken_at
        try:
            if record.reason is not None:
                return self._elsewhere(record, now)
            if not self._is_checked:
                return self._unchecked(record, now)
            return self._in_place(record, now)
        except CameraToBaseError as error:
            return self._held(record, unclear(str(error)))

    def _start(self) -> None:
        self._is_checked, self._looked_at = False, -np.inf
        self._reason: Optional[Reason] = None
        self._stillness = Stillness()
        self.doubt: Optional[Reason] = None

    def _unchecked(self, record: FrameRecord, now: float) -> FrameRecord:
        """Compare the surface in use with the markers before anything is published."""
        if not self._is_due(now, _PERIOD_S):
            return record.held(self._reason)
        standpoint = record.standpoint
        seen, verdict = self._look(standpoint.taken.picture, standpoint, now)
        if verdict.trouble:
            # The markers may have been covered when the background was taken.
            seen, verdict = self._look(record.frame, standpoint, now)
        if verdict.trouble:
            return self._held(record, unclear(verdict.trouble))
        if verdict.fit is None:
            self._is_checked, self._reason = True, None
            self._tell_moved(verdict)
            return self._without_markers(record)
        if standpoint.correction is not None:
            return self._held(
                record, background_awaited(verdict.fit.numbers, self._settings.retakes))
        self._is_checked, self._reason = True, None
        there = standpoint.with_surface(self._surface(seen, verdict))
        held = by_markers(verdict.fit.numbers, verdict.moved)._replace(is_passing=True)
        return record.held(held)._replace(
            # Frames are of the place where the background was taken.
            standpoint=there.with_background(standpoint.taken))

    def _in_place(self, record: FrameRecord, now: float) -> FrameRecord:
        """Look now and then whether a marker was moved, and at what may be one."""
        period = _PERIOD_S if self._reason is not None else _PERIOD_IN_PEACE_S
        if self._is_due(now, period) or self._places.has_new(record.objects):
            verdict = self._look(record.frame, record.standpoint, now,
                                 tolerance_px=record.motion.shift_px).verdict
            if not verdict.trouble:
                self._tell_moved(verdict)
                self._reason = disagree() if verdict.fit is not None else None
            self._places.note(record.objects)
        return (self._without_markers(record) if self._reason is None
                else record.held(self._reason))

    def _elsewhere(self, record: FrameRecord, now: float) -> FrameRecord:
        """Tell where the camera stands, and take a new background where that is allowed."""
        if not self._is_due(now, _PERIOD_S):
            return record if self._reason is None else record.held(self._reason)
        look = self._look(record.frame, record.standpoint, now)
        verdict = look.verdict
        is_other_place = verdict.fit is not None or (
            not self._is_checked and not verdict.trouble)
        self._reason = None
        if not is_other_place:
            self._stillness = Stillness()
            return record
        still_s = self._stillness.duration(record.frame, look.seen, now)
        if still_s < _STILL_S:
            return record
        numbers = verdict.in_place if verdict.fit is None else verdict.fit.numbers
        retakes = self._settings.retakes
        record = self._held(record, background_awaited(numbers, retakes))
        if retakes and self._is_safe(record.frame, look, record.standpoint):
            record = record._replace(retaken=self._settings.background_frames)
        return record

    def _is_safe(self, frame: np.ndarray, look: MarkerLook, standpoint: Standpoint) -> bool:
        """Return whether a frame can be the background: free markers, and no object."""
        marked, fit = self._settings.marked, look.verdict.fit
        if not set(look.seen) >= set(marked.corners):
            return False
        seen = standpoint.background
        if fit is None:
            return is_clear(frame, seen)
        there = marked.anew(fit).frame_from_calibrated
        here = standpoint.surface.frame_from_calibrated
        return is_clear(frame, seen.seen_after(
            there if here is None else there.after(here.inverse), frame))

    def _look(
        self, image: np.ndarray, standpoint: Standpoint, now: float, tolerance_px: float = 0.0
    ) -> MarkerLook:
        self._looked_at = now
        look = self._settings.marked.look(
            image, standpoint.surface.frame_from_calibrated, tolerance_px)
        self._places = MarkerPlaces(look.seen)
        return look

    def _surface(self, seen: Corners, verdict: Verdict) -> SurfaceInForce:
        """Return the calibrated surface where the camera is back in its place, or a new one."""
        marked = self._settings.marked
        as_calibrated = marked.judge(seen)
        if as_calibrated.fit is None and not as_calibrated.trouble:
            self._tell_moved(as_calibrated)
            return SurfaceInForce(marked.surface)
        new = marked.anew(verdict.fit)
        return SurfaceInForce(
            new.surface, new.covariance, by_markers(verdict.fit.numbers, verdict.moved),
            replaces=True, frame_from_calibrated=new.frame_from_calibrated)

    def _held(self, record: FrameRecord, reason: Reason) -> FrameRecord:
        self._reason = reason
        return record.held(reason)

    def _tell_moved(self, verdict: Verdict) -> None:
        self.doubt = marker_moved(verdict.moved) if verdict.moved else None

    def _without_markers(self, record: FrameRecord) -> FrameRecord:
        others, markers = self._places.split(record.objects)
        return record._replace(objects=others, left_out=(*record.left_out, *markers))

    def _is_due(self, now: float, period: float) -> bool:
        return now - self._looked_at >= period
