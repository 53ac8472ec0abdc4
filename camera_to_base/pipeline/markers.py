# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Asks the markers where the camera stands: at each new background, and where the view asks."""

import math
import time
from typing import List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection import Area, LeftOut, LocatedObject, Pixel
from camera_to_base.errors import CameraToBaseError, Level, Reason
from camera_to_base.markers import (
    Corners, has_markers, LEAST_MARKERS, MarkedSurface, MarkerLook, MarkerVerdict, NO_ARUCO,
    paper_corners)
from camera_to_base.pipeline.place import SeenBackground, SurfaceInForce
from camera_to_base.pipeline.stage import FrameRecord, Stage
from camera_to_base.pipeline.standpoint import Background, Standpoint
import cv2
import numpy as np

_CURE = 'clear the surface, and call ~/capture_background'

_ON_MARKER = Reason('on_marker', Level.OK, 'it lies on a marker', is_passing=True)
# Of a marker's own area in the picture.
_LEAST_SHARE, _LARGEST_SHARE = 0.3, 4.0
# An object closer than this to a place of the last look is the one that was there, in px.
_SAME_PX = 5.0

# Pictures are compared at this width: finer details are of the texture. Light changes over the
# second length, and an object is as long as the third at least, in px of that width.
_WIDTH, _SHADE_PX, _LEAST_LENGTH_PX = 160, 16.0, 3
# By how much an object is lighter or darker than the surface, as the logarithm of a factor.
_LEAST_CONTRAST = 0.12
# Grey levels; noise counts less in the dark.
_BLACK = 8.0

# Of the small picture: the mean of a block has little noise.
_SIZE = (64, 48)
# What noise and flicker do to the mean of a block, in grey levels.
_LARGEST_CHANGE = 8.0
# Corners at rest are seen to 0.02 to 0.1 px from frame to frame.
_LARGEST_MOVE_PX = 0.5

# Kinds of reasons that say that the view is not that of the background.
_ELSEWHERE = ('view_moved', 'view_changed', 'view_unknown')
# The markers are looked for at most this often while something is unclear, and in peace.
_PERIOD_S, _PERIOD_IN_PEACE_S = 0.5, 5.0
# A new surface is believed in after this time, in which markers and picture stand still.
_STILL_S = 1.5


def unclear(trouble: str) -> Reason:
    """Tell that nothing is published because the markers do not say where the camera stands."""
    return Reason('markers_unclear', Level.ERROR, (
        f'where the camera stands cannot be told: {trouble}; uncover the markers, or learn them '
        'again with calibrate markers'))


def disagree() -> Reason:
    """Tell that markers are elsewhere although the view is the background's."""
    return Reason('markers_disagree', Level.ERROR, (
        'the markers are seen elsewhere, but the rest of the view is as it was: put them back, or '
        f'learn them again with calibrate markers; if the camera was moved, {_CURE}'))


def background_awaited(numbers: Tuple[int, ...], is_automatic: bool) -> Reason:
    """Tell that only the background is missing where the camera stands now."""
    cure = ('clear the surface, uncover all markers and keep still: then a new background is taken'
            if is_automatic else f'{_CURE}, or set background_retake to auto')
    return Reason('background_awaited', Level.ERROR, (
        f'the camera was moved; the markers {_listed(numbers)} tell where it stands, but the '
        f'background is of another place: {cure}'))


def by_markers(numbers: Tuple[int, ...], moved: Tuple[int, ...]) -> Reason:
    """Tell that positions are located by a surface computed anew."""
    return Reason('surface_by_markers', Level.WARN, (
        f'the camera was moved: the surface is computed anew from the markers {_listed(numbers)}'
        + (f' (marker {_listed(moved)} was moved)' if moved else '')
        + '; calibrate again where this is not exact enough'))


def marker_moved(moved: Tuple[int, ...]) -> Reason:
    """Tell that markers were moved on the surface."""
    names = f'marker {moved[0]} was' if len(moved) == 1 else f'the markers {_listed(moved)} were'
    return Reason('marker_moved', Level.WARN, (
        f'{names} moved on the surface: put it back, or learn the markers again with calibrate '
        'markers'))


def without_aruco() -> Reason:
    """Tell that OpenCV cannot find markers."""
    return Reason('markers_not_looked_for', Level.WARN, f'the markers have no effect: {NO_ARUCO}')


