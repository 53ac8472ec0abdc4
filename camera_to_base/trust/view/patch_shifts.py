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

"""How far the patches of a background have shifted in a frame, and how well that is known."""

from typing import NamedTuple, Optional

import numpy as np

# In a darker frame the same noise is more of a shift.
_DARKEST_GAIN = 0.1


class PatchShifts(NamedTuple):
    """
    How the patches look in a frame.

    :param shifts: Shape (n, 2), along u and v in px.
    :param is_seen: Shape (n,), whether a patch looks like the background's at all.
    :param residuals: Shape (n,), mean square of what the model does not explain, in levels²; None
        where it was not asked.
    :param gain: How much brighter the frame is, by the median of the patches that are seen.
    :param surplus: How many times the noise that is known the model leaves unexplained, by the
        median of the patches.
    :param worth: Shape (2, n), how much of a patch's information along each of its axes counts,
        0..1; None for all of it.
    """

    shifts: np.ndarray
    is_seen: np.ndarray
    residuals: Optional[np.ndarray]
    gain: float
    surplus: float
    worth: Optional[np.ndarray] = None

    @property
    def precision(self) -> float:
        """Factor for the information of the shifts, below 1 in a dark frame."""
        return min(max(self.gain, _DARKEST_GAIN), 1.0) ** 2
