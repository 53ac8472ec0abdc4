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

"""Whether a surface looks the same at another place: a pattern that repeats itself."""

import cv2
import numpy as np

# Shifts within this many px are looked at, in a picture that is made this long at most.
_REACH_PX, _LONGEST = 48, 480
# Another place looks the same where the pictures correlate there by this share of what they do in
# the place that was found.
_SAME_SHARE = 0.8


def is_repeated(here: np.ndarray, there: np.ndarray) -> bool:
    """
    Tell whether a picture agrees with another one at more than one shift.

    :param here: Shape (h, w), uint8, an even picture, see `corners`.
    :param there: Of the same shape; it shows the same, not shifted.
    """
    scale = min(1.0, _LONGEST / max(here.shape))
    small, other = (cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
                    .astype(np.float32) - 128 for picture in (here, there))
    reach = min(_REACH_PX, (min(small.shape) - 2) // 4)
    if reach < 2:
        return False
    inner = np.ascontiguousarray(small[reach:-reach, reach:-reach])
    likeness = cv2.matchTemplate(other, inner, cv2.TM_CCOEFF_NORMED)
    limit = _SAME_SHARE * likeness[reach, reach]
    count, labels = cv2.connectedComponents((likeness > limit).astype(np.uint8))
    return count != 2 or labels[reach, reach] == 0
