# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Draws on a frame: outlines, centres, labels, ellipses, areas, and what was left out."""

import math
import textwrap
from typing import Callable, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.detection import (
    Area, Areas, Box, Detection, LeftOut, LocatedObject, Pixel, Point)
from camera_to_base.errors import HorizonError
from camera_to_base.surface import Surface
from camera_to_base.uncertainty import error_ellipse, Spread
import cv2
import numpy as np

_FONT = cv2.FONT_HERSHEY_SIMPLEX
_TEXT_COLOUR = (255, 255, 255)
_PATCH_COLOUR = (40, 40, 40)
_LEADER_COLOUR = (32, 32, 240)

# Size of the picture for which a font scale of 0.5 and lines of 1 px are right, and the smallest
# readable font.
_REFERENCE_PX = 640 * 480
_REFERENCE_SCALE = 0.5
_SMALLEST_SCALE = 0.35

# Hiding a part of a label costs this many times more than hiding a part of an object.
_LABEL_WEIGHT = 10
# Number of lines above and below its object among which a label is placed.
_LINES_AWAY = 8

_SHARE = 0.95
_COLOUR = (0, 140, 255)
# A smaller ellipse lies within the mark of the centre.
_SMALLEST_PX = 1.0
# OpenCV draws with a resolution of 1 / 2^4 px.
_SHIFT = 4

_WORK_COLOUR, _IGNORED_COLOUR = (60, 180, 60), (60, 60, 200)
# The areas' outlines are found on a grid of places, in px, and smoothly between them.
_STEP = 8

_LEFT_OUT_COLOUR = (160, 160, 160)

# So many labels leave a picture of 640 x 480 px readable.
_MOST_LABELS = 10

# The problem, which a sentence begins with; the cure is in the log and on the page.
_MOST_NOTE_LINES = 2

Label = Callable[[Point], str]

_OUTLINE_COLOUR = (216, 160, 32)
_BOX_COLOUR = (36, 200, 36)
_FOOTPRINT_COLOUR = (36, 200, 230)
_CENTRE_COLOUR = (32, 32, 240)


def line_width(picture: np.ndarray) -> int:
    """Return the thickness of a thin line in a picture of shape (h, w, 3), in px."""
    return max(1, round(_magnification(picture)))


class TextStyle(NamedTuple):
    """
    The size of a text.

    :param scale: OpenCV's font scale.
    :param thickness: Thickness of a stroke, in px.
    :param margin: Margin of the dark patch around the text, in px.
    """

    scale: float
    thickness: int
    margin: int

    @classmethod
    def of(cls, picture: np.ndarray) -> 'TextStyle':
        """Return the style for a picture of shape (h, w, 3)."""
        scale = max(_SMALLEST_SCALE, _REFERENCE_SCALE * _magnification(picture))
        return cls(scale, line_width(picture), round(6 * scale))

    def size(self, text: str) -> Tuple[int, int]:
        """Return a text's width and height with its patch, in px."""
        (width, height), below = cv2.getTextSize(text, _FONT, self.scale, self.thickness)
        return width + 2 * self.margin, height + below + 2 * self.margin

    def write(self, picture: np.ndarray, text: str, place: Box) -> None:
        """Write a text on a dark patch, so that it is readable on any picture."""
        (_, height), _ = cv2.getTextSize(text, _FONT, self.scale, self.thickness)
        cv2.rectangle(picture, (place.x, place.y),
                      (place.x + place.width - 1, place.y + place.height - 1), _PATCH_COLOUR, -1)
        corner = place.x + self.margin, place.y + self.margin + height
        cv2.putText(picture, text, corner, _FONT, self.scale, _TEXT_COLOUR, self.thickness,
                    cv2.LINE_AA)


