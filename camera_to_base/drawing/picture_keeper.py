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

"""Keeps one annotated picture up to date, for somebody who wants to see what the node sees."""

from typing import Sequence

from camera_to_base.detection import LocatedObject, Pixel, Point
from camera_to_base.drawing.overlay import draw_objects, draw_pixel, write_picture
from camera_to_base.surface import ImageSize
import numpy as np


class PictureKeeper:
    """
    Writes the frame with the largest object so far.

    :param path: The file, .png or .jpg; '' for none.
    """

    def __init__(self, path: str) -> None:
        self._path = path
        self._largest_area = -1.0

    def keep(self, frame: np.ndarray, objects: Sequence[LocatedObject]) -> None:
        """
        Write a frame if its object is the largest so far.

        :param objects: The largest first, at least one.
        :raises InvalidValueError: If the file cannot be written.
        """
        area = objects[0].detection.area
        if self._path and area > self._largest_area:
            self._largest_area = area
            write_picture(self._path, draw_objects(frame, objects))

    def keep_pixel(self, image_size: ImageSize, pixel: Pixel, point: Point) -> None:
        """
        Write a pixel that comes without a frame.

        :raises InvalidValueError: If the file cannot be written.
        """
        if self._path:
            write_picture(self._path, draw_pixel(image_size, pixel, point))