def _listed(numbers: Tuple[int, ...]) -> str:
    return ', '.join(map(str, numbers))


class MarkerPlaces:
    """
    Where the last look has seen markers.

    :param seen: By number, shape (4, 2), in px.
    """

    def __init__(self, seen: Corners) -> None:
        self._areas: List[Area] = [Area(paper_corners(corners)) for corners in seen.values()]
        self._marker_px2 = max(
            (cv2.contourArea(corners.astype(np.float32)) for corners in seen.values()),
            default=0.0)
        self._noted: List[Pixel] = []

    def note(self, objects: Sequence[LocatedObject]) -> None:
        """Remember the objects of the frame that was looked at."""
        self._noted = [found.detection.centre for found in objects]

    def has_new(self, objects: Sequence[LocatedObject]) -> bool:
        """Return whether an object about as large as a marker was not there at the last look."""
        return any(
            _LEAST_SHARE * self._marker_px2 < found.detection.area
            < _LARGEST_SHARE * self._marker_px2
            and not any(math.dist(found.detection.centre, noted) < _SAME_PX
                        for noted in self._noted) for found in objects)

    def split(
        self, objects: Sequence[LocatedObject]
    ) -> Tuple[List[LocatedObject], Tuple[LeftOut, ...]]:
        """Divide objects into those that are none of the markers, and the markers."""
        others, markers = [], []
        for found in objects:
            is_marker = any(area.contains(found.detection.centre) for area in self._areas)
            (markers if is_marker else others).append(found)
        return others, tuple(LeftOut(found.detection, _ON_MARKER) for found in markers)


def is_clear(frame: np.ndarray, background: SeenBackground) -> bool:
    """
    Return whether a frame shows nothing that the background of another place does not show.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Moved to where the camera stands now.
    """
    ratio = np.log((_small(frame) + _BLACK) / (_small(background.picture) + _BLACK))
    shade = cv2.GaussianBlur(ratio, (0, 0), _SHADE_PX)
    differs = (np.abs(ratio - shade) > _LEAST_CONTRAST).any(axis=2).astype(np.uint8)
    if background.unknown is not None:
        differs[_small(background.unknown) > 0] = 0
    return not cv2.erode(differs, np.ones((_LEAST_LENGTH_PX, _LEAST_LENGTH_PX), np.uint8)).any()


def _small(picture: np.ndarray) -> np.ndarray:
    height, width = picture.shape[:2]
    return cv2.resize(picture, (_WIDTH, max(round(_WIDTH * height / width), 1)),
                      interpolation=cv2.INTER_AREA).astype(np.float32)


class Stillness:
    """Measures how long the markers, and the picture in blocks, have not changed."""

    def __init__(self) -> None:
        self._blocks: Optional[np.ndarray] = None
        self._seen: Corners = {}
        self._since = 0.0

    def duration(self, frame: np.ndarray, seen: Corners, now: float) -> float:
        """
        Return for how long nothing has changed, in s.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param seen: Its markers, by number, shape (4, 2), in px.
        :param now: Its time, in s.
        """
        blocks = cv2.resize(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY), _SIZE,
                            interpolation=cv2.INTER_AREA).astype(np.float32)
        if not self._is_same(blocks, seen):
            self._blocks, self._seen, self._since = blocks, seen, now
        return now - self._since

    def _is_same(self, blocks: np.ndarray, seen: Corners) -> bool:
        both = set(seen) & set(self._seen)
        return (self._blocks is not None and len(both) >= LEAST_MARKERS and float(
            np.abs(blocks - self._blocks).max()) <= _LARGEST_CHANGE and all(
                np.abs(seen[number] - self._seen[number]).max() <= _LARGEST_MOVE_PX
                for number in both))


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
            # A frame of another view may have used up the look without a result.
            return record.held(self._reason or unclear('they have not been compared yet'))
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

    def _surface(self, seen: Corners, verdict: MarkerVerdict) -> SurfaceInForce:
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

    def _tell_moved(self, verdict: MarkerVerdict) -> None:
        self.doubt = marker_moved(verdict.moved) if verdict.moved else None

    def _without_markers(self, record: FrameRecord) -> FrameRecord:
        others, markers = self._places.split(record.objects)
        return record._replace(objects=others, left_out=(*record.left_out, *markers))

    def _is_due(self, now: float, period: float) -> bool:
        return now - self._looked_at >= period
