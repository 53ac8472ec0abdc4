# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Ghosts: objects that lay there when the background was taken, and have left since.

A region where frame and background differ is an object on the frame, or one on the background.
Look at the patch of equal brightness around one of the region's pixels, in both pictures: an
object's patch ends at the object's edge, the surface's patch goes on around. A pattern that is
printed on the surface has an edge, too, and an object may cover a part of it. So the background's
patch is an object that has left only where all of it has changed, or where what has not changed
is covered by an object of the same size on the frame: the object has moved by less than its width.

Only a region on whose rim the background changes as much as the frame can be a ghost: on a plain
surface nothing but this is asked.
"""

from typing import NamedTuple, Optional, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.light import SATURATED
from camera_to_base.detection.precise.piece import (
    channel_extremes, disc, filled, grown, largest_part, slices, square)
from camera_to_base.detection.precise.regions import Region
import cv2
import numpy as np

# An object's edge is a pixel wide, and one more where a lens is not quite sharp.
_RIM = 3
# How much of a ghost must lie on its own patch, and of a patch on its ghost: the rest is the rim.
_SHARE, _WHOLE = 0.9, 0.8
# A patch's levels differ from its seed's by less than this part of the region's contrast.
_TOLERANCE, _LEAST_TOLERANCE = 0.4, 6.0
# The background's edges at a ghost's rim are at least this strong, beside the frame's.
_LEAST_EDGES = 0.7
# Which part of a region may be saturated, beside the background.
_MOST_SATURATED = 0.1
# An object that has moved is as large as it was.
_SAME_SIZE = 0.7, 1.4


class Ghost(NamedTuple):
    """
    An object of the background that has left.

    :param window: The part of the picture around it.
    :param mask: What of the window it covers, shape (h, w), uint8, 1 there.
    """

    window: Box
    mask: np.ndarray

    def paint_over(self, picture: np.ndarray) -> None:
        """Continue a picture's surroundings into it, in place."""
        part = slices(self.window)
        picture[part] = cv2.inpaint(
            np.ascontiguousarray(picture[part]), self.mask, _RIM, cv2.INPAINT_TELEA)

    def is_back(self, frame: np.ndarray, background: np.ndarray, levels: float) -> bool:
        """
        Tell whether a frame shows again what the background shows.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :param background: Of the same shape, at the frame's light.
        :param levels: Grey levels by which an object differs.
        """
        part = slices(self.window)
        _, difference = channel_extremes(cv2.absdiff(frame[part], background[part]))
        return bool((difference[self.mask > 0] <= levels).mean() > _SHARE)


def find_ghost(frame: np.ndarray, background: np.ndarray, region: Region) -> Optional[Ghost]:
    """
    Tell whether a region shows an object of the background that has left.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Of the same shape, at the frame's light.
    :returns: None where it shows an object of the frame.
    """
    if not _has_edges(frame, background, region) or _is_saturated(frame, background, region):
        return None
    box = region.box
    window = grown(box, 2 * max(box.width, box.height) + 8 * _RIM, frame)
    inside = filled(region.outline, window)
    part = slices(window)
    now, before = _clearest_channel(frame[part], background[part], inside)
    left = _left(now, before, inside)
    return None if left is None else Ghost(window, left)


def _has_edges(frame: np.ndarray, background: np.ndarray, region: Region) -> bool:
    window = grown(region.box, _RIM, frame)
    rim = np.zeros((window.height, window.width), np.uint8)
    cv2.drawContours(rim, [region.outline], 0, 1, _RIM, offset=(-window.x, -window.y))
    part = slices(window)
    # A mean of three channels' edges: an object may have the table's grey.
    in_frame, in_background = (
        sum(cv2.mean(cv2.morphologyEx(picture[part], cv2.MORPH_GRADIENT, square(5)), rim))
        for picture in (frame, background))
    return in_background > _LEAST_EDGES * in_frame


def _is_saturated(frame: np.ndarray, background: np.ndarray, region: Region) -> bool:
    # What saturates looks alike, and goes on wherever the picture does.
    part = slices(region.box)
    now, before = (cv2.inRange(picture[part], 0, (SATURATED,) * 3) == 0
                   for picture in (frame, background))
    inside = filled(region.outline, region.box) > 0
    return bool((now & ~before)[inside].mean() > _MOST_SATURATED)


def _clearest_channel(
    frame: np.ndarray, background: np.ndarray, inside: np.ndarray
) -> Tuple[np.ndarray, np.ndarray]:
    contrast = cv2.mean(cv2.absdiff(frame, background), inside)[:3]
    channel = int(np.argmax(contrast))
    return tuple(cv2.blur(cv2.extractChannel(picture, channel), (3, 3))
                 for picture in (frame, background))


def _left(now: np.ndarray, before: np.ndarray, inside: np.ndarray) -> Optional[np.ndarray]:
    difference = cv2.absdiff(now, before)
    contrast = cv2.mean(difference, inside)[0]
    tolerance = max(_TOLERANCE * contrast, _LEAST_TOLERANCE)
    changed = np.where(difference > contrast / 2, inside, 0).astype(np.uint8)
    seed = _innermost(changed)
    on_frame, on_background = (_patch(picture, seed, tolerance) for picture in (now, before))
    if cv2.countNonZero(on_background) >= cv2.countNonZero(on_frame):
        return None
    # An object's patch has a hole where the object has a highlight.
    patch = largest_part(on_background)
    whole = cv2.dilate(patch, square(2 * _RIM + 1))
    if cv2.countNonZero(inside & whole) < _SHARE * cv2.countNonZero(inside):
        return None
    return whole if _has_left(patch, changed, now, tolerance) else None


def _has_left(
    patch: np.ndarray, changed: np.ndarray, now: np.ndarray, tolerance: float
) -> bool:
    # What of the patch looks as it did: nothing, or an object of its size that covers it.
    area = cv2.countNonZero(patch)
    if cv2.countNonZero(patch & changed) >= _WHOLE * area:
        return True
    rest = cv2.erode(patch & (1 - cv2.dilate(changed, disc(5))), square(3))
    if not rest.any():
        return True
    moved = largest_part(_patch(now, _innermost(rest), tolerance))
    low, high = _SAME_SIZE
    return low * area < cv2.countNonZero(moved) < high * area and _has_moved(moved, patch, changed)


def _has_moved(moved: np.ndarray, patch: np.ndarray, changed: np.ndarray) -> bool:
    beyond = cv2.countNonZero(moved & (1 - cv2.dilate(patch, square(3))))
    return beyond > cv2.countNonZero(changed & patch) / 4


def _innermost(region: np.ndarray) -> Tuple[int, int]:
    depth = cv2.distanceTransform(region, cv2.DIST_L2, 3)
    return cv2.minMaxLoc(depth)[3]


def _patch(picture: np.ndarray, seed: Tuple[int, int], tolerance: float) -> np.ndarray:
    mask = np.zeros((picture.shape[0] + 2, picture.shape[1] + 2), np.uint8)
    flags = 4 | cv2.FLOODFILL_FIXED_RANGE | cv2.FLOODFILL_MASK_ONLY | 1 << 8
    cv2.floodFill(picture.copy(), mask, seed, 0, tolerance, tolerance, flags)
    return np.ascontiguousarray(mask[1:-1, 1:-1])
