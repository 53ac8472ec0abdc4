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

"""The newest picture with the corners of a board that are found in it."""

from typing import Sequence

import cv2
import numpy as np

# Blue, green, red.
_CORNER, _RIM, _TAKEN = (80, 220, 60), (0, 0, 0), (255, 170, 0)
# Larger pictures are made smaller for the page.
_WIDTH = 960
_QUALITY = 85


def board_picture(
    image: np.ndarray, corners: np.ndarray, taken: Sequence[np.ndarray] = ()
) -> bytes:
    """
    Draw what is found.

    :param image: Shape (h, w, 3), uint8, BGR.
    :param corners: Shape (n, 2), u and v, in px.
    :param taken: The outlines of the placements that were taken, each of shape (m, 2), in px.
    :returns: A JPEG.
    """
    scale = min(1.0, _WIDTH / image.shape[1])
    drawn = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    for outline in taken:
        cv2.polylines(drawn, [np.round(outline * scale).astype(np.int32)], True, _TAKEN, 2,
                      cv2.LINE_AA)
    for u, v in np.round(corners * scale).astype(int).tolist():
        cv2.circle(drawn, (u, v), 6, _RIM, 3, cv2.LINE_AA)
        cv2.circle(drawn, (u, v), 6, _CORNER, 2, cv2.LINE_AA)
    return cv2.imencode('.jpg', drawn, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])[1].tobytes()
