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

"""Labels on a picture: scaled with the picture, and placed without overlap."""

from typing import Iterator, List, NamedTuple, Sequence, Tuple

from camera_to_base.detection import Box
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
