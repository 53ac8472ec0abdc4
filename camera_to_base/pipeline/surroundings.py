# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What lies around an object, and on a large one: the light is too strong; things on a sheet."""

from typing import Iterator, List, Optional, Sequence

from camera_to_base.detection import (
    Box, Detection, LeftOut, locate_pixel, LocatedObject, Pixel, Point, REASONS)
from camera_to_base.errors import HorizonError, Level, Reason
from camera_to_base.pipeline.stage import FrameRecord, Stage
from camera_to_base.pipeline.standpoint import PerBackground, Standpoint
import cv2
import numpy as np

# From this level on a picture saturates; where of this share of an object's surroundings it does,
# and did not before, the object's rim is not seen. They lie between these distances from it, in
# px. Of the whole picture some rows tell whether that need be asked.
_SATURATED, _MOST_SATURATED, _NEAR, _FAR = 250, 0.1, 2, 7
_ROW_STEP, _LEAST_OVEREXPOSED = 8, 0.002
# Where the background is white on so much of it, that is told.
_OVEREXPOSED_SURFACE = 0.1

# What covers so much of the picture may be a sheet. Most of it has one colour, with this
# tolerance, in levels.
_SHEET, _LEAST_EVEN, _EVEN = 0.04, 0.5, 20.0
# A thing on it differs by so many levels, is at least so large, in px², and no more than this
# share of the sheet. It lies so far from the sheet's edge, in px. No more are listed.
_DIFFERS, _LEAST_AREA, _MOST_OF_SHEET, _MARGIN_PX, _MOST_THINGS = 30.0, 144, 0.25, 5, 20

_OVEREXPOSED = Reason(
    'overexposed', Level.WARN, 'the picture around it is overexposed: take away light, or lower '
    "the camera's exposure", is_passing=True)
_ON_SHEET = Reason(
    'on_sheet', Level.WARN, 'it lies on something large that was laid on the surface after the '
    'background was taken: take that away, or clear it and call ~/capture_background',
    is_passing=True)


class SurroundingsStage(Stage):
    """Leaves out objects in overexposed surroundings, and lists what lies on a sheet."""

    def __init__(self) -> None:
        self._surfaces: PerBackground[Optional[Reason]] = PerBackground(
            lambda background: _of_surface(background.picture))

    def doubt(self, standpoint: Standpoint) -> Optional[Reason]:
        """Tell whether much of the surface is overexposed."""
        return standpoint.background and self._surfaces.of(standpoint.background)

    def judge(self, record: FrameRecord) -> FrameRecord:
        """Leave out what cannot be told from its surroundings."""
        self._surfaces.keep(record.standpoint)
        if record.aligned is None or not (record.objects or record.left_out):
            return record
        frame, background = record.aligned, record.standpoint.background.picture
        record = record.without(_overexposed(frame, background, record))
        found = [LeftOut(thing, _ON_SHEET, _point_of(record, thing))
                 for sheet in _sheets(record, frame) for thing in things_on(frame, sheet)]
        return record._replace(left_out=(*record.left_out, *found))


def things_on(frame: np.ndarray, sheet: Detection) -> List[Detection]:
    """
    Find what lies on a large thing of one colour.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param sheet: What may be one, such as a sheet of paper.
    :returns: The largest first; none where it has many colours.
    """
    box = sheet.box
    left, top = max(box.x, 0), max(box.y, 0)
    picture = cv2.medianBlur(np.ascontiguousarray(
        frame[top:box.y + box.height, left:box.x + box.width]), 3)
    whole = cv2.drawContours(np.zeros(picture.shape[:2], np.uint8), [_corners(sheet)], 0, 1,
                             cv2.FILLED, offset=(-left, -top))
    inside = cv2.erode(whole, np.ones((2 * _MARGIN_PX + 1,) * 2, np.uint8), borderValue=0)
    colours = picture[inside > 0]
    if not len(colours):
        return []
    away = np.abs(picture - np.median(colours, axis=0).astype(np.float32)).max(axis=2)
    if (away[inside > 0] < _EVEN).mean() < _LEAST_EVEN:
        return []
    differs = cv2.morphologyEx((away > _DIFFERS).astype(np.uint8) & inside, cv2.MORPH_OPEN,
                               np.ones((3, 3), np.uint8))
    outlines, _ = cv2.findContours(
        differs, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE, offset=(left, top))
    things = [_detection(outline) for outline in outlines
              if _LEAST_AREA <= cv2.contourArea(outline) <= _MOST_OF_SHEET * sheet.area]
    return sorted(things, key=lambda thing: -thing.area)[:_MOST_THINGS]


