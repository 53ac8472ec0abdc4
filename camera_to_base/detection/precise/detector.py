# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
The precise detector: what differs from the background, and what of that is an object.

A shadow whose object is cut off, or is as light as the table, may be found without it. Then, and
where some edges are soft and none tells of a thing, it is `light_or_thing`: left out by default;
if it is published, it comes last, and its centre is in doubt.

Each step is a module of its own:

- `reference`: the background at the frame's `light`, its `noise`, and from which levels on a
  pixel shows something else, in any colour.
- `changes`: where on the frame there are such pixels at all, in bytes.
- `plain`: the short way for most objects; it says what decides between the ways.
- `shade`: how dark and of which tint the shade of this frame is.
- `evidence`, `segments`, `faces`, `things`: what of a region is a thing, and what is shade, sun or
  a lamp, pixel by pixel, edge by edge, and by chroma and texture where there is no edge; they say
  nothing where the picture cannot tell.
- `search`, `regions`: where such pixels are connected, for the long way.
- `still`: what was told of regions that lie still, so that it need not be told again.
- `other_light`: smooth light, a lamp that flickers, shade from outside: taken out, no objects.
- `ghosts`: objects of the background that have left, which are no objects of the frame.
- `own_shadow`: where `things` says nothing, what of a region is its object's shade.
- `gloss`: highlights, on things and in glass.
- `light_alone`: which of what was found light alone could look like.
- `placer`, `shares`: the object's place, by how much of each pixel it covers.
- `touching`: objects that touch, one each.

The largest detection is the first.

