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

"""The view's term: by how much the camera looks elsewhere than when the background was taken."""

# The mean is taken over about so many frames.
_FRAMES = 30.0


class ShiftMean:
    """
    The mean square of the shifts that were measured and not corrected, over the last frames.

    The shift of a single frame says how far the picture has moved, not where to; a mean over
    frames says how large such shifts are.
    """

    def __init__(self) -> None:
        self._square = 0.0
        self._count = 0.0

    @property
    def deviation_px(self) -> float:
        """Standard deviation of each of u and v, in px; 0 before the first frame."""
        return (self._square / 2) ** 0.5

    def add(self, shift_px: float) -> None:
        """Add a frame's shift, in px."""
        self._count = min(self._count + 1, _FRAMES)
        self._square += (shift_px ** 2 - self._square) / self._count
