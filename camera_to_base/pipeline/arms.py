# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Leaves out what belongs to a hand or an arm, what it touches, and what an object left behind."""

from collections import deque
from functools import reduce
from typing import Deque, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection import (
    Detection, DetectorSettings, LeftOut, locate_pixel, LocatedObject, Point, REASONS)
from camera_to_base.errors import HorizonError, Level, Reason
from camera_to_base.pipeline.cells import covered_share
from camera_to_base.pipeline.old_places import LEFT, OldPlaces
from camera_to_base.pipeline.reaching_in import Changes, ReachingIn
from camera_to_base.pipeline.rims import LeftBehind, Rim, rim_of
from camera_to_base.pipeline.stage import FrameRecord, Stage
from camera_to_base.pipeline.standpoint import PerBackground, Standpoint
import cv2
import numpy as np

# So long what appears where something reached in may still belong to it: a hand that is lifted or
# drawn back.
_MEMORY_S = 1.0
# How far a nudge of the camera moves what is seen, in px.
_NUDGED_PX = 20
# An object is at rest, and whole, while its area and centre stay this close, as a share and in px.
_SAME_AREA, _SAME_CENTRE_PX = 0.05, 2.0
# So long an object is known though it is not seen: something covers it.
_KNOWN_S = 10.0
_MOST_KNOWN = 100
# What was at rest for so long, and is a part of something that is larger by this factor now, is
# covered by it, or touches it.
_AT_REST_S, _JOINED_SIZE = 0.5, 1.3
# What looks the same differs by no more than noise does: in levels, and in its deviations, which
# are told from whole levels.
_LEAST_NOISE, _NOISE_DEVIATIONS = 4.0, 8.0

_TOUCHED = Reason(
    'touched', Level.WARN, 'something that reaches in from the edge of the picture touches, '
    'covers or shades it: take hands and arms out of the view, and lay it farther in if its own '
    'shade is all that reaches the edge', is_passing=True)
_WAS_TOUCHED = Reason(
    'touched', Level.WARN, 'it appeared where something reached in less than a second ago',
    is_passing=True)
# Where something reaches in; None for nowhere.
_Mask = Optional[np.ndarray]


class _Known(NamedTuple):
    found: LocatedObject
    rim: Rim
    seen_at: float
    since: float