class Labels:
    """
    Places labels beside objects, inside the picture, and without overlap if there is room.

    :param picture: Shape (h, w, 3), uint8, BGR; `draw` draws on it.
    :param boxes: Boxes of all objects, which labels avoid if possible.
    """

    def __init__(self, picture: np.ndarray, boxes: Sequence[Box]) -> None:
        self._picture, self._style = picture, TextStyle.of(picture)
        # The topmost line is reserved for a note.
        _, line = self._style.size('0')
        self._taken = [Box(0, 0, picture.shape[1], line), *boxes]
        self._weights = [1] * len(self._taken)
        self._labels: List[Tuple[str, Box, Box]] = []

    def add(self, text: str, box: Box) -> None:
        """
        Place a label.

        :param box: The object that it belongs to.
        """
        width, height = self._style.size(text)
        places = [self._inside(Box(x, y, width, height))
                  for x, y in _corners(box, width, height, self._style.margin)]
        place = places[int(np.argmin([self._hidden(place) for place in places]))]
        self._taken.append(place)
        self._weights.append(_LABEL_WEIGHT)
        self._labels.append((text, place, box))

    def draw(self) -> None:
        """Draw all labels; a label that is not beside its object gets a line to it."""
        for _, place, box in self._labels:
            if _gap(place, box) > place.height / 2:
                cv2.line(self._picture, _middle(place), _middle(box), _LEADER_COLOUR,
                         self._style.thickness, cv2.LINE_AA)
        for text, place, _ in self._labels:
            self._style.write(self._picture, text, place)

    def _inside(self, place: Box) -> Box:
        height, width = self._picture.shape[:2]
        return place._replace(x=max(0, min(place.x, width - place.width)),
                              y=max(0, min(place.y, height - place.height)))

    def _hidden(self, place: Box) -> float:
        """Return how much a label would hide there, as a weighted number of pixels."""
        x, y, width, height = np.array(self._taken).T
        across = np.minimum(x + width, place.x + place.width) - np.maximum(x, place.x)
        along = np.minimum(y + height, place.y + place.height) - np.maximum(y, place.y)
        return float(np.clip(across, 0, None) * np.clip(along, 0, None) @ self._weights)


def _corners(box: Box, width: int, height: int, gap: int) -> Iterator[Tuple[int, int]]:
    """Return the possible top-left corners of a label, the best first."""
    above, below = box.y - gap - height, box.y + box.height + gap
    yield from ((box.x, above), (box.x, below), (box.x + box.width + gap, box.y),
                (box.x - gap - width, box.y))
    for lines in range(1, _LINES_AWAY + 1):
        away = lines * (height + gap)
        yield from ((box.x, above - away), (box.x, below + away))


def _gap(place: Box, box: Box) -> float:
    """Return the distance between two boxes, in px."""
    across = max(box.x - place.x - place.width, place.x - box.x - box.width, 0)
    along = max(box.y - place.y - place.height, place.y - box.y - box.height, 0)
    return float(np.hypot(across, along))


def _middle(box: Box) -> Tuple[int, int]:
    return box.x + box.width // 2, box.y + box.height // 2


def _magnification(picture: np.ndarray) -> float:
    return float(np.sqrt(picture.shape[0] * picture.shape[1] / _REFERENCE_PX))


def draw_ellipses(picture: np.ndarray, centres: Iterable[Tuple[Pixel, Spread]]) -> None:
    """
    Draw the ellipses of centres that are larger than a pixel.

    :param picture: Shape (h, w, 3), uint8, BGR; it is drawn on.
    :param centres: With their covariances, in px².
    """
    largest = float(np.hypot(*picture.shape[:2]))
    for (u, v), (uu, uv, vv) in centres:
        ellipse = error_ellipse(np.array([[uu, uv], [uv, vv]]), _SHARE)
        if not _SMALLEST_PX < ellipse.long < largest:
            continue
        centre, axes = (tuple(round(value * 2 ** _SHIFT) for value in pair)
                        for pair in ((u, v), (ellipse.long, ellipse.short)))
        cv2.ellipse(picture, centre, axes, np.degrees(ellipse.angle), 0, 360, _COLOUR,
                    line_width(picture), cv2.LINE_AA, _SHIFT)


