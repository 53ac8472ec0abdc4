# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Tells things from shade, sun and lamps, before anything is connected; see `evidence`.

Where neither is clear (glass, a grey face on a grey table, a lamp's mirror image), nothing is said
and the long way decides, see `own_shadow`. Where the frame's detail follows the table's, and where
the light changes without an edge, it is light. An arm, its shade and what lies in the shade are
one region: where that is not clear, what is surrounded by shade may be a thing, see `search`.
"""

import math
from typing import List, NamedTuple, Optional, Sequence, Tuple, Union

from camera_to_base.detection.detection import Box, touches_edge
from camera_to_base.detection.precise.evidence import (
    detail_of, Evidence, evidence, gradient, WORST_LIGHT)
from camera_to_base.detection.precise.faces import hidden_beside, hiding_nats
from camera_to_base.detection.precise.gloss import (
    find_highlight, is_on, may_be_highlight, with_highlights)
from camera_to_base.detection.precise.light import LEVEL_SCALE, LINEAR, log_levels
from camera_to_base.detection.precise.noise import SCALES
from camera_to_base.detection.precise.piece import (
    chosen, cut_off, enclosed, enlarged, filled, grown, make_piece, outline_of, outlines_in,
    quantile, shrunk, slices, solidity, square)
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import CONVEX, goes_beyond, Region
from camera_to_base.detection.precise.segments import (
    COLOURED, doubt_of, Parted, parted, Unsure, untold)
from camera_to_base.detection.precise.shade import FAINTEST, is_neutral, Shade
from camera_to_base.detection.touching import cut_apart, table_between
import cv2
import numpy as np

# The edge of the windows that the evidence is from, in px.
_SIZE = 5
# The evidence of one pixel is limited before it is smoothed, nats; what is clear.
_MOST_EVIDENCE, _CLEAR = 15.0, 20.0
# What is light beside the things, as a part of the region: where it matters; which part of it is
# clear by its texture; on which part it may be none; how much of the region a thing is that shade
# surrounds; and how much of it is lighter than the table where there is no shade.
_LEAST_REST, _MOSTLY, _MOST_BAD, _SURE, _LEAST_SHARE, _ALL = 0.1, 0.6, 0.3, 0.75, 0.35, 0.9
# Where this part of a region is surely a thing, one highlight does not tell of all of it; nor
# where this part of what is around it has a colour.
_HARDLY, _LEAST_COLOUR = 0.4, 0.15
# A thing is wide enough for a window on this part of it; the others are few.
_LEAST_CORE, _MOST_THIN = 0.15, 0.15
# A print's edge changes the logarithm of the level by more, per px; JPEG is seen so far, px.
_PRINT, _JPEG = 0.1, 9
# Light without an edge changes less per px; logarithm of the level.
_STEEPEST = 0.06
# What fades into the table has such an edge on less of its rim.
_MOST_STEEP = 0.3
# What is between a thing and its shade: in the frame, logarithm.
_LEAST_STEP = 0.15
# How far the surroundings of a part matter for that, px.
_BESIDE = 12
# What is looked at around a region, px: more where what is hidden reaches the border of that.
_MARGINS = 8, 32, 96
# The deviation of a centre by that part of its thing that only the table's texture tells, px.
_OF_HIDDEN = 2.0
# What surrounds a thing in an arm's shade, px, and on which part of it there must be shade.
_RING, _LEAST_AROUND = 4, 0.75
# How far around what is strong, px.
_FAINT = 16
# A larger window is looked at reduced, in px; not so much that things in it vanish.
_MOST_AT_FULL_SIZE = 30_000


class _Unclear(NamedTuple):
    """
    What is said of a region of which things are not told from light.

    :param may_be_light: Whether all of it may be light.
    :param doubt: That of its centre, if it is a thing, in its px.
    """

    may_be_light: bool = False
    doubt: float = 0.0


class _Looked(NamedTuple):
    """
    What a window around a region shows, each picture of shape (h, w) by the window's scale.

    :param window: In the frame.
    :param scale: How many px of the frame make one, along each axis.
    :param seen: The frame, BGR.
    :param usual: The background at its light.
    :param changed: The region, with what is hidden beside it, uint8, 1 there.
    :param hidden: That alone.
    :param found: The evidence.
    """

    window: Box
    scale: int
    seen: np.ndarray
    usual: np.ndarray
    changed: np.ndarray
    hidden: np.ndarray
    found: Evidence

    @property
    def hidden_box(self) -> Box:
        """Where in the frame what is hidden lies, if there is any."""
        x, y, width, height = (self.scale * one for one in cv2.boundingRect(self.hidden))
        return Box(self.window.x + x, self.window.y + y, width, height)


class Work(NamedTuple):
    """
    What it takes to look at a region.

    :param scale: How many px of the frame make one, along each axis.
    :param area: How many of these there are.
    """

    scale: int
    area: int


def things_in(
    frame: np.ndarray, region: Region, reference: Reference, shade: Shade, min_area: float,
    free: np.ndarray,
) -> List[Region]:
    """
    Find the things in a region, without their shade.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param region: What differs from the background, and is connected.
    :param reference: The background at the frame's light.
    :param shade: What shade does on the frame.
    :param min_area: Of a thing, in px².
    :param free: What is in no region, shape (h, w), uint8, 1 there.
    :returns: One region for each thing, none where all is light; the region itself, which is no
        thing then, where it is not clear, and what may be things in its shade, if it is an arm.
    """
    looked = _look_at(frame, region, reference, shade, free, _MARGINS[0])
    for margin in _MARGINS[1:]:
        if not (looked.hidden.any() and goes_beyond(looked.hidden_box, looked.window, frame)):
            break
        looked = _look_at(frame, region, reference, shade, free, margin)
    window, scale, seen, usual, changed, hidden, found = looked
    # Light from outside of the picture may end as sharply as a thing.
    is_at_edge = touches_edge(region.box, frame)
    masks = _masks(seen, usual, changed, found, min_area / scale ** 2, not is_at_edge)
    if isinstance(masks, _Unclear):
        # Where the table has a texture or a print, that tells better than edges.
        may_be_light = not region.is_clear or (
            masks.may_be_light and not reference.has_edges(slices(window)))
        doubt = masks.doubt
        in_shade = _in_a_shade(found, changed, min_area / scale ** 2) if is_at_edge else []
        if hidden.any():
            # It may be a thing as a whole.
            doubt = _with_hidden(doubt, hidden, changed)
            region = region.united(*_regions_of([(changed, 0.0)], scale, window))
        return [region._replace(
            may_be_light=may_be_light, doubt=scale * doubt, is_hiding=bool(hidden.any()))
            ] + _regions_of([(mask, 0.0) for mask in in_shade], scale, window)
    doubtful = [(mask, _with_hidden(doubt, hidden, mask)) for mask, doubt in masks]
    return [thing._replace(is_hiding=bool((hidden & mask).any()))
            for thing, (mask, _) in zip(_regions_of(doubtful, scale, window), masks)]


def _with_hidden(doubt: float, hidden: np.ndarray, thing: np.ndarray) -> float:
    """Give the doubt of a thing's centre, px, with that of what only the texture tells of it."""
    share = cv2.countNonZero(hidden & thing) / cv2.countNonZero(thing)
    return math.hypot(doubt, _OF_HIDDEN * share)


def _look_at(
    frame: np.ndarray, region: Region, reference: Reference, shade: Shade, free: np.ndarray,
    margin: int,
) -> _Looked:
    closely = seen_closely(region, frame)
    window, scale = grown(closely, margin, frame), work(closely).scale
    seen, usual = (shrunk(picture[slices(window)], scale)
                   for picture in (frame, reference.lit))
    changed, beside = (np.ascontiguousarray(mask[::scale, ::scale]) for mask in (
        filled(region.outline, window), free[slices(window)]))
    found = evidence(seen, usual, reference.noise[scale], shade.beside(region.box))
    hidden = hidden_beside(changed, beside, found)
    return _Looked(window, scale, seen, usual, changed | hidden, hidden, found)


def _regions_of(
    masks: Sequence[Tuple[np.ndarray, float]], scale: int, window: Box
) -> List[Region]:
    """Make regions of things, with the doubt of each, that were seen in a reduced window."""
    like = np.empty((window.height, window.width), np.uint8)
    outlines = [outline_of(enlarged(mask, scale, like), window) for mask, _ in masks]
    boxes = [Box(*cv2.boundingRect(outline)) for outline in outlines]
    return [Region(outline, box, int(cv2.contourArea(outline)), box, is_thing=True,
                   neighbours=(*outlines[:index], *outlines[index + 1:]), doubt=scale * doubt)
            for index, (outline, box, (_, doubt)) in enumerate(zip(outlines, boxes, masks))]


def _in_a_shade(found: Evidence, changed: np.ndarray, min_area: float) -> List[np.ndarray]:
    """Give what may be a thing, and is surrounded by shade or the table: it lies in an arm's."""
    clear = cv2.morphologyEx(changed & (
        found.is_dark | (found.nats > _CLEAR).view(np.uint8)), cv2.MORPH_OPEN, square(3))
    table = found.is_light
    things: List[np.ndarray] = []
    for outline in outlines_in(clear):
        box = grown(Box(*cv2.boundingRect(outline)), _RING, clear)
        near, inside = slices(box), filled(outline, box)
        ring = cv2.dilate(inside, square(2 * _RING + 1)) & (1 - cv2.dilate(inside, square(5)))
        if enclosed(outline) >= min_area and cv2.countNonZero(
                ring & table[near]) > _LEAST_AROUND * cv2.countNonZero(ring):
            things.append(np.zeros_like(clear))
            things[-1][near] = inside
    return things


def seen_closely(region: Region, frame: np.ndarray) -> Box:
    """Give the part of a region that is looked at: what is faint is its farther shade."""
    near, box = grown(region.strong, _FAINT, frame), region.box
    left, top = max(near.x, box.x), max(near.y, box.y)
    right = min(near.x + near.width, box.x + box.width)
    return Box(left, top, right - left, min(near.y + near.height, box.y + box.height) - top)


def work(box: Box) -> Work:
    """Give the work that a region of a frame makes: large ones are looked at reduced."""
    area, scale = box.width * box.height, 1
    while area > _MOST_AT_FULL_SIZE * scale ** 2 and scale < SCALES[-1]:
        scale *= 2
    return Work(scale, area // scale ** 2)


def _masks(
    frame: np.ndarray, background: np.ndarray, changed: np.ndarray, found: Evidence,
    min_area: float, do_edges_tell: bool,
) -> Union[List[Tuple[np.ndarray, float]], _Unclear]:
    """Give each thing's mask and its doubt."""
    things = _smooth(found) & cv2.dilate(changed, square(3))
    # Between two colours of a thing, pixels show neither; on a strip of 2 px they show the table.
    things |= cv2.morphologyEx(things, cv2.MORPH_CLOSE, square(_SIZE)) & (
        1 - table_between(frame, background))
    wide, is_cluttered = _wide(things, found, min_area)
    sure = _no_light(wide, found)
    is_cut_off = cut_off(frame)
    has_highlight = bool(is_cut_off.any()) and _has_highlight(
        frame, background, changed, sure, found)
    if not (is_cluttered or has_highlight or wide.any()) and _is_clear(
            wide, changed, found, has_highlight):
        return []
    by_edges = untold(changed) if has_highlight or not do_edges_tell else _by_segments(
        frame, background, changed, things, found, min_area)
    if (do_edges_tell and not has_highlight and by_edges.is_blind
            and (changed & found.is_deep).any()):
        # A black thing's rim has edges, an umbra may have none.
        return _masks(frame, background, changed, found._replace(is_dark=found.is_black),
                      min_area, False)
    if by_edges.is_light:
        return []
    if not (by_edges.is_untold or by_edges.things.any()):
        # Its edges are soft in part, and nothing is sharp all around to compare them with; or it
        # has a coloured table's own colour.
        return _Unclear(may_be_light=True)
    if sure.any() and cv2.countNonZero(
            changed & found.is_lighter) > _ALL * cv2.countNonZero(changed):
        # Hardly anything is darker than the table: all that edges tell of is the thing's.
        things = sure | by_edges.things
    elif by_edges.is_untold:
        # Beside what is surely none, what light explains is light.
        things = sure if sure.any() else wide
    else:
        # What is surely a thing may have no segment of its own.
        things = by_edges.things | _without_segment(sure, by_edges, min_area)
    if by_edges.is_untold:
        if is_cluttered or not things.any() or _goes_on(
                things, changed, frame, min_area) or not _is_clear(
                things, changed, found, has_highlight):
            # The table's texture all over it tells of light, but for what is surely none.
            things = sure
            rest = changed & (1 - cv2.dilate(things, square(_JPEG)))
            is_light = _is_shade_beside(sure, changed, found) or (
                not has_highlight and detail_of(found, rest).is_table)
            if not is_light:
                # It may be no more than what is sure, or than what is no shade.
                unsure = ([Unsure(changed & (1 - sure), 0.5)] if sure.any() else by_edges.unsure
                          or [Unsure(_may_be_shade(changed, found), 0.5)])
                return _Unclear(doubt=doubt_of(changed, unsure))
            if not things.any():
                return []
    parts = cut_apart(things, found.is_light, frame, background, min_area)
    # Where a thing was seen, parts that are too small do not make it light.
    return _complete(parts, is_cut_off, changed, found, by_edges) or _Unclear()


def _has_highlight(
    frame: np.ndarray, background: np.ndarray, changed: np.ndarray, sure: np.ndarray,
    found: Evidence,
) -> bool:
    """Tell whether a region has a highlight on glass, or is a lamp's mirror image."""
    # Of either, hardly anything is surely a thing.
    if cv2.countNonZero(sure) >= _HARDLY * cv2.countNonZero(changed):
        return False
    highlight = find_highlight(make_piece(frame, cv2.LUT(background, LINEAR), changed))
    if highlight is None:
        return False
    # Around either there is no colour.
    around = highlight & changed & (1 - found.is_lighter)
    coloured = around & (found.off_tints > COLOURED).view(np.uint8)
    if cv2.countNonZero(coloured) > _LEAST_COLOUR * cv2.countNonZero(around):
        return False
    return not is_on(sure, highlight, changed)


def _is_shade_beside(things: np.ndarray, changed: np.ndarray, found: Evidence) -> bool:
    """Tell whether things have a colour, and what is beside them is no more than darker."""
    rest = changed & (1 - cv2.dilate(things, square(_SIZE)))
    if not (things.any() and rest.any()):
        return False
    off = found.off_tints
    ratio = LEVEL_SCALE * float(quantile(found.level[rest > 0]))
    return bool(quantile(off[things > 0], 0.2) > COLOURED and ratio < FAINTEST
                and is_neutral(quantile(off[rest > 0]), ratio))


def _without_segment(sure: np.ndarray, by_edges: Parted, min_area: float) -> np.ndarray:
    """Give what is surely a thing, and of which edges tell nothing."""
    kept = np.zeros_like(sure)
    for outline in outlines_in(cv2.morphologyEx(
            sure & (1 - by_edges.things), cv2.MORPH_OPEN, square(_SIZE))):
        box = Box(*cv2.boundingRect(outline))
        inside = filled(outline, box)
        if enclosed(outline) >= min_area and not (inside & by_edges.light[slices(box)]).any():
            kept[slices(box)] |= inside
    return kept


def _complete(
    parts: List[np.ndarray], is_cut_off: np.ndarray, changed: np.ndarray, found: Evidence,
    by_edges: Parted,
) -> List[Tuple[np.ndarray, float]]:
    """Give things with their highlights, and their doubt."""
    things = with_highlights(parts, found.level, found.is_lighter, changed)
    # The outline of a ragged thing tells that a part of it may be missing.
    is_ragged = [solidity(thing) <= CONVEX for thing in things]
    either: List[Unsure] = []
    if any(is_ragged):
        every = np.bitwise_or.reduce(things)
        either.append(Unsure(_may_be_either(every, changed, found, by_edges), 0.5))
    result = []
    for thing, may_be_more in zip(things, is_ragged):
        if may_be_highlight(thing, changed, is_cut_off):
            # What is around it may be its thing, or that thing's shade.
            doubt = doubt_of(thing, [Unsure(changed & (1 - thing), 0.5)])
        else:
            # Both are often the same pixels.
            missing = either if may_be_more else []
            doubt = max(doubt_of(thing, by_edges.unsure), doubt_of(thing, missing))
        result.append((thing, doubt))
    return result


def _by_segments(
    frame: np.ndarray, background: np.ndarray, changed: np.ndarray, by_pixels: np.ndarray,
    found: Evidence, min_area: float,
) -> Parted:
    logs = tuple(cv2.LUT(picture, log_levels()) for picture in (frame, background))
    result = parted(frame, changed, logs, found, min_area)
    if result.is_untold:
        return result
    # What is narrow has no segment of its own; what touches things is a part of them.
    narrow = cv2.erode(by_pixels, square(3)) & result.light & (
        found.is_black | (found.nats > _CLEAR).view(np.uint8))
    near = cv2.dilate(result.things, square(_SIZE))
    labels = cv2.connectedComponents(narrow)[1]
    joined = narrow & np.isin(labels, labels[near > 0]).view(np.uint8)
    things = result.things | cv2.dilate(joined, square(3)) & result.light
    if cv2.countNonZero(narrow & (1 - joined)) > min_area / 2:
        return result._replace(is_light=False, is_untold=True)
    # Segments touch at their common border.
    return result._replace(things=cv2.morphologyEx(things, cv2.MORPH_CLOSE, square(3)))


def _may_be_either(
    things: np.ndarray, changed: np.ndarray, found: Evidence, by_edges: Parted
) -> np.ndarray:
    """Give what may be a darker face of things as well as shade: nothing tells which."""
    rest = changed & (1 - things)
    rest &= ((found.nats > -_CLEAR) | (hiding_nats(rest, found) > 0)).view(np.uint8)
    if by_edges.is_blind:
        rest |= changed & found.is_deep
    return cv2.morphologyEx(rest, cv2.MORPH_OPEN, square(3))


def _may_be_shade(changed: np.ndarray, found: Evidence) -> np.ndarray:
    """Give what is darker than the table, and explained by light."""
    darker = found.level * LEVEL_SCALE < FAINTEST
    return changed & found.is_light & darker.view(np.uint8)


def _smooth(found: Evidence) -> np.ndarray:
    nats = np.where(found.is_dark, _MOST_EVIDENCE, found.nats)
    nats = cv2.blur(np.clip(nats, -_MOST_EVIDENCE, _MOST_EVIDENCE), (3, 3))
    return cv2.morphologyEx((nats > 0).view(np.uint8), cv2.MORPH_OPEN, square(3))


def _wide(things: np.ndarray, found: Evidence, min_area: float) -> Tuple[np.ndarray, bool]:
    """Give the parts that are wide enough for a window, and whether much else is left out."""
    kept = np.zeros_like(things)
    core = cv2.erode(things, square(_SIZE))
    print_ = cv2.dilate((gradient(found.usual) > _PRINT ** 2).view(np.uint8), square(_JPEG))
    wide = thin = 0.0
    part = np.zeros_like(things)
    for outline in outlines_in(things):
        area, box = enclosed(outline), Box(*cv2.boundingRect(outline))
        near, inside = slices(box), filled(outline, box)
        part[near] = inside & things[near]
        is_table = detail_of(found, part).is_table
        part[near] = 0
        if is_table:
            continue
        if area >= min_area and cv2.countNonZero(core[near] & inside) >= _LEAST_CORE * area:
            wide += area
            kept[near] |= inside
        elif cv2.countNonZero(inside & print_[near]) < _MOSTLY * cv2.countNonZero(inside):
            # Beside the edges of a print, JPEG leaves neither.
            thin += area
    return kept, thin > max(min_area, _MOST_THIN * wide)


def _no_light(things: np.ndarray, found: Evidence) -> np.ndarray:
    """Keep the parts that light explains badly."""
    bad, kept = (found.light > WORST_LIGHT).view(np.uint8) | found.is_dark, np.zeros_like(things)
    for outline in outlines_in(things):
        box = Box(*cv2.boundingRect(outline))
        inside = filled(outline, box)
        if cv2.countNonZero(inside & bad[slices(box)]) > _MOST_BAD * cv2.countNonZero(inside):
            kept[slices(box)] |= inside
    return kept


def _goes_on(
    things: np.ndarray, changed: np.ndarray, frame: np.ndarray, min_area: float
) -> bool:
    """Tell whether things go on, with no step, where light alone would have changed."""
    logs = cv2.LUT(frame, log_levels())
    rest = changed & (1 - cv2.dilate(things, square(3)))
    steps = []
    for outline in outlines_in(rest):
        if enclosed(outline) >= min_area:
            box = grown(Box(*cv2.boundingRect(outline)), _BESIDE, things)
            near = slices(box)
            steps.append(_step(logs[near], things[near], filled(outline, box) & rest[near]))
    return any(step is not None and step < _LEAST_STEP for step in steps)


def _step(logs: np.ndarray, one: np.ndarray, other: np.ndarray) -> Optional[float]:
    """Give the step between two parts of a frame, logarithm; None where they do not touch."""
    # Not at the border itself, where pixels are mixed.
    sides = [cv2.erode(side, square(3)) & cv2.dilate(beyond, square(9))
             for side, beyond in ((one, other), (other, one))]
    if not all(map(cv2.countNonZero, sides)):
        return None
    levels = [quantile(chosen(logs, side)) for side in sides]
    return float(np.abs(levels[0] - levels[1]).max())


def _is_clear(
    things: np.ndarray, changed: np.ndarray, found: Evidence, has_highlight: bool
) -> bool:
    beside = 1 - cv2.dilate(things, square(7))
    rest = changed & beside
    count, total = cv2.countNonZero(rest), cv2.countNonZero(changed)
    if count < _LEAST_REST * total:
        return count < total
    sure = cv2.countNonZero(rest & (found.nats < -_CLEAR).view(np.uint8))
    # What light explains badly is neither, unless a thing explains it far worse.
    bad = cv2.countNonZero(rest & (found.light > WORST_LIGHT).view(np.uint8))
    if bad > _MOST_BAD * count and sure < _SURE * count:
        return False
    detail, sure = detail_of(found, rest), sure > _MOSTLY * count
    if (detail.is_table or sure and detail.may_be_table
            or things.any() and _ends_softly(found, changed, things)):
        return True
    # A highlight or a lamp's mirror image is small and surrounded; a thing is not.
    return things.any() and not has_highlight and (
        cv2.countNonZero(things) > _LEAST_SHARE * total
        or not _is_dark_alone(things, found, sure))


def _is_dark_alone(things: np.ndarray, found: Evidence, is_rest_sure: bool) -> bool:
    """Tell whether darkness alone tells things from light: the rest may be their lighter face."""
    dark = things & cv2.dilate(found.is_dark, square(_SIZE))
    if is_rest_sure:
        # A face has the colour of its thing.
        dark &= (found.nats < _CLEAR).view(np.uint8)
    return cv2.countNonZero(dark) > _MOSTLY * cv2.countNonZero(things)


def _ends_softly(found: Evidence, changed: np.ndarray, things: np.ndarray) -> bool:
    """Tell whether what is beside things fades into the table, as shade that surrounds them."""
    rim = cv2.dilate(changed, square(3)) & (1 - changed) & (1 - cv2.dilate(things, square(15)))
    steep = (gradient(cv2.blur(found.level, (_SIZE, _SIZE))) > _STEEPEST ** 2)
    steep = cv2.dilate(steep.view(np.uint8), square(_SIZE))
    return cv2.countNonZero(rim & steep) < _MOST_STEEP * cv2.countNonZero(rim)