class ArmStage(Stage):
    """
    Leaves out objects that are not free, by an :class:`ArmCheck` for each background.

    :param settings: The detector's settings.
    """

    sees_held_back = True

    def __init__(self, settings: DetectorSettings) -> None:
        self._settings = settings
        self._checks: PerBackground[ArmCheck] = PerBackground(
            lambda background: ArmCheck(background.picture, background.unknown))
        self._standpoint: Optional[Standpoint] = None

    def configure(self, settings: DetectorSettings) -> None:
        """Use other settings from the next frame on."""
        if settings != self._settings:
            self._settings = settings
            for check in self._checks.made():
                check.forget_objects()

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Leave out objects that are not free; of a frame held back, note where the camera is."""
        if record.standpoint is not self._standpoint and record.standpoint.background is not None:
            self._stand_at(record.standpoint)
        if (record.reason is not None or not record.motion.is_in_place
                or not _leaves_out_cut_off(self._settings)):
            return record
        return self._checks.of(record.standpoint.background).judge(record)

    def doubt(self, standpoint: Standpoint) -> Optional[Reason]:
        """Tell why nothing is published at a place that an object of the background has left."""
        if standpoint.background is None:
            return None
        return self._checks.of(standpoint.background).doubt

    def _stand_at(self, standpoint: Standpoint) -> None:
        before, self._standpoint = self._standpoint, standpoint
        check = self._checks.of(standpoint.background)
        check.forget_objects()
        if (before is not None and standpoint.background is not before.background
                and standpoint.follows is before.background):
            check.remember(self._checks.of(before.background))
        self._checks.keep(standpoint)


class ArmCheck:
    """
    Tells free objects from what reaches in, what that touches, and what it leaves behind.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param unknown: Where it shows nothing, see :class:`ReachingIn`.
    """

    def __init__(self, background: np.ndarray, unknown: Optional[np.ndarray] = None) -> None:
        self._reaching_in = ReachingIn(background, unknown)
        self._left_behind, self._places = LeftBehind(background), OldPlaces()
        self._fills: Deque[Tuple[float, np.ndarray]] = deque()
        self._known: List[_Known] = []
        self._most_noise = max(_LEAST_NOISE, _NOISE_DEVIATIONS * self._reaching_in.noise)

    @property
    def doubt(self) -> Optional[Reason]:
        """Why nothing is published at a place that an object of the background has left."""
        return self._places.reason

    def forget_objects(self) -> None:
        """Forget which objects are known: their positions were those of other settings."""
        self._known = []

    def remember(self, before: 'ArmCheck') -> None:
        """Remember where something reached in, or has left, before the camera was nudged."""
        reach = 2 * -(-_NUDGED_PX // self._reaching_in.scale) + 1
        grown = np.ones((reach, reach), np.uint8)
        self._fills = deque((at, cv2.dilate(fill, grown)) for at, fill in before._fills)
        self._places.remember(before._places, _NUDGED_PX)

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Leave out what is not free, and add known objects that are only shaded."""
        if not (record.objects or record.left_out or self._fills or self._places):
            self._known = []
            return record
        frame, taken_at = record.aligned, record.now
        doubtful = [one for one in record.objects if not self._is_unchanged(one, frame)]
        changes = self._reaching_in.find(frame, record.motion.shift_px, self._places.outlines)
        record = self._without_left(record, doubtful, changes)
        fill = changes.reaching_in if changes.any_reaching_in else None
        if taken_at is None:
            return record.without([_TOUCHED if self._is_covered(one, fill) else None
                                   for one in record.objects])
        recent = self._recent(fill, taken_at)
        record = record.without([
            self._reason(one, _is_among(one, doubtful), frame, fill, recent, taken_at)
            for one in record.objects])
        joined = self._joined(record, recent, taken_at)
        record = _with(record, self._shaded(frame, recent, joined, taken_at))
        return record._replace(left_out=(*record.left_out, *joined))

    def _is_unchanged(self, one: LocatedObject, frame: np.ndarray) -> bool:
        # Whether it rests, and all around it looks as when it was found to be free.
        known = self._known_as(one)
        return known is not None and known.rim.is_unchanged(frame, self._most_noise)

    def _without_left(self, record: FrameRecord, doubtful: Sequence[LocatedObject],
                      changes: Changes) -> FrameRecord:
        # A frame that stands for itself leaves no memory.
        places = self._places if record.now is not None else OldPlaces()
        places.forget_those_back(changes.differs, self._reaching_in.scale, [
            *(one.detection for one in record.objects),
            *(one.detection for one in record.left_out)])
        left = [one for one in doubtful if self._left_behind.is_part_of(
            record.aligned, one.detection.outline, changes.gain)]
        places.note([*(one.detection.outline for one in left),
                     *(one.detection.outline for one in record.left_out
                       if one.reason.kind == LEFT.kind)], record.now or 0.0)
        record = record.without([
            LEFT if _is_among(one, left) or places.hold(
                one.detection, is_known=self._known_as(one) is not None) else None
            for one in record.objects])
        told = [one.detection for one in record.left_out if one.reason.kind == LEFT.kind]
        return record._replace(left_out=(*record.left_out, *(
            LeftOut(place, LEFT, _point_of(record, place))
            for place in places.certain_but_for(told))))

    def _recent(self, fill: _Mask, taken_at: float) -> _Mask:
        while self._fills and not 0 <= taken_at - self._fills[0][0] <= _MEMORY_S:
            self._fills.popleft()
        if fill is not None:
            self._fills.append((taken_at, fill))
        recent = reduce(cv2.max, (mask for _, mask in self._fills)) if self._fills else None
        self._known = [known for known in self._known
                       if 0 <= taken_at - known.seen_at <= _KNOWN_S]
        return recent

    def _reason(self, one: LocatedObject, is_doubtful: bool, frame: np.ndarray, fill: _Mask,
                recent: _Mask, taken_at: float) -> Optional[Reason]:
        known = self._known_as(one)
        if not self._is_covered(one, recent):
            # An unchanged rim is kept, so that slow changes add up.
            rim = (rim_of(frame, one.detection.outline) if known is None or is_doubtful
                   else known.rim)
            since = taken_at if known is None else known.since
            self._know(known, _Known(one, rim, taken_at, since))
            return None
        if known is not None:
            # What it looked like when it was free stays the measure.
            self._know(known, known._replace(seen_at=taken_at))
            return None
        return _TOUCHED if self._is_covered(one, fill) else _WAS_TOUCHED

    def _joined(self, record: FrameRecord, recent: _Mask, taken_at: float) -> List[LeftOut]:
        # Known objects at rest that are now a part of something larger, which is detected.
        larger = [one.detection for one in (*record.objects, *record.left_out)]
        joined = [known for known in self._known if known.seen_at != taken_at
                  and known.seen_at - known.since >= _AT_REST_S
                  and not self._is_covered(known.found, recent)
                  and any(_is_part_of(known.found.detection, other) for other in larger)]
        return [LeftOut(known.found.detection, REASONS['joined'], known.found.point)
                for known in joined]

    def _shaded(self, frame: np.ndarray, recent: _Mask, joined: Sequence[LeftOut],
                taken_at: float) -> List[LocatedObject]:
        # Known objects that the detector does not tell from an arm and its shadow.
        shaded = [known for known in self._known if known.seen_at != taken_at
                  and self._is_covered(known.found, recent) and known.rim.is_in(frame)]
        for known in shaded:
            self._know(known, known._replace(seen_at=taken_at))
        # What is not seen though nothing covers it has gone.
        self._known = [known for known in self._known if known.seen_at == taken_at
                       or self._is_covered(known.found, recent)
                       or any(known.found.detection is one.detection for one in joined)]
        return [known.found for known in shaded]

    def _known_as(self, one: LocatedObject) -> Optional[_Known]:
        return next((known for known in self._known if _is_same(
            known.found.detection, one.detection)), None)

    def _know(self, before: Optional[_Known], now: _Known) -> None:
        others = [other for other in self._known if other is not before]
        self._known = [now, *others][:_MOST_KNOWN]

    def _is_covered(self, one: LocatedObject, mask: _Mask) -> bool:
        return mask is not None and covered_share(
            mask, one.detection.outline, self._reaching_in.scale) > 0