class AreaOverlay:
    """
    Draws areas on frames; their outlines are computed once for each picture size.

    :param surface: Maps pixels to the work surface.
    """

    def __init__(self, surface: Surface, areas: Areas) -> None:
        self._surface, self._areas = surface, areas
        self._size: Optional[tuple] = None

    def use_surface(self, surface: Surface) -> None:
        """Draw the areas where the pixels of another surface show them, from now on."""
        if surface is not self._surface:
            self._surface, self._size = surface, None

    def draw(self, picture: np.ndarray) -> None:
        """Draw the areas' outlines on a picture of shape (h, w, 3), uint8, in place."""
        if self._areas == Areas():
            return
        if self._size != picture.shape[:2]:
            self._size = height, width = picture.shape[:2]
            self._located = self._surface.for_image_size((width, height))
            self._work = self._outlines([self._areas.work] if self._areas.work else [])
            self._ignored = self._outlines(list(self._areas.ignored))
        cv2.drawContours(picture, self._work, -1, _WORK_COLOUR, 2)
        cv2.drawContours(picture, self._ignored, -1, _IGNORED_COLOUR, 2)

    def _outlines(self, areas: List[Area]) -> List[np.ndarray]:
        height, width = self._size
        rows, columns = (np.linspace(0, length - 1, max(length // _STEP, 2))
                         for length in (height, width))
        points = [self._points(row, columns) for row in rows]
        outlines: List[np.ndarray] = []
        for area in areas:
            depths = np.array([[area.depth(point) for point in line] for line in points])
            depths = cv2.resize(depths.astype(np.float32), (width, height))
            found, _ = cv2.findContours(
                (depths > 0).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
            outlines.extend(found)
        return outlines

    def _points(self, row: float, columns: np.ndarray) -> np.ndarray:
        # What lies beyond the horizon is far away from every area.
        try:
            return self._located.locate(np.column_stack([columns, np.full(len(columns), row)]))
        except HorizonError:
            return np.full((len(columns), 2), 1e6)


def draw_left_out(frame: np.ndarray, left_out: Sequence[LeftOut]) -> np.ndarray:
    """
    Draw in grey what was left out, ten with the word for their reason: those of a warning first.

    :param frame: Shape (h, w, 3), uint8, BGR; it is not changed.
    :returns: A picture of the same shape; the frame itself if nothing was left out.
    """
    if not left_out:
        return frame
    picture = frame.copy()
    left_out = sorted(left_out, key=lambda one: (-one.reason.level, -one.detection.area))
    for one in left_out[_MOST_LABELS:]:
        _draw_dot(picture, one.detection.centre, _LEFT_OUT_COLOUR)
    left_out = left_out[:_MOST_LABELS]
    for one in left_out:
        cv2.polylines(picture, [one.detection.outline], True, _LEFT_OUT_COLOUR,
                      line_width(picture), cv2.LINE_AA)
    labels = Labels(picture, [one.detection.box for one in left_out])
    for one in left_out:
        labels.add(one.reason.kind.replace('_', ' '), one.detection.box)
    labels.draw()
    return picture


def camera_label(point: Point) -> str:
    """Format a position in the camera frame, like the tutorial's first script."""
    return f'x {point.x:.2f}, y {point.y:.2f} cm'


def base_label(conversion: CameraToRobotBaseConversion) -> Label:
    """Make a label with the position in the base frame, like the tutorial's second script."""
    def label(point: Point) -> str:
        x, y, _ = conversion.convert_point(*point)
        return f'base x {x:.2f}, y {y:.2f} cm'
    return label


def object_label(conversion: Optional[CameraToRobotBaseConversion]) -> Label:
    """Make a label with the position in the base frame; in the camera frame for None."""
    return camera_label if conversion is None else base_label(conversion)


def draw_objects(
    frame: np.ndarray, objects: Sequence[LocatedObject], label: Label = camera_label
) -> np.ndarray:
    """
    Draw each object's outline, box, centre, direction (if it has one) and label.

    A label starts with the object's number, the same as in the table of `locate`. Of more than ten
    objects, the others are dots: their labels would hide the picture.

    :param frame: Shape (h, w, 3), uint8, BGR; it is not changed.
    :param objects: The largest first; it has number 1.
    :param label: Formats a position as text.
    :returns: A picture of the same shape.
    """
    picture = frame.copy()
    largest = objects[:_MOST_LABELS]
    for found in objects[_MOST_LABELS:]:
        _draw_dot(picture, found.detection.centre, _CENTRE_COLOUR)
    for found in largest:
        _draw_object(picture, found)
    labels = Labels(picture, [found.detection.box for found in largest])
    for number, found in enumerate(largest, start=1):
        labels.add(f'{number}: {label(found.point)}', found.detection.box)
    labels.draw()
    return picture


def draw_note(picture: np.ndarray, note: str) -> None:
    """Write a text into a picture's top-left corner; the rest of a long one is left out."""
    style, top = TextStyle.of(picture), 2
    letter_width = style.size('n' * 10)[0] / 10
    letters = max(10, int((picture.shape[1] - 4) / letter_width))
    for line in textwrap.wrap(note, letters, max_lines=_MOST_NOTE_LINES, placeholder=' ...'):
        width, height = style.size(line)
        style.write(picture, line, Box(2, top, width, height))
        top += height


def _draw_dot(picture: np.ndarray, centre: Pixel, colour: Tuple[int, int, int]) -> None:
    cv2.circle(picture, (round(centre.u), round(centre.v)), 2 * line_width(picture), colour, -1,
               cv2.LINE_AA)


def object_mask(frame: np.ndarray, objects: Sequence[LocatedObject]) -> np.ndarray:
    """
    Return the mask of the objects on a frame.

    :param frame: Shape (h, w, 3).
    :returns: Shape (h, w), uint8, 255 within the objects' outlines, 0 elsewhere.
    """
    mask = np.zeros(frame.shape[:2], np.uint8)
    for found in objects:
        cv2.fillPoly(mask, [found.detection.outline], 255)
    return mask


def _draw_object(picture: np.ndarray, found: LocatedObject) -> None:
    detection, box, width = found.detection, found.detection.box, line_width(picture)
    cv2.polylines(picture, [detection.outline], True, _OUTLINE_COLOUR, width, cv2.LINE_AA)
    cv2.rectangle(picture, (box.x, box.y), (box.x + box.width - 1, box.y + box.height - 1),
                  _BOX_COLOUR, 2 * width)
    if found.solid is not None:
        _draw_footprint(picture, found)
        return
    _draw_centre(picture, detection.centre)
    if found.yaw is not None:
        _draw_axis(picture, detection)


def _draw_footprint(picture: np.ndarray, found: LocatedObject) -> None:
    solid, point = found.solid, np.array(found.point)
    size = found.size(solid.surface)
    along = np.array([math.cos(size.angle), math.sin(size.angle)]) * size.length_cm / 2
    places = [point, point, point] if found.yaw is None else [point, point - along, point + along]
    pixels = np.concatenate([solid.surface.pixels(np.array(places)), solid.pixels])
    if not np.isfinite(pixels).all():
        return
    centre, start, end = (Pixel(*pixel) for pixel in pixels[:3].tolist())
    cv2.polylines(picture, [np.round(pixels[3:]).astype(np.int32)], True, _FOOTPRINT_COLOUR,
                  line_width(picture), cv2.LINE_AA)
    cv2.line(picture, *((round(u), round(v)) for u, v in (start, end)), _CENTRE_COLOUR,
             line_width(picture), cv2.LINE_AA)
    _draw_centre(picture, centre)


def _draw_centre(picture: np.ndarray, pixel: Pixel) -> None:
    cv2.circle(picture, (round(pixel.u), round(pixel.v)), 3 * line_width(picture), _CENTRE_COLOUR,
               -1)


def _draw_axis(picture: np.ndarray, detection: Detection) -> None:
    (u, v), angle = detection.centre, detection.orientation
    half = max(detection.box.width, detection.box.height) / 2
    du, dv = half * math.cos(angle), half * math.sin(angle)
    cv2.line(picture, (round(u - du), round(v - dv)), (round(u + du), round(v + dv)),
             _CENTRE_COLOUR, line_width(picture), cv2.LINE_AA)
