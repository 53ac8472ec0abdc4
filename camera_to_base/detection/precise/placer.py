# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Places what was found: plain objects by the short way, regions by the long way."""

from dataclasses import replace
import math
from typing import List, NamedTuple, Tuple

from camera_to_base.detection.detection import Box, Detection, Pixel, touches_edge
from camera_to_base.detection.precise.gloss import lighter, with_highlights
from camera_to_base.detection.precise.own_shadow import split_off_shade
from camera_to_base.detection.precise.piece import (
    centre_of, channel_sum, enclosed, enlarged, filled, fullness, grown, make_piece, outline_of,
    outlines_in, Piece, reduced, slices, square)
from camera_to_base.detection.precise.plain import Plain
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import CONVEX, Region
from camera_to_base.detection.precise.segments import COLOURED
from camera_to_base.detection.precise.shade import change_of
from camera_to_base.detection.precise.shares import place, place_thing, Placed
from camera_to_base.detection.touching import nearest_part, split_touching, without_necks
import cv2
import numpy as np

# Surroundings that a region's place is told from, in px.
_SURROUNDINGS = 12
# A larger window is reduced, in px²: to tell what of it is an object, and to place the object.
_MOST_TO_TELL, _MOST_TO_PLACE = 60_000, 80_000
# What reaches in from the edge may be a hand, which a soft shadow must not be split off from: it
# is looked at in full, or not at all.
_MOST_AT_EDGE = 150_000
# Where a darker part is told from a lighter one alone, what was split off is the object's in 2 of
# 21 cases (rendered cells): the deviation, by how far that moves its centre.
_OF_SHADE = 0.3
# Both sides of a rim, in px from it. A print hides a rim where it has a step of twice what a thing
# must differ by, and the thing is off the print beyond it by less than this part of the step.
_BESIDE, _CLEAR_STEP, _SAME_COLOUR = 3, 2.0, 0.3
# On how much of a rim that matters; the deviation of the centre, by that part and by the square
# root of the area: 26 white discs over the edges of printed squares were 0.07 to 2 of that off.
_LEAST_HIDDEN, _OF_SIZE = 0.2, 0.75


class Placing(NamedTuple):
    """
    How a region was placed.

    :param detections: The objects in it.
    :param region: The region as another frame that shows the same may be placed from.
    """

    detections: List[Detection]
    region: Region


