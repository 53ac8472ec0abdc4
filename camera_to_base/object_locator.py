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

"""The whole way on one frame: from the picture to points in the camera frame."""

from typing import List, NamedTuple, Sequence

from camera_to_base.absolute_difference import AbsoluteDifferenceDetector, Detection
from camera_to_base.errors import HorizonError
from camera_to_base.surface import Surface
import numpy as np


class Point(NamedTuple):
    """A position on the work surface, in the camera frame, in cm."""

    x: float
    y: float


class LocatedObject(NamedTuple):
    """An object: where it is on the picture, and where on the surface."""

    detection: Detection
    point: Point


class ObjectLocator:
    """
    Locates every object on a frame.

    :param detector: Finds objects on a frame.
    :param surface: Maps pixels of that detector's frames to the work surface.
    """

    def __init__(self, detector: AbsoluteDifferenceDetector, surface: Surface) -> None:
        self._detector = detector
        self._surface = surface

    def locate(self, frame: np.ndarray) -> List[LocatedObject]:
        """
        Locate the objects that lie on the work surface.

        What is seen beyond the horizon (somebody walks through the room) is no object on the
        surface and is left out.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :returns: The largest first; none is [].
        :raises HorizonError: If something is seen, but all of it beyond the horizon.
        :raises FrameSizeError: If the frame's size is not the background's.
        """
        objects, beyond = [], None
        for detection in self._detector.detect(frame):
            try:
                point = locate_pixel(self._surface, detection.centre)
            except HorizonError as error:
                beyond = beyond or error
            else:
                objects.append(LocatedObject(detection, point))
        if beyond is not None and not objects:
            raise beyond
        return objects


def locate_pixel(surface: Surface, pixel: Sequence[float]) -> Point:
    """
    Map one pixel to the work surface.

    :param pixel: u and v, in px.
    :raises HorizonError: If the pixel lies on the horizon or beyond it.
    """
    x, y = surface.locate([pixel])[0]
    return Point(float(x), float(y))
