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

"""
The precise detector: what differs from the background, and what of that is an object.

Each step is a module of its own:

- `reference`, `light`, `noise`, `limits`: the background at the frame's light, and from which
  levels on a pixel shows something else, in any colour.
- `regions`: where such pixels are connected.
- `foreign_light`: shade from outside of the picture, which is no object.
- `ghosts`: objects of the background that have left, which are no objects of the frame.
- `shadow`, `highlight`: what of a region is its object's shade, and what its gloss.
- `shaded`: what lies in the shade of an arm.
- `shares`: the object's place, by how much of each pixel it covers.
- `plain`: the short way for most objects.
- `touching`: objects that touch, one each.

Nothing on a frame changes the background; only what it is compared with is painted over where an
object of the background has left, for as long as it is away. Noise and that apart, a frame gives
the same result whatever came before.
"""

from typing import List, Optional, Tuple

from camera_to_base.checks import finite_number
from camera_to_base.detection.detection import (
    Box, check_frame, check_same_size, Detection, Pixel, touches_edge)
from camera_to_base.detection.precise.foreign_light import (
    field_of_bands, find_bands, find_field, looks_like_light)
from camera_to_base.detection.precise.ghosts import find_ghost, Ghost
from camera_to_base.detection.precise.highlight import close_around_highlights
from camera_to_base.detection.precise.limits import Range
from camera_to_base.detection.precise.piece import make_piece, outline_of, Piece
from camera_to_base.detection.precise.plain import find_plain, place_plain, Plain
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import filled, find_regions, grown, Region, slices
from camera_to_base.detection.precise.shaded import find_shaded
from camera_to_base.detection.precise.shadow import split_off_shade
from camera_to_base.detection.precise.shares import place, place_whole, Placed
from camera_to_base.detection.precise.tiles import (
    changed_parts, changed_strips, frame_outline, is_all_changed)
from camera_to_base.detection.touching import nearest_part, split_touching
import cv2
import numpy as np

# A frame full of specks must not take long: only the largest objects get the full treatment.
_MOST_EXACT, _MOST_GHOSTS = 100, 4
# Surroundings that a region's place is told from, in px.
_SURROUNDINGS = 14
# Light that reaches into the picture covers at least this part of it, and hardly more than half.
_LEAST_LIGHT, _MOST_LIGHT = 0.015, 0.65
# A faint region whose box covers at least this part may go on to the border; faint is a region of
# whose box less than this part differs strongly.
_FAR, _FAINT = 0.04, 0.15
# What is left over where light was taken out is an object where this part of it differs strongly.
_MOSTLY = 0.4
# What reaches in from the edge and covers more than this part is not looked at closely.
_MOST_CUT = 0.2


