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

"""Draws what was detected on a frame, but is not published."""

from typing import Sequence

from camera_to_base.detection import LeftOut
from camera_to_base.drawing.labels import Labels, line_width
import cv2
import numpy as np

_OUTLINE_COLOUR = (160, 160, 160)


def draw_left_out(frame: np.ndarray, left_out: Sequence[LeftOut]) -> np.ndarray:
    """
    Draw in grey what was left out, each with the word for its reason.

    :param frame: Shape (h, w, 3), uint8, BGR; it is not changed.
    :returns: A picture of the same shape; the frame itself if nothing was left out.
    """
    if not left_out:
        return frame
    picture = frame.copy()
    for one in left_out:
        cv2.polylines(picture, [one.detection.outline], True, _OUTLINE_COLOUR,
                      line_width(picture), cv2.LINE_AA)
    labels = Labels(picture, [one.detection.box for one in left_out])
    for one in left_out:
        labels.add(one.reason.kind.replace('_', ' '), one.detection.box)
    labels.draw()
    return picture
