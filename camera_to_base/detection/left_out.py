# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Why something that differs from the background is not published, and where it is."""

import math
from typing import Callable, List, NamedTuple, Optional, Sequence

from camera_to_base.detection.detection import Box, Detection, NoObject, Pixel
from camera_to_base.errors import HorizonError, Level, Reason
from camera_to_base.surface import Surface
import numpy as np

# What is smaller by default, on the surface, and narrower than so many px, is dust: where a pixel
# sees less of the surface, as below a microscope, small things are objects.
SPECK_CM2, _SPECK_PX = 0.05, 12
_CORNERS = 12


def _reason(kind: str, level: Level, sentence: str) -> Reason:
    return Reason(kind, level, sentence, is_passing=True)


# By their words. Those of level OK are no objects, and give no warning.
REASONS = {reason.kind: reason for reason in (
    _reason('shade', Level.OK, 'the surface is seen there, darker than before: it is shade'),
    _reason('light', Level.OK, 'the surface is seen there, lighter than before: it is light'),
    _reason('speck', Level.OK, 'it is too small for an object: dust, or noise'),
    _reason('joined', Level.WARN,
            'it touches another object or is covered by it, and both come as one: move it, or set '
            'detector.split_touching'),
    _reason('hidden', Level.WARN,
            'the camera does not see where it stands, behind another object: it is published when '
            'that one is gone'),
    _reason('light_or_thing', Level.WARN,
            'it cannot be told whether it is light or a thing of the colour of the surface: keep '
            'the light even, or use a surface of another colour'),
    _reason('too_much', Level.WARN,
            'so much differs from the background that not all of it was looked at: clear the '
            'surface, and call ~/capture_background'),
    _reason('taken_away', Level.WARN,
            'something was taken away from the surface since the background was taken: clear the '
            'surface, and call ~/capture_background'))}


class Point(NamedTuple):
    """A position on the work surface, in the camera frame, in cm."""

    x: float
    y: float


class LeftOut(NamedTuple):
    """
    A detection that is not published, and the reason.

    :param point: Where it is; None if it is not on the surface.
    """

    detection: Detection
    reason: Reason
    point: Optional[Point] = None


def locate_pixel(surface: Surface, pixel: Sequence[float]) -> Point:
    """
    Map one pixel to the work surface.

    :param pixel: u and v, in px.
    :raises HorizonError: If the pixel lies on the horizon or beyond it.
    """
    x, y = surface.locate([pixel])[0]
    return Point(float(x), float(y))


def left_out_places(
    places: Sequence[NoObject], locate: Callable[[np.ndarray], np.ndarray]
) -> List[LeftOut]:
    """
    List what the detector has found to be no object, each as a disc of its area.

    :param locate: Maps pixels of shape (n, 2) to the surface, shape (n, 2), as Surface.locate.
    """
    return [LeftOut(_disc(place), REASONS[place.kind], point)
            for place, point in zip(places, _points(places, locate))]


def reason_by_size(
    area_cm2: float, area_px: float, least_cm2: float, most_cm2: float
) -> Optional[Reason]:
    """
    Tell why an object of some size does not count; None where it does.

    :param area_cm2: Its area on the surface, in cm².
    :param area_px: The same on the picture, in px².
    :param least_cm2: Smaller ones do not count. The default means specks.
    :param most_cm2: Larger ones do not count.
    """
    is_speck = area_cm2 < min(SPECK_CM2, least_cm2) and area_px < _SPECK_PX ** 2
    if is_speck:
        return REASONS['speck']
    if area_cm2 < least_cm2 != SPECK_CM2:
        return _reason('too_small', Level.OK, f'its area of {area_cm2:.3g} cm² is less than '
                       f'detector.min_area_cm2, {least_cm2:g}')
    if area_cm2 > most_cm2:
        return _reason('too_large', Level.OK, f'its area of {area_cm2:.3g} cm² is more than '
                       f'detector.max_area_cm2, {most_cm2:g}')
    return None


def _disc(place: NoObject) -> Detection:
    radius = math.sqrt(place.area / math.pi)
    turns = np.linspace(0, 2 * np.pi, _CORNERS, endpoint=False)
    corners = place.position + radius * np.column_stack([np.cos(turns), np.sin(turns)])
    left, top = np.floor(corners.min(axis=0)).astype(int).tolist()
    right, bottom = np.ceil(corners.max(axis=0)).astype(int).tolist()
    return Detection(Box(left, top, right - left + 1, bottom - top + 1), Pixel(*place.position),
                     place.area, np.rint(corners).astype(np.int32), False)


def _points(
    places: Sequence[NoObject], locate: Callable[[np.ndarray], np.ndarray]
) -> List[Optional[Point]]:
    if not places:
        return []
    pixels = np.array([place.position for place in places])
    try:
        # To ask the surface once is faster.
        return [Point(x, y) for x, y in locate(pixels).tolist()]
    except HorizonError:
        return [_point(pixel, locate) for pixel in pixels]


def _point(
    pixel: np.ndarray, locate: Callable[[np.ndarray], np.ndarray]
) -> Optional[Point]:
    try:
        return Point(*locate(pixel[None])[0].tolist())
    except HorizonError:
        return None
