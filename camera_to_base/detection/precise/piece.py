# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
A piece of the frame around a region: its levels, outline, and reduced size.

Light is averaged, so that a pixel on the rim still shows the share that the object covers.
"""

from functools import lru_cache
from typing import NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection.detection import Box
from camera_to_base.detection.precise.light import LEAST_LIGHT, LINEAR, SATURATED
import cv2
import numpy as np

_ONES = np.ones((1, 3), np.float32)
_AT_ORIGIN = Box(0, 0, 0, 0)

# So many values give a quantile.
_ENOUGH = 500
# What is no group of its own, as a part of all.
_FEW = 0.02


@lru_cache(maxsize=None)
def square(size: int) -> np.ndarray:
    """Make a square kernel."""
    return np.ones((size, size), np.uint8)


@lru_cache(maxsize=None)
def disc(size: int) -> np.ndarray:
    """Make a round kernel."""
    return cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))


def channel_sum(values: np.ndarray) -> np.ndarray:
    """Add up the channels: shape (h, w, 3) to (h, w), float32."""
    return cv2.transform(values, _ONES)


def channel_extremes(values: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Give the smallest and the largest channel of each pixel: shape (h, w, 3) to two (h, w)."""
    # One by one: cv2.split takes ten times as long on large pictures.
    blue, green, red = (cv2.extractChannel(values, channel) for channel in range(3))
    return (cv2.min(cv2.min(blue, green), red), cv2.max(cv2.max(blue, green), red))


def cut_off(picture: np.ndarray) -> np.ndarray:
    """Find what the sensor has cut off in all channels: shape (h, w), uint8, 1 there."""
    return (channel_extremes(picture)[0] >= SATURATED).view(np.uint8)


def ratio_of(light: np.ndarray, usual: np.ndarray) -> np.ndarray:
    """Divide light by the table's, both of shape (h, w, 3): also where the table is black."""
    # cv2.max with one number limits the first channel alone.
    return cv2.divide(light, cv2.max(usual, (LEAST_LIGHT,) * 3))


