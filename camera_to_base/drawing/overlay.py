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

"""Draws the objects found on a frame, and writes pictures."""

import math
import os
import textwrap
from typing import Callable, Sequence

from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.detection import Box, check_frame, Detection, LocatedObject, Pixel, Point
from camera_to_base.drawing.labels import Labels, line_width, TextStyle
from camera_to_base.errors import InvalidValueError
from camera_to_base.files import check_folder
import cv2
import numpy as np

Label = Callable[[Point], str]

_OUTLINE_COLOUR = (216, 160, 32)
_BOX_COLOUR = (36, 200, 36)
_CENTRE_COLOUR = (32, 32, 240)


def camera_label(point: Point) -> str:
    """Format a position in the camera frame, like the tutorial's first script."""
    return f'x {point.x:.2f}, y {point.y:.2f} cm'


def base_label(conversion: CameraToRobotBaseConversion) -> Label:
    """Make a label with the position in the base frame, like the tutorial's second script."""
    def label(point: Point) -> str:
        x, y, _ = conversion.convert_point(*point)
        return f'base x {x:.2f}, y {y:.2f} cm'
    return label


def draw_objects(
    frame: np.ndarray, objects: Sequence[LocatedObject], label: Label = camera_label
) -> np.ndarray:
    """
    Draw each object's outline, box, centre, direction (if it has one) and label.

    A label starts with the object's number, the same as in the table of `locate`.

    :param frame: Shape (h, w, 3), uint8, BGR; it is not changed.
    :param objects: The largest first; it has number 1.
    :param label: Formats a position as text.
    :returns: A picture of the same shape.
    """
    picture = frame.copy()
    for found in objects:
        _draw_object(picture, found)
    labels = Labels(picture, [found.detection.box for found in objects])
    for number, found in enumerate(objects, start=1):
        labels.add(f'{number}: {label(found.point)}', found.detection.box)
    labels.draw()
    return picture


def draw_note(picture: np.ndarray, note: str) -> None:
    """Write a text into a picture's top-left corner, with line breaks."""
    style, top = TextStyle.of(picture), 2
    letter_width = style.size('n' * 10)[0] / 10
    for line in textwrap.wrap(note, max(10, int((picture.shape[1] - 4) / letter_width))):
        width, height = style.size(line)
        style.write(picture, line, Box(2, top, width, height))
        top += height


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


def encoded_picture(path: str, picture: np.ndarray) -> bytes:
    """
    Encode a picture as the content of a file.

    :param path: The file's name; the ending sets the format.
    :raises InvalidValueError: If the ending is unknown, or the picture is invalid.
    """
    ending = check_picture_path(path)
    check_frame(picture, 'picture')
    return cv2.imencode(ending, picture)[1].tobytes()


def check_picture_path(path: str) -> str:
    """
    Check that a picture's file name has a known ending, and that its folder exists.

    :returns: The ending: '.png' or '.jpg'.
    :raises InvalidValueError: If the ending is unknown, or the folder does not exist.
    """
    ending = os.path.splitext(path)[1].lower()
    if ending not in ('.png', '.jpg'):
        raise InvalidValueError(f"a picture's name must end in .png or .jpg, got '{path}'")
    check_folder(path, 'picture')
    return ending


def _draw_object(picture: np.ndarray, found: LocatedObject) -> None:
    detection, box, width = found.detection, found.detection.box, line_width(picture)
    cv2.polylines(picture, [detection.outline], True, _OUTLINE_COLOUR, width, cv2.LINE_AA)
    cv2.rectangle(picture, (box.x, box.y), (box.x + box.width - 1, box.y + box.height - 1),
                  _BOX_COLOUR, 2 * width)
    _draw_centre(picture, detection.centre)
    if found.yaw is not None:
        _draw_axis(picture, detection)


def _draw_centre(picture: np.ndarray, pixel: Pixel) -> None:
    cv2.circle(picture, (round(pixel.u), round(pixel.v)), 3 * line_width(picture), _CENTRE_COLOUR,
               -1)


def _draw_axis(picture: np.ndarray, detection: Detection) -> None:
    (u, v), angle = detection.centre, detection.orientation
    half = max(detection.box.width, detection.box.height) / 2
    du, dv = half * math.cos(angle), half * math.sin(angle)
    cv2.line(picture, (round(u - du), round(v - dv)), (round(u + du), round(v + dv)),
             _CENTRE_COLOUR, line_width(picture), cv2.LINE_AA)
