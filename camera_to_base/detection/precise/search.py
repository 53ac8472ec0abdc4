# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
What may be an object on a frame: plain objects by the short way, and regions for the long way.

Smooth light and bands are taken out of the frame first. Where a region may be light with an edge
that comes from outside of the picture, all is looked at once more, with that taken into account.
"""

from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection.detection import Box, Detection, NoObject, Pixel, touches_edge
from camera_to_base.detection.precise.changes import changed_parts, Strips
from camera_to_base.detection.precise.evidence import BRIGHTEST
from camera_to_base.detection.precise.light import log_light
from camera_to_base.detection.precise.other_light import (
    Even, find_bands, find_field, has_light, in_usual_light, looks_like_light, thinned,
    without_bands, without_smooth_light)
from camera_to_base.detection.precise.piece import (
    centre_of, enclosed, filled, fullness, grown, outline_of, outlines_in, quantile, shrunk,
    slices, square, without_rim)
from camera_to_base.detection.precise.plain import find_plain, Plain
from camera_to_base.detection.precise.reference import LevelLimits, Range, Reference
from camera_to_base.detection.precise.regions import find_regions, goes_beyond, is_much, Region
from camera_to_base.detection.precise.segments import COLOURED
from camera_to_base.detection.precise.shade import change_of, DARKEST, measure_shade, Shade
from camera_to_base.detection.precise.still import Still
from camera_to_base.detection.precise.things import seen_closely, things_in, work
import cv2
import numpy as np

# Bands are looked for first where this part of a frame has changed, or more.
_LEAST_BANDS = 0.05
# Light that reaches into the picture covers at least this part of it, and hardly more than half.
_LEAST_LIGHT, _MOST_LIGHT = 0.015, 0.65
# What reaches in is a hand with its shade where this part of it is a thing. A part of it that is
# wider than the edge of a shade, px, is looked at alone, with what is so near, px, and farther
# where a thing goes on there. A thing goes around such a part where it fills so much of its hull.
# What is darker by this logarithm than most of a region that is light is looked at alone, too.
_LEAST_HAND, _NARROW, _NEARBY, _CONVEX, _DARKER = 0.2, 8, (16, 48), 0.85, 0.5
# A region's things are looked at again for at most so many times the work of the first look.
_AGAIN = 4
# Beyond an outline, pixels still show a share of the object: the outline's width, in px.
_RIM = 7
_MOST_DROPPED = 100
# How far a print may have moved, y and x, px: the background's range reaches one px farther; it is
# compared in patches of this size, px; which part of what differs may be unlike; in how many
# places a print moves.
_SHIFTS = [(y, x) for y in range(-4, 5, 2) for x in range(-4, 5, 2)]
_NEAR_PRINT, _PATCH, _MOST_UNLIKE, _LEAST_MOVED = np.ones((5, 5), np.uint8), 32, 0.1, 3
# So many px² are hidden by one thing alone.
_LEAST_SHARED = 10
# A part that is larger is no speck, in px².
_MOST_SPECK = 1200


class Budget(NamedTuple):
    """
    How much is looked at on a frame.

    :param area: In px of windows, see :func:`things.work`.
    :param first: Where objects were on the last frame.
    """

    area: float
    first: Sequence[Box]


class Candidates(NamedTuple):
    """
    What may be an object on a frame.

    :param frame: The frame, without the bands of a lamp that flickers.
    :param plain: The plain objects.
    :param regions: The other regions, the largest first.
    :param left: What the budget does not reach.
    :param told: The regions that were looked at closely, each with the things in it.
    :param held: What lies still, with what was told of it before; `regions` has its things.
    :param light: The smooth light that was taken out of the frame; what was told to be light.
    """

    frame: np.ndarray
    plain: List[Plain]
    regions: List[Region]
    left: Sequence[Region] = ()
    told: Sequence[Tuple[Region, Sequence[Region]]] = ()
    held: Sequence[Still] = ()
    light: Sequence[NoObject] = ()


def search(
    frame: np.ndarray, parts: List[Box], reference: Reference, min_area: float, budget: Budget,
    still: Sequence[Still] = (),
) -> Candidates:
    """
    Find what may be objects in the parts of a frame that have changed.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param parts: See :func:`changes.changed_parts`.
    :param min_area: What shows less is noise, in px².
    :param still: What the frame shows again, see `still`.
    """
    even = _evened(frame, parts, reference)
    if even is not None:
        frame, parts = even.frame, parts_of(even.frame, reference)
    found = _search(frame, parts, reference, min_area, budget, still)
    if even is not None:
        found = found._replace(light=even.light)
    if not any(_may_reach_border(frame, region) for region in found.regions):
        return found
    return _settled(_without_foreign_light(found, reference, min_area))


def _settled(found: Candidates) -> Candidates:
    # What reaches in may be a hand: all of its region is, but for what is known to lie apart.
    known = [region.box for region in found.regions if region.is_thing]
    return found._replace(regions=[region._replace(
        is_thing=region.is_thing or touches_edge(region.box, found.frame)
        and any(box.is_inside(region.box) for box in known)) for region in found.regions])


def _search(
    frame: np.ndarray, parts: List[Box], reference: Reference, min_area: float, budget: Budget,
    still: Sequence[Still] = (),
) -> Candidates:
    plain, others = [], []
    parts = [part for part in parts if not any(one.fills(part) for one in still)]
    if is_much(parts, frame):
        reference.limits.mark(frame)
    for part in parts:
        if _is_speck(frame, part, reference.limits, min_area):
            continue
        one = find_plain(frame, part, reference, min_area)
        if one is None:
            others.append(part)
        else:
            plain.append(one)
    if not others and not still:
        return Candidates(frame, plain, [])
    regions, held = _without_still(_regions(frame, others, reference, min_area), still)
    regions, left = _within(budget, regions, frame)
    told: List[Tuple[Region, Sequence[Region]]] = []
    if regions:
        shade = measure_shade(frame, regions + [one.region for one in held], reference)
        free = _free(frame, regions + left + [one.region for one in held], plain)
        told = [(region, _things_of(frame, region, reference, shade, min_area, free))
                for region in regions]
    things = [thing for _, found in told for thing in found]
    things = _joined(things + [thing for one in held for thing in one.things])
    # A window that grew may hold a plain object of another part.
    regions = [thing for thing in things if not any(
        thing.box.is_mostly_inside(one.window) for one in plain)]
    regions.sort(key=lambda region: -region.strong_area)
    return Candidates(frame, plain, regions, left, told, held)


def _without_still(
    regions: List[Region], still: Sequence[Still]
) -> Tuple[List[Region], List[Still]]:
    """Give the regions that do not lie still, and what does: unless it shows something else."""
    rest: List[Region] = []
    held = list(still)
    for region in regions:
        here = [one for one in held if one.is_at(region)]
        if len(here) == 1 and here[0].is_as_large_as(region):
            continue
        rest.append(region)
        held = [one for one in held if not any(one is other for other in here)]
    return rest, held


def _regions(
    frame: np.ndarray, parts: List[Box], reference: Reference, min_area: float
) -> List[Region]:
    regions = find_regions(frame, parts, reference.limits, min_area)
    rest: List[Region] = []
    for region in regions:
        # What moves alone is an object of the background.
        if len(regions) - len(rest) < _LEAST_MOVED:
            return regions
        if not _is_moved_print(frame, region, reference, min_area):
            rest.append(region)
    return rest if len(regions) - len(rest) >= _LEAST_MOVED else regions


def _is_moved_print(
    frame: np.ndarray, region: Region, reference: Reference, min_area: float
) -> bool:
    """Tell whether a region shows the table as it is a few px beside: the camera was pushed."""
    window, limits = grown(region.box, _SHIFTS[-1][0], frame), reference.limits
    part = slices(window)
    if not reference.has_edges(part):
        return False
    strong = limits.strong(frame, part) & filled(region.outline, window, 255)
    near = cv2.dilate(limits.has_print(part, limits.least), _NEAR_PRINT)
    area = cv2.countNonZero(strong)
    most = min(area / 2, max(_MOST_UNLIKE * area, min_area))
    if cv2.countNonZero(cv2.subtract(strong, near)) > area / 2:
        return False
    around, unlike = cv2.dilate(strong, _NEAR_PRINT), 0
    # A lens or a push moves places differently.
    far = grown(window, _SHIFTS[-1][0], frame)
    bounds = limits.strong_range(slices(far))
    for top in range(0, window.height, _PATCH):
        for left in range(0, window.width, _PATCH):
            patch = (slice(top, top + _PATCH), slice(left, left + _PATCH))
            if cv2.countNonZero(strong[patch]):
                unlike += _unlike(frame[part][patch], bounds, around[patch],
                                  (window.y - far.y + top, window.x - far.x + left))
                if unlike > most:
                    return False
    return True


def _unlike(levels: np.ndarray, bounds: Range, around: np.ndarray, place: Tuple[int, int]) -> int:
    """Count what a patch shows that the background does not, at the best shift."""
    least = around.size
    for shift in _SHIFTS:
        # Where the picture ends, it goes on as it ends.
        there = tuple(slice(start, start + length) for start, length in (
            (min(max(start + away, 0), whole - length), length)
            for start, away, whole, length in zip(
                place, shift, bounds.darkest.shape, around.shape)))
        beside = Range(*(bound[there] for bound in bounds))
        least = min(least, cv2.countNonZero(beside.outside(levels) & around))
        if not least:
            break
    return least


def _within(
    budget: Budget, regions: List[Region], frame: np.ndarray
) -> Tuple[List[Region], List[Region]]:
    """Give the regions that a budget reaches, and the others; at least one is reached."""
    order = sorted(regions, key=lambda region: not any(
        box.is_mostly_inside(region.box) for box in budget.first))
    areas = [work(seen_closely(region, frame)).area for region in order]
    reached = np.cumsum(areas) <= budget.area
    kept = {id(region) for region, is_reached in zip(order, reached) if is_reached}
    kept |= {id(region) for region in order[:1]}
    return ([region for region in regions if id(region) in kept],
            [region for region in regions if id(region) not in kept])


def _joined(things: Sequence[Region]) -> List[Region]:
    """Join what hides the same place of the table: it is one thing, seen as two regions."""
    joined: List[Region] = []
    for thing in things:
        same = [one for one in joined if thing.is_hiding and _meet(one, thing)]
        for one in same:
            thing = thing.united(one)
        joined = [one for one in joined if not any(one is other for other in same)] + [thing]
    return joined


def _meet(one: Region, other: Region) -> bool:
    inside = filled(one.outline, other.box) & filled(other.outline, other.box)
    return cv2.countNonZero(inside) > _LEAST_SHARED


def _free(frame: np.ndarray, regions: Sequence[Region], plain: Sequence[Plain]) -> np.ndarray:
    """Give what is in no region, shape (h, w), uint8, 1 there."""
    free = np.ones(frame.shape[:2], np.uint8)
    cv2.drawContours(free, [one.outline for one in regions], -1, 0, cv2.FILLED)
    for one in plain:
        free[slices(one.window)] = 0
    return free


def _things_of(
    frame: np.ndarray, region: Region, reference: Reference, shade: Shade, min_area: float,
    free: np.ndarray,
) -> List[Region]:
    others = shade.beside(region.box)

    def look(at: Region) -> List[Region]:
        return things_in(frame, at, reference, others, min_area, free)

    things = look(region)
    if not touches_edge(region.box, frame):
        return _closer(things, region, frame, look)
    if not things:
        return [one for part in _darker(frame, region, reference)
                for one in _alone(part, region, frame, look) or ()]
    if len(things) == 1 and not things[0].is_thing:
        return things
    at_edge = [thing for thing in things if touches_edge(thing.box, frame)]
    # What reaches in may be a hand, and all of its region is, but for what lies apart in its
    # shade; or it is light, and looked at once more without it.
    is_thing = (sum(thing.strong_area for thing in at_edge)
                > _LEAST_HAND * cv2.contourArea(region.outline))
    result = [region._replace(is_thing=is_thing)] * bool(at_edge)
    # Of what lies in an arm's shade, no more than its pixels is known.
    are_told = all(thing.is_thing for thing in things)
    for thing in things:
        if touches_edge(thing.box, frame) or min(thing.box.width, thing.box.height) <= _NARROW:
            continue
        alone = _alone(thing.outline, region, frame, look)
        if alone is not None:
            result += alone
        elif are_told:
            result.append(thing)
    return result


def _closer(
    things: List[Region], region: Region, frame: np.ndarray,
    look: Callable[[Region], List[Region]],
) -> List[Region]:
    """Look at the things that were seen reduced again, each alone: one may be several."""
    scale, area = work(seen_closely(region, frame))
    left = _AGAIN * area
    result: List[Region] = []
    for thing in things:
        again = work(grown(thing.box, _NEARBY[0], frame))
        several = None
        if thing.is_thing and again.scale < scale and again.area <= left:
            several, left = _alone(thing.outline, region, frame, look), left - again.area
        # Of one thing, compression hides less where it is seen reduced.
        result += several if several and len(several) > 1 else [thing]
    return result


def _alone(
    part: np.ndarray, region: Region, frame: np.ndarray, look: Callable[[Region], List[Region]]
) -> Optional[List[Region]]:
    """
    Give the things in a part of a region, looked at alone: it is seen less reduced.

    Where the region reaches the picture's edge, edges tell nothing in it: they do near the part.

    :param part: Its outline.
    :param look: Gives the things in a region.
    :returns: None where the part cannot be looked at alone: it is near the picture's edge, too.
    """
    around = Box(*cv2.boundingRect(part))
    things: List[Region] = []
    for margin in _NEARBY:
        box = grown(around, margin, frame)
        outline = outline_of(filled(region.outline, box), box)
        if outline is None:
            return None
        near = region._replace(
            outline=outline, box=Box(*cv2.boundingRect(outline)), strong=around)
        if touches_edge(near.box, frame):
            return things or None
        known = filled(part, box)
        things = [one for one in look(near) if one.is_thing and _is_same(
            one, known, box)] or things
        if not any(goes_beyond(one.box, box, frame) for one in things):
            break
    return things


def _darker(frame: np.ndarray, region: Region, reference: Reference) -> List[np.ndarray]:
    """Give the outlines of what is darker than most of a region that is light as a whole."""
    scale = work(region.box).scale
    seen, usual = (log_light(shrunk(picture[slices(region.box)], scale))
                   for picture in (frame, reference.lit))
    ratio = seen - usual
    inside = np.ascontiguousarray(filled(region.outline, region.box)[::scale, ::scale])
    darker = ratio < quantile(ratio[inside > 0]) - _DARKER
    outlines = outlines_in(cv2.morphologyEx(
        inside & darker.view(np.uint8), cv2.MORPH_OPEN, square(3)))
    return [scale * one + np.int32(region.box[:2]) for one in outlines]


def _are_bands_likely(frame: np.ndarray, parts: List[Box]) -> bool:
    # They go from side to side, if not in one part.
    height, width = frame.shape[:2]
    return (any(part.x == 0 for part in parts)
            and any(part.x + part.width == width for part in parts)
            and sum(part.width * part.height for part in parts) > _LEAST_BANDS * height * width)


def _evened(frame: np.ndarray, parts: List[Box], reference: Reference) -> Optional[Even]:
    """Give a frame as it looks without the bands or the lobes of a lamp; None without any."""
    lit, limits = reference.lit, reference.limits
    large = [thinned(part) for part in parts
             if part.width * part.height > _LEAST_LIGHT * lit[..., 0].size]
    is_lit = any(looks_like_light(frame[some], lit[some], limits.weak(frame, some))
                 for some in large)
    if is_lit or _are_bands_likely(frame, parts):
        bands = find_bands(frame, lit)
        if bands is not None:
            return Even(without_bands(frame, lit, bands), [])
    return without_smooth_light(frame, lit) if is_lit else None


def _without_foreign_light(found: Candidates, reference: Reference, min_area: float) -> Candidates:
    frame, lit = found.frame, reference.lit
    if not any(_may_be_light(frame, region, lit) for region in found.regions):
        return found
    field = find_field(frame, lit)
    if field is None:
        return found
    usual = in_usual_light(frame, lit, field)
    regions = _regions(usual, parts_of(usual, reference), reference, min_area)
    # What is known to be a thing is one in any light.
    known = [region for region in found.regions if region.is_thing]
    boxes = [region.box for region in known] + [one.window for one in found.plain]
    unclear = np.zeros(frame.shape[:2], np.uint8)
    for region in found.regions:
        if not region.is_thing:
            cv2.drawContours(unclear, [region.outline], 0, 1, cv2.FILLED)
    others = [region._replace(in_other_light=has_light(field, region.box)) for region in regions
              if _is_in(region, unclear) and (touches_edge(region.box, frame) or (
                  not any(box.is_mostly_inside(region.box) for box in boxes)
                  and region.is_clear))]
    return found._replace(regions=known + others)


def _is_same(thing: Region, part: np.ndarray, box: Box) -> bool:
    """Tell whether a thing lies in a part of a box, or is convex and goes around that."""
    inside = filled(thing.outline, box)
    return _is_mostly_in(inside, part) or (
        _is_mostly_in(part, inside) and fullness(thing.outline) > _CONVEX)


def _is_in(region: Region, mask: np.ndarray) -> bool:
    return _is_mostly_in(filled(region.outline, region.box), mask[slices(region.box)])


def _is_mostly_in(one: np.ndarray, other: np.ndarray) -> bool:
    return 2 * cv2.countNonZero(one & other) > cv2.countNonZero(one)


def _is_speck(frame: np.ndarray, part: Box, limits: LevelLimits, min_area: float) -> bool:
    # Salt makes many small parts: those that show no object are left out at once.
    if part.width * part.height > _MOST_SPECK:
        return False
    place = slices(part)
    return cv2.countNonZero(limits.strong(frame, place)) < min_area / 2


def _may_reach_border(frame: np.ndarray, region: Region) -> bool:
    return not region.is_thing and touches_edge(region.box, frame)


def _may_be_light(frame: np.ndarray, region: Region, lit: np.ndarray) -> bool:
    area = cv2.contourArea(region.outline) / frame[..., 0].size
    return (_LEAST_LIGHT < area < _MOST_LIGHT and _may_reach_border(frame, region)
            and _is_lit(frame, region, lit))


def _is_lit(frame: np.ndarray, region: Region, lit: np.ndarray) -> bool:
    some = thinned(region.box)
    inside = filled(region.outline, region.box)[thinned(region.box._replace(x=0, y=0))]
    return looks_like_light(frame[some], lit[some], inside)


def parts_of(frame: np.ndarray, reference: Reference) -> List[Box]:
    """Find the parts of a frame that have changed."""
    rows = Strips(frame.shape).changed(frame, reference.lit, reference.limits)
    return changed_parts(frame, reference.lit, rows, reference.limits)


def left_over(
    found: Candidates, parts: List[Box], detections: List[Detection], reference: Reference,
    min_area: float,
) -> List[NoObject]:
    """
    Find what differs strongly from the background, and belongs to no detection.

    :param parts: Where the frame has changed.
    :param detections: What was told of the frame; `found.light` has those that are left out.
    :returns: The largest first, at most 100.
    """
    dropped = [_too_much(region.box) for region in found.left]
    dropped += [*found.light, *(one for still in found.held for one in still.no_objects)]
    # Beside a plain object there is nothing else, see `plain`.
    parts = [part for part in parts if not any(
        one.window.is_inside(part) for one in found.plain) and not any(
        one.fills(part) for one in found.held)]
    parts = sorted(parts, key=lambda part: -part.width * part.height)[:_MOST_DROPPED]
    if not parts:
        return dropped
    left = np.zeros(found.frame.shape[:2], np.uint8)
    for part in parts:
        place = slices(part)
        left[place] |= reference.limits.strong(found.frame, place)
    for detection in detections:
        for width in cv2.FILLED, _RIM:
            cv2.drawContours(left, [detection.outline[:, None]], 0, 0, width)
    for region in [*found.left, *(one.region for one in found.held)]:
        cv2.drawContours(left, [region.outline], 0, 0, cv2.FILLED)
    for part in parts:
        dropped += _dropped(found.frame, reference.lit, left, part, min_area)
        left[slices(part)] = 0
    return sorted(dropped, key=lambda one: -one.area)[:_MOST_DROPPED]


def _too_much(box: Box) -> NoObject:
    centre = Pixel(box.x + (box.width - 1) / 2, box.y + (box.height - 1) / 2)
    return NoObject('too_much', centre, float(box.width * box.height))


def _dropped(
    frame: np.ndarray, lit: np.ndarray, left: np.ndarray, part: Box, min_area: float
) -> List[NoObject]:
    found = []
    outlines = sorted(outlines_in(left[slices(part)], part), key=enclosed, reverse=True)
    for outline in outlines[:_MOST_DROPPED]:
        box = Box(*cv2.boundingRect(outline))
        near, kind = slices(box), 'speck'
        mask = filled(outline, box) & left[near]
        area = float(cv2.countNonZero(mask))
        if area >= min_area:
            inside = without_rim(mask, square(5))
            seen, usual = (cv2.mean(picture[near], inside if inside.any() else mask)[:3]
                           for picture in (frame, lit))
            kind = 'light' if sum(seen) > sum(usual) else 'shade'
            chroma, ratio = change_of(seen, usual)
            if cv2.countNonZero(inside) >= min_area and (
                    chroma > COLOURED or not DARKEST < ratio < BRIGHTEST):
                kind = 'light_or_thing'
        u, v = centre_of(mask)
        found.append(NoObject(kind, Pixel(u + box.x, v + box.y), area))
    return found
