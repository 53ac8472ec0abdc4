# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Text that changes in place and never moves: the clock that a camera writes into its pictures."""

from typing import Iterable, List, Optional, Sequence

from camera_to_base.detection import Box, Detection, locate_pixel
from camera_to_base.errors import HorizonError, Level, Reason
from camera_to_base.pipeline.stage import FrameRecord, Stage
from camera_to_base.surface import Surface
import cv2
import numpy as np

# Shapes are the same, or others, where they have more, or less, than this share of their area in
# common. What was the same for so long, in s, has changed where another shape follows it at once.
_SAME, _OTHER, _STEADY_S = 0.85, 0.75, 0.7
# What is not seen for so long has left, in s.
_GONE_S = 0.5
# So many changes within so many seconds are a clock's. It is one until it has stood still for so
# long.
_CHANGES, _WITHIN_S, _FORGOTTEN_S = 3, 10.0, 150.0
# What reaches in may change what is seen for so long.
_HAND_S = 1.0
# All shapes together are no larger than one of them by this factor and some px: it never moves.
_GROWTH, _MORE_PX = 1.6, 6
# The next letter of a line of text, behind a colon, is no farther away than so many heights.
# It, or a piece of it, has this part of its own height in the line.
_NEXT, _IN_ROW = 1.5, 0.6
# The hours are so many heights of a digit away from the seconds.
_LINE = 6
_MOST_SPOTS = 40
# What a digit may be left out as.
_DIGITS = frozenset({'too_small', 'taken_away'})
# Text is no higher than this share of the picture.
_HIGHEST = 0.1


class Spot:
    """
    A place where something was detected, and how often its shape has changed.

    :param found: What was detected there first.
    """

    def __init__(self, found: Detection, at: float) -> None:
        self.box, self.seen_at = found.box, at
        self._size = max(found.box.width, found.box.height)
        self._shape, self._since = [found.outline.reshape(-1, 1, 2)], at
        self._next: Optional[List[np.ndarray]] = None
        self._changed_at: List[float] = []

    @property
    def is_clock(self) -> bool:
        """Whether it changes in place."""
        recent = self._changed_at[-_CHANGES:]
        return len(recent) == _CHANGES and recent[-1] - recent[0] <= _WITHIN_S

    @property
    def changed_at(self) -> float:
        """When it changed last, in s."""
        return self._changed_at[-1]

    def holds(self, one: Detection) -> bool:
        """Tell whether something lies there."""
        own, box = self.box, one.box
        return (own.x < box.x + box.width and box.x < own.x + own.width
                and own.y < box.y + box.height and box.y < own.y + own.height)

    def is_beside(self, box: Box) -> bool:
        """Tell whether a box may be the next letter of the same line."""
        own, reach = self.box, _NEXT * self.box.height
        in_row = min(own.y + own.height, box.y + box.height) - max(own.y, box.y)
        return (in_row >= _IN_ROW * box.height
                and own.x - reach <= box.x + box.width
                and box.x <= own.x + own.width + reach)

    def grow(self, box: Box) -> bool:
        """Take a box in; tell whether the whole is still no larger than something at rest."""
        whole, size = _around([self.box, box]), max(self._size, box.width, box.height)
        if max(whole.width, whole.height) > _GROWTH * size + _MORE_PX:
            return False
        self.box, self._size = whole, size
        return True

    def see(self, shape: List[np.ndarray], at: float, counts: bool) -> None:
        """
        Note what a frame shows there.

        :param shape: The outlines, each of shape (n, 2), int32, in px.
        :param counts: Whether a change is its own, and not that of a hand near it.
        """
        was_gone, self.seen_at = at - self.seen_at > _GONE_S, at
        if was_gone:
            # Something else was put there.
            self._shape, self._since, self._next = shape, at, None
        elif _in_common(shape, self._shape) >= _SAME:
            self._next = None
        elif self._next is not None and _in_common(shape, self._next) >= _SAME:
            # What has moved is the same shape at another place.
            is_other = _in_common(_centred(shape), _centred(self._shape)) < _OTHER
            if counts and is_other and at - self._since >= _STEADY_S:
                self._changed_at.append(at)
            self._shape, self._since, self._next = shape, at, None
        else:
            self._next = shape


