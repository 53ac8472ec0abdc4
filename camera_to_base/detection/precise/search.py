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
What may be an object on a frame: plain objects by the short way, and regions for the long way.

Where a region may be light that comes from outside of the picture, all is looked at once more,
with that light taken into account.
"""

from typing import List, Optional, Tuple

from camera_to_base.detection.detection import Box, touches_edge
from camera_to_base.detection.precise.foreign_light import (
    field_of_bands, find_bands, find_field, looks_like_light)
from camera_to_base.detection.precise.limits import Limits, Range
from camera_to_base.detection.precise.plain import find_plain, Plain
from camera_to_base.detection.precise.reference import Reference
from camera_to_base.detection.precise.regions import filled, find_regions, Region, slices
from camera_to_base.detection.precise.strips import Strips
from camera_to_base.detection.precise.tiles import changed_parts
import cv2
import numpy as np

# Light that reaches into the picture covers at least this part of it, and hardly more than half.
_LEAST_LIGHT, _MOST_LIGHT = 0.015, 0.65
# A faint region whose box covers at least this part may go on to the border; faint is a region of
# whose box less than this part differs strongly.
_FAR, _FAINT = 0.04, 0.15
# What is left over where light was taken out is an object where this part of it differs strongly.
_MOSTLY = 0.4
# A part that is larger is no speck, in px².
_MOST_SPECK = 1200
# Light of a field that changes an object's place, in steps of a factor, see `Limits.use_field`.
_LEAST_LIGHT_STEPS = 4


def search(
    frame: np.ndarray, parts: List[Box], reference: Reference, min_area: float
) -> Tuple[List[Plain], List[Region]]:
    """
    Find what may be objects in the parts of a frame that have changed.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param parts: See :func:`tiles.changed_parts`.
    :param min_area: What shows less is noise, in px².
    :returns: The plain objects, and the other regions, the largest first.
    """
    plain, others = [], []
    for part in parts:
        if _is_speck(frame, part, reference.limits, min_area):
            continue
        one = find_plain(frame, part, reference)
        if one is None:
            others.append(part)
        else:
            plain.append(one)
    regions = find_regions(frame, others, reference.limits, min_area)
    # A window that grew may hold a plain object of another part.
    regions = [region for region in regions
               if not any(region.box.is_inside(one.window) for one in plain)]
    if not any(_may_reach_border(frame, region) for region in regions):
        return plain, regions
    field = _field(frame, regions, reference.lit)
    if field is None:
        return plain, regions
    reference.limits.use_field(field)
    try:
        regions = find_regions(
            frame, parts_of(frame, reference), reference.limits, min_area)
    finally:
        reference.limits.use_field(None)
    return [], [region._replace(in_other_light=_has_light(field, region.box))
                for region in regions if touches_edge(region.box, frame)
                or region.strong_area > _MOSTLY * cv2.contourArea(region.outline)]


def _is_speck(frame: np.ndarray, part: Box, limits: Limits, min_area: float) -> bool:
    # Salt makes many small parts: those that show no object are left out at once.
    if part.width * part.height > _MOST_SPECK:
        return False
    place = slices(part)
    return cv2.countNonZero(limits.strong(place).outside(frame[place])) < min_area / 2


def _field(frame: np.ndarray, regions: List[Region], lit: np.ndarray) -> Optional[Range]:
    bands = find_bands(frame, lit)
    if any(_may_be_light(frame, region, lit) for region in regions):
        return find_field(frame, lit, bands)
    return None if bands is None else field_of_bands(bands, frame)


def _has_light(field: Range, box: Box) -> bool:
    part = slices(box)
    return (field.darkest[part].min() < 128 - _LEAST_LIGHT_STEPS
            or field.lightest[part].max() > 128 + _LEAST_LIGHT_STEPS)


def _may_reach_border(frame: np.ndarray, region: Region) -> bool:
    # A faint shadow is seen to the border less than elsewhere, where a lens is darker.
    is_faint = region.strong_area < _FAINT * region.box.width * region.box.height
    return (touches_edge(region.box, frame) or is_faint
            and region.box.width * region.box.height > _FAR * frame[..., 0].size)


def _may_be_light(frame: np.ndarray, region: Region, lit: np.ndarray) -> bool:
    area = cv2.contourArea(region.outline) / frame[..., 0].size
    if not _LEAST_LIGHT < area < _MOST_LIGHT or not _may_reach_border(frame, region):
        return False
    part = slices(region.box)
    return looks_like_light(
        frame[part], lit[part], filled(region.outline, region.box))


def parts_of(frame: np.ndarray, reference: Reference) -> List[Box]:
    """Find the parts of a frame that have changed."""
    lit, limits = reference.lit, reference.limits
    rows = ([slice(0, len(frame))] if limits.has_field
            else Strips(frame.shape).changed(frame, lit, limits))
    return changed_parts(frame, lit, rows, limits)