def _is_part_of(one: Detection, other: Detection) -> bool:
    return (other.area > _JOINED_SIZE * one.area and cv2.pointPolygonTest(
        np.int32(other.outline).reshape(-1, 1, 2), one.centre, False) >= 0)


def _is_same(one: Detection, other: Detection) -> bool:
    moved = max(abs(one.centre.u - other.centre.u), abs(one.centre.v - other.centre.v))
    return (moved <= _SAME_CENTRE_PX
            and abs(one.area - other.area) <= _SAME_AREA * one.area)


def _point_of(record: FrameRecord, one: Detection) -> Optional[Point]:
    try:
        return locate_pixel(record.standpoint.surface.surface, one.centre)
    except HorizonError:
        return None


def _is_among(one: LocatedObject, others: Sequence[LocatedObject]) -> bool:
    return any(one is other for other in others)


def _with(record: FrameRecord, more: Sequence[LocatedObject]) -> FrameRecord:
    objects = sorted([*record.objects, *more], key=lambda one: -one.detection.area)
    return record._replace(objects=objects) if more else record


def _leaves_out_cut_off(settings: DetectorSettings) -> bool:
    # An arm that reaches in is a cut-off object; it is an object if these are published.
    return settings.method == 'precise' and not settings.publish_cut_off
