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

"""Holds a position back that jumps until a second frame agrees with it."""

from collections import deque

from camera_to_base.detection import Pixel


class JumpFilter:
    """
    Accepts a position that continues those before it.

    A damaged frame may show the object in a wrong place, but two of them do not agree. A position
    is accepted near the last one that was accepted, near the last one that was seen, or where the
    last two lead to: an object at any speed is held back for two frames at most.

    :param radius_px: How far counts as near, in px; 0 accepts everything.
    """

    def __init__(self, radius_px: float) -> None:
        self._radius_px = radius_px
        self._seen = deque(maxlen=2)
        self._accepted = None

    def accepts(self, pixel: Pixel) -> bool:
        """Tell whether a frame's position can be believed."""
        expected = [self._accepted, *list(self._seen)[-1:]]
        if len(self._seen) == 2:
            (u1, v1), (u2, v2) = self._seen
            expected.append(Pixel(2 * u2 - u1, 2 * v2 - v1))
        self._seen.append(pixel)
        near = not self._radius_px or any(
            self._is_near(pixel, other) for other in expected if other is not None)
        if near:
            self._accepted = pixel
        return near

    def _is_near(self, pixel: Pixel, other: Pixel) -> bool:
        return max(abs(pixel[0] - other[0]), abs(pixel[1] - other[1])) <= self._radius_px
