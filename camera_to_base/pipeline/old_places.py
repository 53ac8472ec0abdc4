# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The places that objects of the background have left: what lies there is not known."""

from typing import Iterable, List, NamedTuple, Optional, Sequence

from camera_to_base.detection import Box, Detection, Pixel
from camera_to_base.errors import Level, Reason
from camera_to_base.pipeline.cells import covered_share
import cv2
import numpy as np

# A place that is told for so long is one until the background is taken anew; another one is
# forgotten after the same time.
_CERTAIN_S = 1.0
# What lies so near to a place touches it, in px, with more than this share of its area.
_MARGIN_PX, _LEAST_TOUCHED = 3, 0.05
# What is larger than a place that is not certain yet, as a factor on its area, is an object.
_LARGER = 1.5
# An object is back where no more than this differs from the background: its edge, where it is not
# quite where it was.
_MOST_CHANGED = 0.3

LEFT = Reason(
    'taken_away', Level.WARN, 'it cannot be told from the place that an object of the background '
    'has left: clear the surface, and call ~/capture_background', is_passing=True)
_PLACE_LEFT = Reason(
    'taken_away', Level.WARN, 'an object of the background has left its place: nothing is '
    'published there: clear the surface, and call ~/capture_background')


class _Told(NamedTuple):
    """An outline that tells a place, its first area, and when it was told first and last."""

    hull: np.ndarray
    first_area: float
    first_at: float
    last_at: float

    @property
    def is_certain(self) -> bool:
        return self.last_at - self.first_at >= _CERTAIN_S


class OldPlace(NamedTuple):
    """
    A place that an object of the background has left.

    :param hull: Shape (n, 2), int32, columns u and v in px: all that tells it.
    :param is_certain: Whether it stays.
    """

    hull: np.ndarray
    is_certain: bool

    @property
    def area(self) -> float:
        """Its area, in px²."""
        return cv2.contourArea(self.hull)

    @property
    def detection(self) -> Detection:
        """The place, as what is left out."""
        moments = cv2.moments(self.hull)
        area = moments['m00'] or 1.0
        return Detection(Box(*cv2.boundingRect(self.hull)),
                         Pixel(moments['m10'] / area, moments['m01'] / area),
                         moments['m00'], self.hull, False)