def _sheets(record: FrameRecord, frame: np.ndarray) -> Iterator[Detection]:
    least = _SHEET * frame.shape[0] * frame.shape[1]
    # Only what is a thing: the other words name places of the surface.
    left_out = (one for one in record.left_out if one.reason.kind not in REASONS)
    for one in (*record.objects, *left_out):
        if one.detection.area >= least:
            yield one.detection


def _of_surface(background: np.ndarray) -> Optional[Reason]:
    share = _saturated(background[::_ROW_STEP]).mean()
    return None if share < _OVEREXPOSED_SURFACE else Reason(
        'background_overexposed', Level.WARN,
        f'the surface is overexposed on {share:.0%} of the background: white objects are not seen '
        "there, and shade may be taken for objects: lower the camera's exposure, clear the "
        'surface, and call ~/capture_background')


def _overexposed(
    frame: np.ndarray, background: np.ndarray, record: FrameRecord
) -> List[Optional[Reason]]:
    new = _saturated(frame[::_ROW_STEP])
    least = _LEAST_OVEREXPOSED * new.size
    # Seldom does a picture saturate at all.
    if np.count_nonzero(new) >= least:
        new &= ~_saturated(background[::_ROW_STEP])
    if np.count_nonzero(new) < least:
        return [None] * len(record.objects)
    outlines = [_corners(one.detection) for one in (*record.objects, *record.left_out)]
    return [_OVEREXPOSED if _is_overexposed(frame, background, one, outlines) else None
            for one in record.objects]


def _is_overexposed(
    frame: np.ndarray, background: np.ndarray, one: LocatedObject, outlines: Sequence[np.ndarray]
) -> bool:
    box = one.detection.box
    left, top = max(box.x - _FAR, 0), max(box.y - _FAR, 0)
    part = np.s_[top:box.y + box.height + _FAR, left:box.x + box.width + _FAR]
    new = _saturated(frame[part]) & ~_saturated(background[part])
    own, all_of_them = (np.zeros(new.shape, np.uint8) for _ in range(2))
    cv2.drawContours(own, [_corners(one.detection)], 0, 1, cv2.FILLED, offset=(-left, -top))
    cv2.drawContours(all_of_them, outlines, -1, 1, cv2.FILLED, offset=(-left, -top))
    near, far = (cv2.dilate(mask, np.ones((2 * reach + 1,) * 2, np.uint8))
                 for mask, reach in ((own | all_of_them, _NEAR), (own, _FAR)))
    around = (far > near)
    return bool(around.any() and new[around].mean() > _MOST_SATURATED)


def _saturated(picture: np.ndarray) -> np.ndarray:
    # Much faster than the maximum along the short axis.
    return cv2.inRange(picture, (0,) * 3, (_SATURATED - 1,) * 3) == 0


def _corners(one: Detection) -> np.ndarray:
    return np.int32(one.outline).reshape(-1, 1, 2)


def _detection(outline: np.ndarray) -> Detection:
    moments = cv2.moments(outline)
    area = moments['m00']
    return Detection(Box(*cv2.boundingRect(outline)),
                     Pixel(moments['m10'] / area, moments['m01'] / area), area,
                     outline.reshape(-1, 2), False)


def _point_of(record: FrameRecord, one: Detection) -> Optional[Point]:
    try:
        return locate_pixel(record.standpoint.surface.surface, one.centre)
    except HorizonError:
        return None