Nothing on a frame changes the background; only what it is compared with is painted over where an
object of the background has left, for as long as it is away. Noise, that and the budget apart, a
frame gives the same result whatever came before.
"""

from dataclasses import replace
from itertools import takewhile
import math
from typing import Dict, List, Optional, Tuple

from camera_to_base.checks import check_frame, check_same_size, finite_number
from camera_to_base.detection.detection import Box, Detection, NoObject, touches_edge
from camera_to_base.detection.precise.changes import (
    changed_parts, frame_outline, is_all_changed, Strips)
from camera_to_base.detection.precise.ghosts import find_ghost, Ghost
from camera_to_base.detection.precise.light_alone import (
    is_soft_light, LIGHT_OR_THING, Told, told)
from camera_to_base.detection.precise.piece import (
    filled, fullness, grown, outline_of, slices, square, without_rim)
from camera_to_base.detection.precise.placer import (
    hidden_doubt, notch_doubt, Placer, Placing, unplaced)
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import CONVEX, Region
from camera_to_base.detection.precise.search import (
    Budget, Candidates, left_over, parts_of, search)
from camera_to_base.detection.precise.shade import change_of
from camera_to_base.detection.precise.still import StillRegions
from camera_to_base.errors import InvalidValueError
import cv2
import numpy as np

# An object differs as much as one must on this part of it; but one that has more chroma than light
# gives it, a logarithm, may be fainter.
_LEAST_STRONG, _COLOURED = 0.5, 0.12
# Unless it is a thing with a ragged outline, it may look like the table in part: it is no trace of
# light where this part of it differs by so many times that.
_LEAST_CLEAR, _CLEAR = 0.05, 3.0

# A thing in more doubt than this, by the square root of its area, is a sliver of one, or of light.
_MOST_DOUBT = 0.45

# A frame full of specks must not take long: only the largest objects get the full treatment.
_MOST_EXACT, _MOST_GHOSTS = 100, 4


def _largest_first(found: List[Detection]) -> List[Detection]:
    return sorted(found, key=lambda detection: -detection.area)


def _is_lost(detection: Detection) -> bool:
    return detection.doubt > _MOST_DOUBT * math.sqrt(detection.area)


def _doubtful(detection: Detection) -> Detection:
    # It may be a shadow alone, or a part of its object.
    return replace(detection, doubt=math.sqrt(detection.area))


class PreciseDifferenceDetector:
    """
    Find objects by their difference to the background, at the frame's own light.

    :param background: The surface, preferably without an object, shape (h, w, 3), uint8, BGR.
    :param faintest: How many grey levels an object must at least differ by, in one of the colours.
    :param split_touching: Whether convex objects that touch come as one each.
    :param min_area: Objects that show less are taken for noise, in px².
    :param light_or_thing: What becomes of a thing that may be light as well: 'leave_out', unless
        its rim is sharp; 'leave_out_all'; 'publish', in doubt unless its rim is sharp.
    :param budget_px: How much is looked at closely on a frame, in px; the rest is left out.
    :raises InvalidValueError: If the background or a parameter cannot be used.
    """

    def __init__(
        self, background: np.ndarray, *, faintest: float = 13.0, min_area: float = 30.0,
        split_touching: bool = False, light_or_thing: str = 'leave_out',
        budget_px: float = 250_000,
    ) -> None:
        self.check_parameters(faintest, min_area, light_or_thing)
        check_frame(background, 'background')
        self._faintest, self._min_area = faintest, min_area
        self._placer = Placer(min_area, split_touching)
        self._light_or_thing, self._budget = light_or_thing, budget_px
        self._last: List[Detection] = []
        self._background = background.copy()
        self._reference = Reference(self._background, faintest)
        self._ghosts: List[Ghost] = []
        self._still = StillRegions()
        self._strips = Strips(background.shape)
        self._is_light_moving = True
        self._dropped: List[NoObject] = []

    @staticmethod
    def check_parameters(
        faintest: float, min_area: float, light_or_thing: str = 'leave_out'
    ) -> None:
        """
        Check the detector's parameters without a background.

        :raises InvalidValueError: If one cannot be used; the text names it and its range.
        """
        finite_number('faintest', faintest, 0, 255)
        finite_number('min_area', min_area, 1, 1e9)
        if light_or_thing not in LIGHT_OR_THING:
            raise InvalidValueError(f'light_or_thing must be one of {", ".join(LIGHT_OR_THING)}, '
                                    f'got {light_or_thing!r}')

    def detect(self, frame: np.ndarray) -> List[Detection]:
        """
        Find the objects on a frame.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :returns: The largest first, but nothing unclear before a clear one; none is [].
        :raises FrameSizeError: If the frame's size is not the background's.
        :raises InvalidValueError: If it is not a colour picture.
        """
        check_same_size(frame, self._background)
        self._dropped = []
        frame = np.ascontiguousarray(frame)
        rows = self._changed_rows(frame)
        if not rows:
            return []
        lit, limits = self._reference.lit, self._reference.limits
        if is_all_changed(frame, lit, rows, limits):
            self._strips.remember([Box(0, 0, *frame.shape[1::-1])])
            return unplaced(frame_outline(frame), frame)
        parts = changed_parts(frame, lit, rows, limits)
        self._strips.remember(parts)
        budget = Budget(self._budget, [one.box for one in self._last])
        found = search(frame, parts, self._reference, self._min_area, budget,
                       self._still.on(frame, self._reference))
        if self._notice_ghosts(found):
            parts = parts_of(frame, self._reference)
            found = search(frame, parts, self._reference, self._min_area, budget)
        placed, unclear, places = self._placed(found)
        placed, left = self._judged(placed, unclear, found.frame)
        placed = [replace(one, doubt=math.hypot(one.doubt, *(
            doubt(one, found.frame, self._reference) for doubt in (hidden_doubt, notch_doubt)
        ))) for one in placed]
        found = found._replace(light=[*found.light, *(
            NoObject(what.value, one.centre, one.area) for what, one in left)])
        self._dropped = left_over(
            found, parts, placed + [one for _, one in left], self._reference, self._min_area)
        self._still.remember(
            frame, self._reference, found.held, found.told, places,
            [one for one in self._dropped if one not in found.light])
        self._last = placed
        return placed

    def _placed(
        self, found: Candidates
    ) -> Tuple[List[Detection], List[Detection], Dict[Box, Placing]]:
        """Give the detections, what may be light as well, and how each region was placed."""
        frame, unclear = found.frame, []
        places: Dict[Box, Placing] = {}
        placed = [detection for one in found.plain for detection in self._placer.place_plain(one)]
        for index, region in enumerate(found.regions):
            if index >= _MOST_EXACT:
                placed += unplaced(region.outline, frame)
                continue
            place = self._placer.place_region(frame, region, self._reference)
            places[region.box], parts = place, place.detections
            if not region.in_other_light:
                parts, faint = self._without_faint(parts, frame, region)
                unclear += faint
            if region.may_be_light:
                unclear += parts or unplaced(region.outline, frame)
            else:
                for part in parts:
                    is_unclear = _is_lost(part) or is_soft_light(
                        part, frame, self._reference, region.is_thing)
                    (unclear if is_unclear else placed).append(part)
        placed = _largest_first(placed)
        if len(placed) + len(unclear) > 1:
            # Most frames have no such shadow: only until an object is the first.
            first = [*takewhile(lambda one: is_soft_light(one, frame, self._reference), placed)]
            placed, unclear = placed[len(first):], unclear + first
        return placed, [*map(_doubtful, _largest_first(unclear))], places

    def _judged(
        self, placed: List[Detection], unclear: List[Detection], frame: np.ndarray
    ) -> Tuple[List[Detection], List[Tuple[Told, Detection]]]:
        """Give what is published; and what is left out, with what was told of it."""
        published: List[Detection] = []
        left: List[Tuple[Told, Detection]] = []
        for one in placed:
            what = told(one, frame, self._reference)
            if what.is_light or what is Told.NEITHER and self._light_or_thing == 'leave_out_all':
                left.append((what, one))
            else:
                published.append(
                    replace(one, may_be_light=True) if what is Told.NEITHER else one)
        for one in unclear:
            what = told(one, frame, self._reference)
            if what.is_light or self._light_or_thing != 'publish':
                left.append((what if what.is_light else Told.NEITHER, one))
            else:
                published.append(one)
        return published, left

    def _without_faint(
        self, parts: List[Detection], frame: np.ndarray, region: Region
    ) -> Tuple[List[Detection], List[Detection]]:
        """Give the others, and the faint ones: but not the largest of what hides the table."""
        clear: List[Detection] = []
        faint: List[Detection] = []
        largest = (max(parts, key=lambda one: one.area, default=None)
                   if region.is_hiding else None)
        for part in parts:
            outline = np.int32(part.outline)[:, None]
            is_faint = (part is not largest and not part.cut_off
                        and self._is_faint(outline, part.box, frame, region.is_thing)
                        and not self._is_coloured(outline, part.box, frame))
            (faint if is_faint else clear).append(part)
        return clear, faint

    def _is_coloured(self, outline: np.ndarray, box: Box, frame: np.ndarray) -> bool:
        # Noise changes a mean less than each of its pixels. On the rim, the table is seen, too.
        inside = without_rim(filled(outline, box), square(3))
        return change_of(*(cv2.mean(picture[slices(box)], inside)[:3]
                           for picture in (frame, self._reference.lit)))[0] > _COLOURED

    def _is_faint(
        self, outline: np.ndarray, box: Box, frame: np.ndarray, is_thing: bool = False
    ) -> bool:
        part, limits = slices(box), self._reference.limits
        inside = filled(outline, box)
        area = cv2.countNonZero(inside)
        strong = cv2.countNonZero(limits.strong(frame, part) & inside)
        if strong >= _LEAST_STRONG * area:
            return False
        if is_thing and fullness(outline) <= CONVEX:
            return True
        # A part of it may look like the table.
        near = cv2.inRange(cv2.absdiff(frame[part], self._reference.lit[part]), 0,
                           (_CLEAR * limits.least,) * 3)
        return cv2.countNonZero(inside & ~near) < _LEAST_CLEAR * area

    @property
    def taken_away(self) -> List[Detection]:
        """Where objects of the background are missing, as of the last frame."""
        return [detection for ghost in self._ghosts for detection in unplaced(
            outline_of(ghost.mask, ghost.window), self._background)]

    @property
    def dropped(self) -> List[NoObject]:
        """What differs on the last frame and is no detection, the largest first, at most 100."""
        return self._dropped

    @property
    def noise(self) -> Optional[float]:
        """The noise of a frame, in grey levels on most of the background; None before a frame."""
        return self._reference.mean_noise

    def _changed_rows(self, frame: np.ndarray) -> List[slice]:
        # Reading all of a frame first makes each later look at a part faster; while the light
        # changes, it would be read twice.
        rows = None if self._is_light_moving else self._strips.changed(
            frame, self._reference.lit, self._reference.limits)
        self._is_light_moving = self._follow(frame)
        if rows is None or self._is_light_moving:
            rows = self._strips.changed(frame, self._reference.lit, self._reference.limits)
        return rows

    def _follow(self, frame: np.ndarray) -> bool:
        is_other_light = self._reference.follow(frame)
        return self._forget_ghosts(frame) or is_other_light

    def _notice_ghosts(self, found: Candidates) -> bool:
        frame = found.frame
        # What a hand holds covers the table, and so does the hand.
        reaching = [region.box for region in found.regions if touches_edge(region.box, frame)]
        ghosts = [find_ghost(frame, self._reference.lit, region)
                  for region in found.regions[:_MOST_GHOSTS]
                  if self._reference.has_edges(slices(grown(region.box, 2, frame)))
                  and not self._is_faint(region.outline, region.box, frame)
                  and not any(region.box.is_inside(box) for box in reaching if box != region.box)]
        ghosts = [ghost for ghost in ghosts if ghost is not None]
        if ghosts:
            self._use_ghosts(self._ghosts + ghosts, frame)
        return bool(ghosts)

    def _forget_ghosts(self, frame: np.ndarray) -> bool:
        if not self._ghosts:
            return False
        background = self._reference.at_this_light(self._background)
        away = [ghost for ghost in self._ghosts
                if not ghost.is_back(frame, background, self._faintest)]
        if len(away) == len(self._ghosts):
            return False
        self._use_ghosts(away, frame)
        return True

    def _use_ghosts(self, ghosts: List[Ghost], frame: np.ndarray) -> None:
        self._ghosts = ghosts
        self._still.forget()
        picture = self._background.copy()
        for ghost in ghosts:
            ghost.paint_over(picture)
        self._reference = Reference(picture, self._faintest)
        self._reference.follow(frame)
