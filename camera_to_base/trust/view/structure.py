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

"""How much of the surface's structure some of its patches are."""

import cv2
import numpy as np

# Patches tell a number of the similarity that they give to this many px.
_TOLD_PX = 0.2


class Structure:
    """
    What patches of the surface tell of the camera's motion.

    :param total: Their information on its numbers, shape (n, n), in 1/px².

    `told` are the directions that they tell, shape (n, m), orthogonal, one in each column.
    """

    def __init__(self, total: np.ndarray) -> None:
        values, vectors = np.linalg.eigh(total)
        is_told = values > _TOLD_PX ** -2
        self.told = vectors[:, is_told]
        # Of this the whole structure is the unit matrix.
        self._whitening = (self.told / np.sqrt(values[is_told])).T

    @property
    def tells_all(self) -> bool:
        """Whether the surface tells every shift, rotation and scale."""
        return self.told.shape[1] == len(self.told)

    def share(self, total: np.ndarray) -> float:
        """
        Tell how much of it some patches are, 0..1: of what tells the least certain direction.

        :param total: Their information, shape (n, n), in 1/px².
        """
        part = self._whitening @ total @ self._whitening.T
        return max(0.0, float(cv2.eigen(part)[1][-1, 0]))
