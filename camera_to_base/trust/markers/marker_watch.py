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

from typing import Optional

from camera_to_base.errors import CameraToBaseError
from camera_to_base.markers import Corners, has_markers, MarkerLook, Verdict
from camera_to_base.reason import Reason
from camera_to_base.trust.background import Background
from camera_to_base.trust.markers.clearance import is_clear
from camera_to_base.trust.markers.marker_places import MarkerPlaces
from camera_to_base.trust.markers.marker_reasons import (
    background_awaited, by_markers, disagree, marker_moved, unclear, without_aruco)
from camera_to_base.trust.markers.marker_view import MarkerSettings, MarkerStep, MarkerView
from camera_to_base.trust.markers.stillness import Stillness
from camera_to_base.trust.sighting import Sighting
from camera_to_base.trust.surface_in_force import SurfaceInForce
import numpy as np

# Kinds of reasons that say that the view is not that of the background.
_ELSEWHERE = ('view_moved', 'view_changed', 'view_unknown')
# The markers are looked for at most this often while something is unclear, and in peace.
_PERIOD_S, _PERIOD_IN_PEACE_S = 0.5, 5.0
# A new surface is believed in after this time, in which markers and picture stand still.
_STILL_S = 1.5


class MarkerWatch:
    """
    Follows the markers.

    A surface is computed anew for a background that the markers were not yet compared with: only
    then the background and the surface are of the same place. At other times the markers tell why
    there must be a new background, and whether one of them was moved.

    :param settings: See :class:`MarkerSettings`.

    `doubt` is why positions are published with a warning, or None.
    """

    def __init__(self, settings: MarkerSettings) -> None:
        self.doubt: Optional[Reason] = None
        self._settings = settings
        self._background: Optional[Background] = None
        self._places = MarkerPlaces({})
        self._start()

    @property
    def background_frames(self) -> int:
        """Number of frames of a background that the markers ask for."""
        return self._settings.background_frames

    def configure(self, settings: MarkerSettings) -> None:
        """Use other settings from the next frame on."""
        is_same = settings.marked == self._settings.marked
        self._settings = settings
        if not is_same:
            self._start()

    def step(
        self, frame: np.ndarray, sighting: Sighting, view: MarkerView, now: float
    ) -> MarkerStep:
        """
        Judge a frame.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :param sighting: What the other checks let pass.
        :param now: The frame's time, in s.
        """
        if view.background is not self._background:
            self._background = view.background
            self._start()
        kind = None if sighting.reason is None else sighting.reason.kind
        if kind is not None and kind not in _ELSEWHERE:
            return MarkerStep(sighting)
        if not has_markers():
            # As on a surface without markers.
            self.doubt = without_aruco()
            return MarkerStep(sighting)
        try:
            if kind is not None:
                return self._elsewhere(frame, sighting, view, now)
            if not self._is_checked:
                return self._unchecked(frame, sighting, view, now)
            return self._in_place(frame, sighting, view, now)
        except CameraToBaseError as error:
            return self._held(unclear(str(error)))

    def _start(self) -> None:
        self._is_checked, self._looked_at = False, -np.inf
        self._reason: Optional[Reason] = None
        self._stillness = Stillness()
        self.doubt = None

    def _unchecked(
        self, frame: np.ndarray, sighting: Sighting, view: MarkerView, now: float
    ) -> MarkerStep:
        """Compare the surface in use with the markers before anything is published."""
        if not self._is_due(now, _PERIOD_S):
            return MarkerStep(Sighting([], self._reason))
        seen, verdict = self._look(view.background.picture, view, now)
        if verdict.trouble:
            # The markers may have been covered when the background was taken.
            seen, verdict = self._look(frame, view, now)
        if verdict.trouble:
            return self._held(unclear(verdict.trouble))
        if verdict.fit is None:
            self._is_checked, self._reason = True, None
            self._tell_moved(verdict)
            return MarkerStep(self._without_markers(sighting))
        if view.is_corrected:
            return self._held(background_awaited(verdict.fit.numbers, self._settings.retakes))
        self._is_checked, self._reason = True, None
        surface = self._surface(seen, verdict)
        held = by_markers(verdict.fit.numbers, verdict.moved)._replace(is_passing=True)
        return MarkerStep(Sighting([], held), surface)

    def _in_place(
        self, frame: np.ndarray, sighting: Sighting, view: MarkerView, now: float
    ) -> MarkerStep:
        """Look now and then whether a marker was moved, and at what may be one."""
        period = _PERIOD_S if self._reason is not None else _PERIOD_IN_PEACE_S
        if self._is_due(now, period) or self._places.has_new(sighting.objects):
            verdict = self._look(frame, view, now, tolerance_px=view.shift_px).verdict
            if not verdict.trouble:
                self._tell_moved(verdict)
                self._reason = disagree() if verdict.fit is not None else None
            self._places.note(sighting.objects)
        if self._reason is not None:
            return MarkerStep(Sighting([], self._reason))
        return MarkerStep(self._without_markers(sighting))

    def _elsewhere(
        self, frame: np.ndarray, sighting: Sighting, view: MarkerView, now: float
    ) -> MarkerStep:
        """Tell where the camera stands, and take a new background where that is allowed."""
        if not self._is_due(now, _PERIOD_S):
            return MarkerStep(sighting if self._reason is None else Sighting([], self._reason))
        look = self._look(frame, view, now)
        verdict = look.verdict
        is_other_place = verdict.fit is not None or (
            not self._is_checked and not verdict.trouble)
        self._reason = None
        if not is_other_place:
            self._stillness = Stillness()
            return MarkerStep(sighting)
        still_s = self._stillness.duration(frame, look.seen, now)
        if still_s < _STILL_S:
            return MarkerStep(sighting)
        numbers = verdict.in_place if verdict.fit is None else verdict.fit.numbers
        self._reason = background_awaited(numbers, self._settings.retakes)
        return MarkerStep(Sighting([], self._reason), retakes=(
            self._settings.retakes and self._is_safe(frame, look, view)))

    def _is_safe(self, frame: np.ndarray, look: MarkerLook, view: MarkerView) -> bool:
        """Return whether a frame can be the background: free markers, and no object."""
        marked, fit = self._settings.marked, look.verdict.fit
        if not set(look.seen) >= set(marked.corners):
            return False
        if fit is None:
            return is_clear(frame, view.seen)
        there, here = marked.anew(fit).frame_from_calibrated, view.in_force.frame_from_calibrated
        return is_clear(frame, view.seen.seen_after(
            there if here is None else there.after(here.inverse), frame))

    def _look(
        self, image: np.ndarray, view: MarkerView, now: float, tolerance_px: float = 0.0
    ) -> MarkerLook:
        self._looked_at = now
        look = self._settings.marked.look(image, view.in_force.frame_from_calibrated, tolerance_px)
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

    def _held(self, reason: Reason) -> MarkerStep:
        self._reason = reason
        return MarkerStep(Sighting([], reason))

    def _tell_moved(self, verdict: Verdict) -> None:
        self.doubt = marker_moved(verdict.moved) if verdict.moved else None

    def _without_markers(self, sighting: Sighting) -> Sighting:
        others, markers = self._places.split(sighting.objects)
        return Sighting(others, sighting.reason, (*sighting.left_out, *markers))

    def _is_due(self, now: float, period: float) -> bool:
        return now - self._looked_at >= period
