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

"""What a look at some patches of a frame tells of the view."""

from typing import NamedTuple, Optional

import numpy as np


class ViewLook(NamedTuple):
    """
    What the cheap look tells of a frame.

    :param share: How much of the structure agrees on a motion: of that which tells the least
        certain direction, 0..1.
    :param shift_px: How far the picture's centre or a corner has moved, the farthest of them.
    :param matrix: Shape (2, 3), maps the background's pixels to the frame's; (3, 3) with a tilt.
    :param patch_share: How many of the patches agree, 0..1.
    :param surplus: How many times the known noise is left unexplained, see `PatchShifts`.

    A glance gives neither matrix nor patch share: it tells that the camera stands still.
    """

    share: float
    shift_px: float
    surplus: float
    matrix: Optional[np.ndarray] = None
    patch_share: Optional[float] = None