class Placer:
    """
    Makes detections of what was found.

    :param min_area: Objects that show less are taken for noise, in px².
    :param splits: Whether convex objects that touch come as one each.
    """

    def __init__(self, min_area: float, splits: bool) -> None:
        self._min_area, self._split_touching = min_area, splits

    def place_plain(self, plain: Plain) -> List[Detection]:
        """Give a plain object, or the objects that it is split into."""
        return self._placed(plain.placed, plain.window)

    def place_region(
        self, frame: np.ndarray, region: Region, reference: Reference
    ) -> Placing:
        """Give the objects in a region of a frame; none where all of it may be light."""
        if not region.is_thing:
            return Placing(self._unclear(frame, region, reference), region)
        return self._thing(frame, region, reference)

    def _unclear(
        self, frame: np.ndarray, region: Region, reference: Reference
    ) -> List[Detection]:
        is_at_edge = touches_edge(region.box, frame)
        box = grown(region.box, _SURROUNDINGS, frame)
        window = _Window(frame, reference, box, filled(region.outline, box))
        if is_at_edge and window.mask.size > _MOST_AT_EDGE:
            return unplaced(region.outline, frame)
        return self._long_way(window, is_at_edge, region)

    def _thing(
        self, frame: np.ndarray, region: Region, reference: Reference
    ) -> Placing:
        if touches_edge(region.box, frame):
            return Placing(_doubted(unplaced(region.outline, frame), region), region)
        box = grown(region.box, _SURROUNDINGS, frame)
        window = _Window(frame, reference, box, filled(region.outline, box))
        coarse, scale = window.reduced(_MOST_TO_PLACE)
        others = None
        if region.neighbours and scale == 1:
            others = np.zeros_like(window.mask)
            cv2.drawContours(
                others, region.neighbours, -1, 1, cv2.FILLED, offset=(-box.x, -box.y))
        placed, last = place_thing(coarse, others, region.is_settled)
        placed = self._at_full_size(placed, coarse, scale, window.mask)
        found = _doubted(self._placed(placed, box), region)
        # What comes apart must do so on each frame.
        if not region.is_settled and len(outlines_in(placed.mask)) == 1:
            last = enlarged(last, scale, window.mask)
            outline = outline_of(last, box)
            if outline is not None and not cv2.countNonZero(last ^ filled(outline, box)):
                region = region._replace(outline=outline, is_settled=True)
        return Placing(found, region)

    def _long_way(
        self, window: '_Window', is_at_edge: bool, region: Region
    ) -> List[Detection]:
        coarse, scale = window.reduced(_MOST_AT_EDGE if is_at_edge else _MOST_TO_TELL)
        thing = split_off_shade(coarse)
        if thing is None and region.may_be_light:
            return []
        mask = window.mask
        if thing is not None:
            whole, = with_highlights(
                [thing], channel_sum(coarse.frame - coarse.table), lighter(coarse), coarse.mask)
            mask = enlarged(whole, scale, mask)
        outline = outline_of(mask, window.box)
        if outline is None:
            return []
        if touches_edge(Box(*cv2.boundingRect(outline)), window.frame):
            return unplaced(outline, window.frame)
        found = self._at(window, mask)
        if thing is None:
            return _doubted(found, region)
        doubt = _OF_SHADE * scale * math.dist(centre_of(thing), centre_of(coarse.mask))
        return [replace(one, doubt=max(doubt, region.doubt)) for one in found]

    def _at(self, window: '_Window', mask: np.ndarray) -> List[Detection]:
        # Only what is near the object takes time.
        near = window.around(mask)
        coarse, scale = near.reduced(_MOST_TO_PLACE)
        placed = self._at_full_size(place(coarse), coarse, scale, near.mask)
        return self._placed(placed, near.box)

    def _at_full_size(
        self, placed: Placed, coarse: Piece, scale: int, like: np.ndarray
    ) -> Placed:
        """Give what was placed in a reduced piece, without the necks between things."""
        mask = without_necks(
            placed.mask, coarse.frame, coarse.table, self._min_area / scale ** 2)
        shares = placed.shares * (1 - (placed.mask & (1 - mask)))
        return Placed(*(enlarged(one, scale, like) for one in (shares, mask)))

    def _placed(self, placed: Placed, window: Box) -> List[Detection]:
        parts = [placed.mask]
        if placed.outline is None:
            parts = self._separate(placed.mask)
        if self._split_touching:
            parts = [one for part in parts for one in split_touching(part)]
        if len(parts) == 1:
            return _detection(placed, window)
        nearest = nearest_part(parts)
        return [detection for index, part in enumerate(parts) for detection in _detection(
            Placed(placed.shares * (nearest == index), part), window)]

    def _separate(self, mask: np.ndarray) -> List[np.ndarray]:
        outlines = [one for one in outlines_in(mask) if enclosed(one) >= self._min_area]
        if len(outlines) < 2:
            return [mask]
        whole = Box(0, 0, *mask.shape[::-1])
        return [filled(outline, whole) for outline in outlines]


class _Window:
    """
    A region's surroundings on a frame.

    :param mask: The region, shape (height, width) of the box, uint8, 1 inside.
    """

    def __init__(
        self, frame: np.ndarray, reference: Reference, box: Box, mask: np.ndarray
    ) -> None:
        self.frame, self._reference = frame, reference
        self.box, self.mask = box, mask

    @property
    def piece(self) -> Piece:
        """Its light."""
        part = slices(self.box)
        return make_piece(self.frame[part], self._reference.light(part), self.mask)

    def reduced(self, most: int) -> Tuple[Piece, int]:
        """Give its light with few pixels, see :func:`piece.reduced`."""
        return reduced(self.piece, most)

    def around(self, mask: np.ndarray) -> '_Window':
        """Give what surrounds a mask of this window."""
        return self._cut(grown(Box(*cv2.boundingRect(mask)), _SURROUNDINGS, mask), mask)

    def _cut(self, near: Box, mask: np.ndarray) -> '_Window':
        box = near._replace(x=near.x + self.box.x, y=near.y + self.box.y)
        return _Window(self.frame, self._reference, box, np.ascontiguousarray(mask[slices(near)]))