class InPlaceStage(Stage):
    """
    Leaves out what changes in place.

    `doubt` says where, and what to paste into `ignored_areas`; None where there is nothing.
    """

    def __init__(self) -> None:
        self._spots: List[Spot] = []
        self._clocks: List[Spot] = []
        self._shape: Optional[tuple] = None
        self._hand_at = -np.inf
        self.doubt: Optional[Reason] = None

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Leave out what lies where something changes in place."""
        if record.now is None or record.aligned is None:
            return record
        if record.frame.shape != self._shape:
            self._shape, self._spots, self._clocks = record.frame.shape, [], []
        if any(one.reason.kind == 'cut_off' for one in record.left_out):
            self._hand_at = record.now
        found = [one.detection for one in record.objects]
        found += [one.detection for one in record.left_out if one.reason.kind in _DIGITS]
        specks = [one.detection for one in record.left_out if one.reason.kind == 'speck']
        if found or specks:
            highest = _HIGHEST * record.frame.shape[0]
            self._note([one for one in found if one.box.height <= highest], specks, record.now)
        self._tell(record.standpoint.surface.surface, record.now)
        if not self._clocks:
            return record
        return record.without([self.doubt if self._is_of_clock(one.detection) else None
                               for one in record.objects])

    def _note(
        self, found: Sequence[Detection], specks: Sequence[Detection], at: float
    ) -> None:
        counts = at - self._hand_at > _HAND_S
        left = list(found)
        for spot in list(self._spots):
            # What is seen of a thin digit may be specks alone.
            own = [one for one in (*left, *specks) if spot.holds(one)]
            left = [one for one in left if not any(one is other for other in own)]
            if own and not spot.grow(_around([one.box for one in own])):
                self._spots.remove(spot)
            elif own:
                spot.see([one.outline.reshape(-1, 1, 2) for one in own], at, counts)
        self._spots += [Spot(one, at) for one in left]
        self._spots = sorted((spot for spot in self._spots if at - spot.seen_at <= _WITHIN_S),
                             key=lambda spot: -spot.seen_at)[:_MOST_SPOTS]

    def _tell(self, surface: Surface, at: float) -> None:
        new = [spot for spot in self._spots
               if spot.is_clock and not any(spot is clock for clock in self._clocks)]
        known = [clock for clock in self._clocks if 0 <= at - clock.changed_at <= _FORGOTTEN_S]
        if new or len(known) < len(self._clocks):
            self._clocks = known + new
            self.doubt = _reason([clock.box for clock in self._clocks], surface)

    def _is_of_clock(self, one: Detection) -> bool:
        return any(clock.holds(one) or clock.is_beside(one.box) for clock in self._clocks)


def _in_common(one: List[np.ndarray], other: List[np.ndarray]) -> float:
    left, top, width, height = cv2.boundingRect(np.concatenate([*one, *other]))
    masks = [cv2.drawContours(np.zeros((height, width), np.uint8), shape, -1, 1, cv2.FILLED,
                              offset=(-left, -top)) for shape in (one, other)]
    return cv2.countNonZero(masks[0] & masks[1]) / max(
        cv2.countNonZero(masks[0] | masks[1]), 1)


def _centred(shape: List[np.ndarray]) -> List[np.ndarray]:
    left, top, width, height = cv2.boundingRect(np.concatenate(shape))
    return [one - (left + width // 2, top + height // 2) for one in shape]


def _around(boxes: Iterable[Box]) -> Box:
    boxes = np.array(list(boxes))
    left, top = boxes[:, :2].min(axis=0).tolist()
    right, bottom = (boxes[:, :2] + boxes[:, 2:]).max(axis=0).tolist()
    return Box(left, top, right - left, bottom - top)


def _reason(boxes: Sequence[Box], surface: Surface) -> Optional[Reason]:
    if not boxes:
        return None
    box = _around(boxes)
    above, beside = max(box.height, box.width // 2), max(_LINE * box.height, box.width // 2)
    corners = [(box.x - beside, box.y - above), (box.x + box.width + beside, box.y - above),
               (box.x + box.width + beside, box.y + box.height + above),
               (box.x - beside, box.y + box.height + above)]
    return Reason('changes_in_place', Level.WARN, (
        'something changes in place and never moves, such as a clock that the camera writes into '
        f'its pictures: it is not published; switch it off, {_cure(corners, surface)}'))


def _cure(corners: Sequence[tuple], surface: Surface) -> str:
    try:
        points = [locate_pixel(surface, corner) for corner in corners]
    except HorizonError:
        return 'or turn the camera'
    polygon = ', '.join(f'{point.x:.2f} {point.y:.2f}' for point in points)
    return f"or add to the parameter ignored_areas: '{polygon}'"
