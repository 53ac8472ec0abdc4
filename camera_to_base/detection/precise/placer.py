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

"""Places what was found: plain objects by the short way, regions by the long way."""

from typing import Callable, List

from camera_to_base.detection.detection import Box, Detection, Pixel, touches_edge
from camera_to_base.detection.precise.highlight import close_around_highlights
from camera_to_base.detection.precise.piece import make_piece, outline_of, Piece
from camera_to_base.detection.precise.plain import place_plain, Plain
from camera_to_base.detection.precise.reduced import enlarged, reduced
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import filled, grown, Region, slices
from camera_to_base.detection.precise.shaded import find_shaded
from camera_to_base.detection.precise.shadow import split_off_shade
from camera_to_base.detection.precise.shares import place, place_whole, Placed
from camera_to_base.detection.touching import nearest_part, split_touching
import cv2
import numpy as np

# Surroundings that a region's place is told from, in px.
_SURROUNDINGS = 12
# A larger object, its surroundings included, is placed on a reduced picture; in px².
_MOST_TO_PLACE = 80_000
# What reaches in from the edge and covers more than this part is not looked at closely.
_MOST_CUT = 0.2


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
    ) -> List[Detection]:
        """Give the objects in a region of a frame."""
        is_at_edge = touches_edge(region.box, frame)
        if is_at_edge and region.strong_area > _MOST_CUT * frame[..., 0].size:
            return unplaced(region.outline, frame)
        if not is_at_edge and not region.in_other_light:
            window = grown(region.box, 1, frame)
            placed = place_plain(frame, window, filled(region.outline, window, 255),
                                 region.outline, reference)
            if placed is not None:
                return self._placed(placed, window)
        window = grown(region.box, _SURROUNDINGS, frame)
        part = slices(window)
        piece = make_piece(
            frame[part], reference.light(part), filled(region.outline, window))
        found = self._long_way(frame, piece, window)
        if found and found[0].cut_off:
            found += self._in_shade_of(piece, window)
        return found

    def _in_shade_of(self, piece: Piece, window: Box) -> List[Detection]:
        return [detection for mask in find_shaded(piece, self._min_area)
                for detection in self._at(piece._replace(mask=mask), window, place)]

    def _at(
        self, piece: Piece, window: Box, way: Callable[[Piece], Placed]
    ) -> List[Detection]:
        # Only what is near the object takes time.
        box = grown(Box(*cv2.boundingRect(piece.mask)), _SURROUNDINGS, piece.mask)
        part = slices(box)
        near = Piece(*(np.ascontiguousarray(picture[part]) for picture in piece))
        coarse, scale = reduced(near, _MOST_TO_PLACE)
        placed = way(coarse)
        return self._placed(
            Placed(enlarged(placed.shares, scale, near.mask),
                   enlarged(placed.mask, scale, near.mask)),
            box._replace(x=box.x + window.x, y=box.y + window.y))

    def _long_way(self, frame: np.ndarray, piece: Piece, window: Box) -> List[Detection]:
        height, width = frame.shape[:2]
        outward = (window.x + (window.width - width) / 2, window.y + (window.height - height) / 2)
        thing = split_off_shade(piece, outward)
        if thing is not None:
            piece = piece._replace(mask=thing.mask)
        if thing is None or not thing.is_light:
            piece = piece._replace(mask=close_around_highlights(piece))
        outline = outline_of(piece.mask, window)
        if outline is None:
            return []
        if touches_edge(Box(*cv2.boundingRect(outline)), frame):
            return unplaced(outline, frame)
        is_whole = thing is not None and thing.is_light
        return self._at(piece, window, place_whole if is_whole else place)

    def _placed(self, placed: Placed, window: Box) -> List[Detection]:
        parts = split_touching(placed.mask) if self._split_touching else [placed.mask]
        if len(parts) == 1:
            return _detection(placed, window)
        nearest = nearest_part(parts)
        return [detection for index, part in enumerate(parts) for detection in _detection(
            Placed(placed.shares * (nearest == index), part), window)]


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