class PreciseDifferenceDetector:
    """
    Find objects by their difference to the background, at the frame's own light.

    :param background: The surface, preferably without an object, shape (h, w, 3), uint8, BGR.
    :param faintest: How many grey levels an object must at least differ by, in one of the colours.
    :param split_touching: Whether convex objects that touch come as one each.
    :param min_area: Objects that show less are taken for noise, in px².
    :raises InvalidValueError: If the background or a parameter cannot be used.
    """

    def __init__(
        self, background: np.ndarray, *, faintest: float = 13.0, min_area: float = 30.0,
        split_touching: bool = False,
    ) -> None:
        self.check_parameters(faintest, min_area)
        check_frame(background, 'background')
        self._faintest, self._min_area = faintest, min_area
        self._split_touching = split_touching
        self._background = background.copy()
        self._reference = Reference(self._background, faintest)
        self._ghosts: List[Ghost] = []

    @staticmethod
    def check_parameters(faintest: float, min_area: float) -> None:
        """
        Check the detector's parameters without a background.

        :raises InvalidValueError: If one cannot be used; the text names it and its range.
        """
        finite_number('faintest', faintest, 0, 255)
        finite_number('min_area', min_area, 1, 1e9)

    def detect(self, frame: np.ndarray) -> List[Detection]:
        """
        Find the objects on a frame.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :returns: The largest first; none is [].
        :raises FrameSizeError: If the frame's size is not the background's.
        :raises InvalidValueError: If it is not a colour picture.
        """
        check_same_size(frame, self._background)
        frame = np.ascontiguousarray(frame)
        self._reference.follow(frame)
        self._forget_ghosts(frame)
        lit, limits = self._reference.lit, self._reference.limits
        strips = changed_strips(frame, lit, limits)
        if not strips:
            return []
        if is_all_changed(frame, lit, strips, limits):
            return _unplaced(frame_outline(frame), frame)
        plain, regions = self._search(frame, changed_parts(frame, lit, strips, limits))
        if self._notice_ghosts(frame, regions):
            plain, regions = self._search(frame, self._changed_parts(frame))
        found = [detection for one in plain
                 for detection in self._placed(one.placed, one.window)]
        found += [detection for index, region in enumerate(regions)
                  for detection in self._detections(frame, region, index < _MOST_EXACT)]
        return sorted(found, key=lambda detection: -detection.area)

    @property
    def taken_away(self) -> List[Detection]:
        """Where objects of the background are missing, as of the last frame."""
        return [detection for ghost in self._ghosts for detection in _unplaced(
            outline_of(ghost.mask) + np.int32([ghost.window.x, ghost.window.y]),
            self._background)]

    @property
    def noise(self) -> Optional[float]:
        """The noise of a frame, in grey levels on most of the background; None before a frame."""
        return self._reference.mean_noise

    def _notice_ghosts(self, frame: np.ndarray, regions: List[Region]) -> bool:
        found = [find_ghost(frame, self._reference.lit, region)
                 for region in regions[:_MOST_GHOSTS]
                 if self._reference.has_edges(slices(grown(region.box, 2, frame)))]
        ghosts = [ghost for ghost in found if ghost is not None]
        if ghosts:
            self._use_ghosts(self._ghosts + ghosts, frame)
        return bool(ghosts)

    def _forget_ghosts(self, frame: np.ndarray) -> None:
        if not self._ghosts:
            return
        background = self._reference.at_this_light(self._background)
        away = [ghost for ghost in self._ghosts
                if not ghost.is_back(frame, background, self._faintest)]
        if len(away) < len(self._ghosts):
            self._use_ghosts(away, frame)

    def _use_ghosts(self, ghosts: List[Ghost], frame: np.ndarray) -> None:
        self._ghosts = ghosts
        picture = self._background.copy()
        for ghost in ghosts:
            ghost.paint_over(picture)
        self._reference = Reference(picture, self._faintest)
        self._reference.follow(frame)

    def _changed_parts(self, frame: np.ndarray) -> List[Box]:
        lit, limits = self._reference.lit, self._reference.limits
        return changed_parts(frame, lit, changed_strips(frame, lit, limits), limits)

    def _search(
        self, frame: np.ndarray, parts: List[Box]
    ) -> Tuple[List[Plain], List[Region]]:
        reference, plain, others = self._reference, [], []
        for part in parts:
            one = find_plain(frame, part, reference)
            if one is None:
                others.append(part)
            else:
                plain.append(one)
        regions = find_regions(frame, others, reference.limits, self._min_area)
        # A window that grew may hold a plain object of another part.
        regions = [region for region in regions
                   if not any(_is_inside(region.box, one.window) for one in plain)]
        if not any(self._may_reach_border(frame, region) for region in regions):
            return plain, regions
        field = self._field(frame, regions)
        if field is None:
            return plain, regions
        reference.limits.use_field(field)
        try:
            regions = find_regions(
                frame, self._changed_parts(frame), reference.limits, self._min_area)
        finally:
            reference.limits.use_field(None)
        return [], [region for region in regions if touches_edge(region.box, frame)
                    or region.strong_area > _MOSTLY * cv2.contourArea(region.outline)]

    def _field(self, frame: np.ndarray, regions: List[Region]) -> Optional[Range]:
        lit = self._reference.lit
        bands = find_bands(frame, lit)
        if any(self._may_be_light(frame, region) for region in regions):
            return find_field(frame, lit, bands)
        return None if bands is None else field_of_bands(bands, frame)

    def _may_reach_border(self, frame: np.ndarray, region: Region) -> bool:
        # A faint shadow is seen to the border less than elsewhere, where a lens is darker.
        is_faint = region.strong_area < _FAINT * region.box.width * region.box.height
        return (touches_edge(region.box, frame) or is_faint
                and region.box.width * region.box.height > _FAR * frame[..., 0].size)

    def _may_be_light(self, frame: np.ndarray, region: Region) -> bool:
        area = cv2.contourArea(region.outline) / frame[..., 0].size
        if not _LEAST_LIGHT < area < _MOST_LIGHT or not self._may_reach_border(frame, region):
            return False
        part = slices(region.box)
        return looks_like_light(
            frame[part], self._reference.lit[part], filled(region.outline, region.box))

    def _detections(self, frame: np.ndarray, region: Region, exact: bool) -> List[Detection]:
        is_at_edge = touches_edge(region.box, frame)
        if not exact or is_at_edge and region.strong_area > _MOST_CUT * frame[..., 0].size:
            return _unplaced(region.outline, frame)
        if not is_at_edge:
            window = grown(region.box, 1, frame)
            placed = place_plain(frame, window, filled(region.outline, window, 255),
                                 region.outline, self._reference)
            if placed is not None:
                return self._placed(placed, window)
        window = grown(region.box, _SURROUNDINGS, frame)
        part = slices(window)
        piece = make_piece(
            frame[part], self._reference.light(part), filled(region.outline, window))
        found = self._long_way(frame, piece, window)
        if found and found[0].cut_off:
            found += self._in_shade_of(frame, piece, window)
        return found

    def _in_shade_of(self, frame: np.ndarray, piece: Piece, window: Box) -> List[Detection]:
        found = []
        for mask in find_shaded(piece, self._min_area):
            box = grown(Box(*cv2.boundingRect(mask)), _SURROUNDINGS, mask)
            part = slices(box)
            one = Piece(piece.frame[part], piece.table[part], mask[part])
            found += self._placed(
                place(one), box._replace(x=box.x + window.x, y=box.y + window.y))
        return found

    def _long_way(self, frame: np.ndarray, piece: Piece, window: Box) -> List[Detection]:
        height, width = frame.shape[:2]
        outward = (window.x + (window.width - width) / 2, window.y + (window.height - height) / 2)
        thing = split_off_shade(piece, outward)
        if thing is not None:
            piece = piece._replace(mask=thing.mask)
        if thing is None or not thing.is_light:
            piece = piece._replace(mask=close_around_highlights(piece))
        outline = outline_of(piece.mask)
        if outline is None:
            return []
        outline = outline + np.int32([window.x, window.y])
        if touches_edge(Box(*cv2.boundingRect(outline)), frame):
            return _unplaced(outline, frame)
        is_whole = thing is not None and thing.is_light
        return self._placed(place_whole(piece) if is_whole else place(piece), window)

    def _placed(self, placed: Placed, window: Box) -> List[Detection]:
        parts = split_touching(placed.mask) if self._split_touching else [placed.mask]
        if len(parts) == 1:
            return _detection(placed, window)
        nearest = nearest_part(parts)
        return [detection for index, part in enumerate(parts) for detection in _detection(
            Placed(placed.shares * (nearest == index), part), window)]


def _is_inside(box: Box, window: Box) -> bool:
    return (window.x <= box.x and box.x + box.width <= window.x + window.width
            and window.y <= box.y and box.y + box.height <= window.y + window.height)


def _detection(placed: Placed, window: Box) -> List[Detection]:
    moments = placed.moments(window.x, window.y)
    outline = outline_of(placed.mask) if placed.outline is None else placed.outline
    if not moments['m00'] or outline is None:
        return []
    outline = outline + np.int32([window.x, window.y])
    centre = Pixel(moments['m10'] / moments['m00'], moments['m01'] / moments['m00'])
    return [Detection(
        Box(*cv2.boundingRect(outline)), centre, moments['m00'], outline[:, 0], False, moments)]


def _unplaced(outline: np.ndarray, frame: np.ndarray) -> List[Detection]:
    # Where a part is missing, the rim does not matter.
    moments = cv2.moments(outline)
    if not moments['m00']:
        return []
    box = Box(*cv2.boundingRect(outline))
    centre = Pixel(moments['m10'] / moments['m00'], moments['m01'] / moments['m00'])
    return [Detection(
        box, centre, moments['m00'], outline[:, 0], touches_edge(box, frame), moments)]
