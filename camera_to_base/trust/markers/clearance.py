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
"""Whether objects lie on the surface where there is no background yet of the camera's place."""

from camera_to_base.trust.correction.seen_background import SeenBackground
import cv2
import numpy as np

# Pictures are compared at this width: finer details are of the texture. Light changes over the
# second length, and an object is as long as the third at least, in px of that width.
_WIDTH, _SHADE_PX, _LEAST_LENGTH_PX = 160, 16.0, 3
# By how much an object is lighter or darker than the surface, as the logarithm of a factor.
_LEAST_CONTRAST = 0.12
# Grey levels; noise counts less in the dark.
_BLACK = 8.0


def is_clear(frame: np.ndarray, background: SeenBackground) -> bool:
    """
    Return whether a frame shows nothing that the background of another place does not show.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param background: Moved to where the camera stands now.
    """
    ratio = np.log((_small(frame) + _BLACK) / (_small(background.picture) + _BLACK))
    shade = cv2.GaussianBlur(ratio, (0, 0), _SHADE_PX)
    differs = (np.abs(ratio - shade) > _LEAST_CONTRAST).any(axis=2).astype(np.uint8)
    if background.unknown is not None:
        differs[_small(background.unknown) > 0] = 0
    return not cv2.erode(differs, np.ones((_LEAST_LENGTH_PX, _LEAST_LENGTH_PX), np.uint8)).any()


def _small(picture: np.ndarray) -> np.ndarray:
    height, width = picture.shape[:2]
    return cv2.resize(picture, (_WIDTH, max(round(_WIDTH * height / width), 1)),
                      interpolation=cv2.INTER_AREA).astype(np.float32)
