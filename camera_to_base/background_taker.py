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

"""Takes the background: the surface without an object, as the median of some frames."""

from typing import List, Optional

import numpy as np


class BackgroundTaker:
    """
    Gathers frames until there are enough for a background.

    :param count: How many; 1 takes the next frame as it is, as the tutorial does.
    """

    def __init__(self, count: int) -> None:
        self._count = count
        self._frames: List[np.ndarray] = []

    def add(self, frame: np.ndarray) -> Optional[np.ndarray]:
        """
        Add a frame; one of another size starts anew.

        :param frame: Shape (h, w, 3), uint8, BGR.
        :returns: The background, of the same shape, once there are enough frames.
        """
        if self._frames and self._frames[0].shape != frame.shape:
            self._frames.clear()
        self._frames.append(frame)
        if len(self._frames) < self._count:
            return None
        return _median(self._frames)


def _median(frames: List[np.ndarray]) -> np.ndarray:
    if len(frames) == 1:
        return frames[0]
    # Row by row: a whole stack of many large frames sorted at once would not fit into memory.
    rows = [np.median([frame[row] for frame in frames], axis=0) for row in range(len(frames[0]))]
    return np.rint(rows).astype(np.uint8)