def hidden_doubt(detection: Detection, frame: np.ndarray, reference: Reference) -> float:
    """
    Give the deviation of a centre because its thing may go on over a print of its colour, in px.

    A white disc that lies half on a black square and half on a white one seems to end where the
    squares meet. What is cut off has no centre to doubt.
    """
    if detection.cut_off:
        return 0.0
    window = grown(detection.box, 2 * _BESIDE, frame)
    part, least = slices(window), _CLEAR_STEP * reference.limits.least
    print_ = reference.limits.has_print(part, least)
    if not cv2.countNonZero(print_):
        return 0.0
    inside = filled(np.int32(detection.outline)[:, None], window)
    rim = max(cv2.findContours(inside, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0],
              key=len)[:, 0]
    if np.count_nonzero(print_[tuple(rim.T[::-1])]) < _LEAST_HIDDEN * len(rim):
        return 0.0
    # An outer outline goes around in the direction that makes this point outwards.
    along = np.roll(rim, -_BESIDE, axis=0) - np.roll(rim, _BESIDE, axis=0)
    out = _BESIDE * along[:, ::-1] * (-1, 1) / np.maximum(np.hypot(*along.T), 1)[:, None]
    within, beyond = (
        tuple(np.clip(np.rint(rim + way).astype(int), 0, (window.width - 1, window.height - 1)
                      ).T[::-1]) for way in (-out, out))
    seen, usual = (np.float32(cv2.blur(picture[part], (3, 3)))
                   for picture in (frame, reference.lit))
    step = _off(usual[within], usual[beyond])
    is_hidden = ((step > least) & (_off(seen[within], usual[beyond]) < _SAME_COLOUR * step)
                 & (_off(seen[beyond], usual[beyond]) < least))
    # Where a thing is narrow, this is beyond its other side.
    is_hidden &= cv2.erode(inside, square(3))[within] > 0
    share = np.count_nonzero(is_hidden) / len(rim)
    return _OF_SIZE * share * math.sqrt(detection.area) if share > _LEAST_HIDDEN else 0.0


def notch_doubt(detection: Detection, frame: np.ndarray, reference: Reference) -> float:
    """
    Give the deviation of a centre because a face may be missing in a notch of its outline, in px.

    A grey face may look like its thing's shade, or like the table. A coloured thing's does not.
    """
    box, outline = detection.box, np.int32(detection.outline)[:, None]
    if detection.cut_off or fullness(outline) > CONVEX:
        return 0.0
    inside = filled(outline, box)
    levels = (cv2.mean(picture[slices(box)], inside)[:3] for picture in (frame, reference.lit))
    if change_of(*levels)[0] > COLOURED:
        return 0.0
    return math.dist(centre_of(inside), centre_of(filled(cv2.convexHull(outline), box)))


def _off(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.abs(one - other).max(axis=1)


def _doubted(found: List[Detection], thing: Region) -> List[Detection]:
    return [replace(one, doubt=thing.doubt) for one in found]


def _detection(placed: Placed, window: Box) -> List[Detection]:
    moments = placed.moments(window.x, window.y)
    outline = outline_of(placed.mask, window) if placed.outline is None else placed.outline
    if not moments['m00'] or outline is None:
        return []
    centre = Pixel(moments['m10'] / moments['m00'], moments['m01'] / moments['m00'])
    return [Detection(
        Box(*cv2.boundingRect(outline)), centre, moments['m00'], outline[:, 0], False, moments)]


def unplaced(outline: np.ndarray, frame: np.ndarray) -> List[Detection]:
    """Give what an outline encloses: where a part is missing, the rim does not matter."""
    moments = cv2.moments(outline)
    if not moments['m00']:
        return []
    box = Box(*cv2.boundingRect(outline))
    centre = Pixel(moments['m10'] / moments['m00'], moments['m01'] / moments['m00'])
    return [Detection(
        box, centre, moments['m00'], outline[:, 0], touches_edge(box, frame), moments)]
