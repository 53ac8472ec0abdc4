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
Ghosts: objects that lay there when the background was taken, and have moved since.

A region where frame and background differ is an object on the frame, or an object on the
background. It is where the region belongs to something small: look at the patch of equal
brightness that surrounds one of the region's pixels, in both pictures. An object's patch ends at
the object's edge, the surface's patch goes on around. This holds for an object that has moved by
a part of its own width only, where the region is no more than a crescent. And the patch on the
background is the whole of what must be painted over there.

Only a region that lies on an edge of the background can be a ghost. On a plain surface nothing
but this is asked, so the test costs nothing until there is a ghost.
"""

from typing import List, Optional, Tuple

from camera_to_base.detection.detection import find_outlines
import cv2
import numpy as np

# An object's edge is a pixel wide, and one more where a lens is not quite sharp.
_RIM = 3
# How much of a ghost must lie on its own patch: the rest is the ragged rim.
_SHARE = 0.9


def find_edges(background: np.ndarray, threshold: float) -> np.ndarray:
    """
    Find where a background changes by more than a threshold within a few px.

    :param background: Shape (h, w), uint8.
    :param threshold: Grey levels.
    :returns: Shape (h, w), bool.
    """
    smooth = cv2.blur(background, (3, 3))
    size = 2 * _RIM + 1
    return cv2.morphologyEx(smooth, cv2.MORPH_GRADIENT, np.ones((size, size))) > threshold


def find_object_in_background(
    frame: np.ndarray, background: np.ndarray, outline: np.ndarray, threshold: float
) -> Optional[np.ndarray]:
    """
    Tell whether a region where two pictures differ shows an object of the background.

    :param frame: Shape (h, w), uint8.
    :param background: Shape (h, w), uint8, at the frame's light.
    :param outline: The region's, shape (n, 1, 2), in px.
    :param threshold: Grey levels by which an object differs from the surface.
    :returns: Shape (h, w), uint8, 255 where the object is on the background; None where the
        object is on the frame.
    """
    region = _filled([outline], frame.shape)
    changed = np.where(cv2.absdiff(frame, background) > threshold, region, 0)
    seed = _innermost(changed)
    on_frame = _patch(frame, seed, threshold / 2)
    on_background = _patch(background, seed, threshold / 2)
    if cv2.countNonZero(on_background) >= cv2.countNonZero(on_frame):
        return None
    # An object's patch has a hole where the object has a highlight.
    outlines = find_outlines(on_background, 0, 0)
    whole = cv2.dilate(_filled(outlines, frame.shape), np.ones((2 * _RIM + 1, 2 * _RIM + 1)))
    covered = cv2.countNonZero(cv2.bitwise_and(region, whole))
    return whole if covered >= _SHARE * cv2.countNonZero(region) else None


def paint_over(picture: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """
    Continue the surroundings of a mask into it.

    :param picture: Shape (h, w, 3), uint8.
    :param mask: Shape (h, w), uint8, 0 where the picture is right.
    :returns: Shape (h, w, 3), uint8.
    """
    return cv2.inpaint(picture, mask, _RIM, cv2.INPAINT_TELEA)


def _filled(outlines: List[np.ndarray], shape: Tuple[int, int]) -> np.ndarray:
    mask = np.zeros(shape, np.uint8)
    return cv2.drawContours(mask, outlines, -1, 255, cv2.FILLED)


def _innermost(region: np.ndarray) -> Tuple[int, int]:
    depth = cv2.distanceTransform(region, cv2.DIST_L2, 3)
    return cv2.minMaxLoc(depth)[3]


def _patch(picture: np.ndarray, seed: Tuple[int, int], tolerance: float) -> np.ndarray:
    mask = np.zeros((picture.shape[0] + 2, picture.shape[1] + 2), np.uint8)
    flags = 4 | cv2.FLOODFILL_FIXED_RANGE | cv2.FLOODFILL_MASK_ONLY | 255 << 8
    cv2.floodFill(cv2.blur(picture, (3, 3)), mask, seed, 0, tolerance, tolerance, flags)
    return mask[1:-1, 1:-1]