def chosen(values: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Give the pixels in a mask, shape (h, w, 3) to (n, 3): faster than a mask as an index."""
    return values.reshape(-1, values.shape[-1]).take(np.flatnonzero(mask > 0), axis=0)


def quantile(values: np.ndarray, share: float = 0.5) -> np.ndarray:
    """
    Give the value that a share of the values lies below, along the first axis.

    It is one of the values, without interpolation, and much faster than numpy's for few values.

    Of many values, some tell as much as all.

    :param values: Shape (n, ...), n at least 1.
    """
    values = values[::max(len(values) // _ENOUGH, 1)]
    index = int(share * len(values))
    return np.partition(values, index, axis=0)[index]


def two_means(values: np.ndarray) -> Tuple[float, float]:
    """Give the means of two groups of values (Otsu's method); the same where all are alike."""
    # A few that are far off are no group.
    usual = np.clip(values, quantile(values, _FEW), quantile(values, 1 - _FEW)).reshape(-1, 1)
    levels = cv2.normalize(usual, None, 0, 255, cv2.NORM_MINMAX, cv2.CV_8U)
    is_high = levels.ravel() > cv2.threshold(levels, 0, 255, cv2.THRESH_OTSU)[0]
    groups = (values[~is_high], values[is_high]) if is_high.any() else (values, values)
    return groups[0].mean(), groups[1].mean()


class Piece(NamedTuple):
    """
    A part of a frame.

    :param frame: Its light, shape (h, w, 3), float32.
    :param table: The background's, at the frame's light, of the same shape.
    :param mask: The region, shape (h, w), uint8, 1 inside.
    """

    frame: np.ndarray
    table: np.ndarray
    mask: np.ndarray


def make_piece(frame: np.ndarray, table: np.ndarray, mask: np.ndarray) -> Piece:
    """
    Make a piece.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param table: Of the same shape, float32, see :meth:`Reference.light`.
    """
    return Piece(cv2.LUT(frame, LINEAR), table, mask)


def largest_part(mask: np.ndarray) -> np.ndarray:
    """Keep the largest connected part of a mask of 0 and 1, without its holes."""
    outline = outline_of(mask)
    kept = np.zeros_like(mask)
    return kept if outline is None else cv2.drawContours(kept, [outline], 0, 1, cv2.FILLED)


def centre_of(mask: np.ndarray) -> Tuple[float, float]:
    """Give the centroid of a mask, u and v in its own px; (0, 0) of an empty one."""
    moments = cv2.moments(mask, binaryImage=True)
    area = max(moments['m00'], 1.0)
    return moments['m10'] / area, moments['m01'] / area


def outlines_in(mask: np.ndarray, window: Box = _AT_ORIGIN) -> Sequence[np.ndarray]:
    """
    Find the outer outlines in a mask.

    :param window: Where the mask lies on the picture; only its place counts.
    :returns: Each of shape (n, 1, 2), int32, in px of the picture.
    """
    return cv2.findContours(
        mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE, offset=window[:2])[0]


def enclosed(outline: np.ndarray) -> float:
    """Count the pixels that an outline encloses, with its own, by Pick's theorem."""
    return cv2.contourArea(outline) + len(outline) / 2 + 1


def has_holes(outline: np.ndarray, count: int) -> bool:
    """
    Tell whether a region has holes: an outline without one encloses just the region's pixels.

    :param outline: Its outline, see :func:`outlines_in`.
    :param count: Its number of pixels.
    """
    return count < enclosed(outline)


def outline_of(mask: np.ndarray, window: Box = _AT_ORIGIN) -> Optional[np.ndarray]:
    """Find the largest outline in a mask, see :func:`outlines_in`; None where it is empty."""
    outlines = outlines_in(mask, window)
    return max(outlines, key=cv2.contourArea) if outlines else None


def solidity(mask: np.ndarray) -> float:
    """Tell how much of its convex hull a mask fills."""
    outline = outline_of(mask)
    return 0.0 if outline is None else fullness(outline)


def fullness(outline: np.ndarray) -> float:
    """Tell how much of its convex hull an outline encloses: less where it has a notch."""
    hull = cv2.contourArea(cv2.convexHull(outline))
    return cv2.contourArea(outline) / hull if hull else 0.0


def filled(outline: np.ndarray, box: Box, value: int = 1) -> np.ndarray:
    """Draw a region's outline, filled: shape (height, width) of a box, uint8, `value` inside."""
    mask = np.zeros((box.height, box.width), np.uint8)
    return cv2.drawContours(mask, [outline], 0, value, cv2.FILLED, offset=(-box.x, -box.y))


def without_rim(inside: np.ndarray, kernel: np.ndarray) -> np.ndarray:
    """Erode a mask: by default, what is beyond the picture counts as inside."""
    return cv2.erode(inside, kernel, borderType=cv2.BORDER_CONSTANT, borderValue=0)


def slices(box: Box) -> tuple:
    """Give a box as indices of a picture."""
    return slice(box.y, box.y + box.height), slice(box.x, box.x + box.width)


def grown(box: Box, margin: int, picture: np.ndarray) -> Box:
    """Grow a box by some px to all sides, as far as the picture goes."""
    height, width = picture.shape[:2]
    left, top = max(box.x - margin, 0), max(box.y - margin, 0)
    right = min(box.x + box.width + margin, width)
    bottom = min(box.y + box.height + margin, height)
    return Box(left, top, right - left, bottom - top)


def reduced(piece: Piece, most: int) -> Tuple[Piece, int]:
    """
    Reduce a piece until it has few pixels.

    :param most: How many pixels it may have.
    :returns: The piece, and how many px of the given one make one of its px, along each axis.
    """
    scale = 1
    while piece.mask.size > most:
        piece, scale = _halved(piece), 2 * scale
    return piece, scale


def enlarged(picture: np.ndarray, scale: int, like: np.ndarray) -> np.ndarray:
    """Bring a picture of a reduced piece back to the size of another: shape (h, w)."""
    if scale == 1:
        return picture
    height, width = picture.shape
    whole = cv2.resize(
        picture, (width * scale, height * scale), interpolation=cv2.INTER_NEAREST)
    return whole[:like.shape[0], :like.shape[1]]


def _halved(piece: Piece) -> Piece:
    frame, table, mask = (shrunk(picture, 2) for picture in piece)
    return Piece(frame, table, mask)


def padded(picture: np.ndarray, scale: int) -> np.ndarray:
    """
    Repeat a picture's last row and column, until its lengths are multiples of a scale.

    So what touches the border still touches it on the reduced picture.
    """
    height, width = picture.shape[:2]
    if not (height % scale or width % scale):
        return picture
    return cv2.copyMakeBorder(
        picture, 0, -height % scale, 0, -width % scale, cv2.BORDER_REPLICATE)


def shrunk(picture: np.ndarray, scale: int) -> np.ndarray:
    """Reduce a picture by a whole number: cv2.resize is much faster then."""
    whole = padded(picture, scale)
    return cv2.resize(whole, (whole.shape[1] // scale, whole.shape[0] // scale),
                      interpolation=cv2.INTER_AREA)