class OldPlaces:
    """
    Remembers the places that objects of the background have left.

    What tells a place are outlines: of an object that has left as a whole, or of parts of it, such
    as the corners of a box that was turned. Those that are no farther apart than they are long
    belong to one place, the hull of all of them. What moves away tells other places;
    only what is told for a while stays.
    """

    def __init__(self) -> None:
        self._told: List[_Told] = []
        self._places: List[OldPlace] = []

    def __bool__(self) -> bool:
        """Tell whether there is any."""
        return bool(self._places)

    @property
    def outlines(self) -> List[np.ndarray]:
        """Their hulls, each of shape (n, 2), int32."""
        return [place.hull for place in self._places]

    @property
    def reason(self) -> Optional[Reason]:
        """Why nothing is published at one of them; None where there is none that stays."""
        return _PLACE_LEFT if any(place.is_certain for place in self._places) else None

    def note(self, outlines: Iterable[np.ndarray], at: float) -> None:
        """
        Remember what a frame tells.

        :param outlines: Each of shape (n, 2), int32, columns u and v in px.
        :param at: When it was taken, in s.
        """
        self._told = [one for one in self._told
                      if one.is_certain or 0 <= at - one.last_at <= _CERTAIN_S]
        for outline in outlines:
            self._add(_hull([outline]), at)
        self._find_places()

    def remember(self, before: 'OldPlaces', reach_px: int) -> None:
        """Take over another camera's, which stood up to so many px from here."""
        self._told = [one._replace(hull=_grown(one.hull, reach_px)) for one in before._told]
        self._find_places()

    def forget_those_back(self, differs: np.ndarray, scale: int,
                          detections: Sequence[Detection]) -> None:
        """
        Forget the places where the background is seen again.

        :param differs: Where the frame differs, shape (h / scale, w / scale), uint8, 1 there.
        :param detections: All that was detected.
        """
        self._told = [
            one for one in self._told
            if covered_share(differs, one.hull, scale) > _MOST_CHANGED
            or any(_touch(one.hull, detection) for detection in detections)]
        self._find_places()

    def hold(self, one: Detection, is_known: bool) -> bool:
        """
        Tell whether an object may be a part of one of them.

        :param is_known: Whether it was seen before, free: only a place that stays holds it.
        """
        return any(_touch(place.hull, one) for place in self._places
                   if place.is_certain or not is_known and one.area <= _LARGER * place.area)

    def certain_but_for(self, told: Sequence[Detection]) -> List[Detection]:
        """
        Give the places that stay and that nothing tells of.

        :param told: What was left out for one of them.
        """
        return [place.detection for place in self._places if place.is_certain
                and not any(_touch(place.hull, one) for one in told)]

    def _add(self, hull: np.ndarray, at: float) -> None:
        area = cv2.contourArea(hull)
        for number, one in enumerate(self._told):
            whole = _hull([one.hull, hull])
            if cv2.contourArea(whole) <= _LARGER * max(min(one.first_area, area), 1.0):
                self._told[number] = one._replace(hull=whole, last_at=at)
                return
        self._told.append(_Told(hull, area, at, at))

    def _find_places(self) -> None:
        certain = [one.hull for one in self._told if one.is_certain]
        self._places = [OldPlace(hull, True) for hull in _joined(certain)]
        if len(certain) < len(self._told):
            self._places += [OldPlace(hull, False)
                             for hull in _joined([one.hull for one in self._told])]


def _joined(hulls: Sequence[np.ndarray]) -> List[np.ndarray]:
    joined: List[np.ndarray] = []
    for hull in hulls:
        near = [other for other in joined if _are_near(hull, other)]
        joined = [other for other in joined if not any(other is one for one in near)]
        joined.append(_hull([hull, *near]))
    return joined


def _hull(outlines: Sequence[np.ndarray]) -> np.ndarray:
    points = np.concatenate([outline.reshape(-1, 2) for outline in outlines])
    return cv2.convexHull(points.astype(np.int32)).reshape(-1, 2)


def _grown(hull: np.ndarray, reach_px: int) -> np.ndarray:
    steps = np.int32([[-1, -1], [-1, 1], [1, -1], [1, 1]]) * reach_px
    return _hull([hull + step for step in steps])


def _are_near(one: np.ndarray, other: np.ndarray) -> bool:
    (x, y, width, height), (u, v, across, down) = map(cv2.boundingRect, (one, other))
    reach = max(width, height, across, down)
    return (x - reach < u + across and u - reach < x + width
            and y - reach < v + down and v - reach < y + height)


def _touch(hull: np.ndarray, one: Detection) -> bool:
    x, y, width, height = cv2.boundingRect(hull)
    box = one.box
    if (box.x > x + width + _MARGIN_PX or box.x + box.width < x - _MARGIN_PX
            or box.y > y + height + _MARGIN_PX or box.y + box.height < y - _MARGIN_PX):
        return False
    corner = x - _MARGIN_PX, y - _MARGIN_PX
    shape = height + 2 * _MARGIN_PX, width + 2 * _MARGIN_PX
    place, thing = (cv2.fillPoly(np.zeros(shape, np.uint8), [outline], 1,
                                 offset=(-corner[0], -corner[1]))
                    for outline in (hull, np.int32(one.outline).reshape(-1, 2)))
    around = cv2.dilate(place, np.ones((2 * _MARGIN_PX + 1,) * 2, np.uint8))
    return cv2.countNonZero(around & thing) > _LEAST_TOUCHED * one.area
