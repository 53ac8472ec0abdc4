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

"""One object on the table, followed over several frames."""

from typing import List, Optional, Sequence, Tuple

from camera_to_base.calibration import FRAMES, measured_place, Place
import numpy as np

# How far from the click the object may be, and from where it was seen last.
_REACH_CM = 3.0

Point = Tuple[float, float]


class FollowedObject:
    """
    Collects the positions of the object nearest to a point.

    :param point: x and y, in cm, in the camera frame.
    """

    def __init__(self, point: Point) -> None:
        self._point = point
        self._frames: List[List[Point]] = []

    @property
    def frame_count(self) -> int:
        """Number of frames so far."""
        return len(self._frames)

    @property
    def is_complete(self) -> bool:
        """Whether there are enough frames."""
        return len(self._frames) >= FRAMES

    @property
    def point(self) -> Point:
        """Where it was seen last, or is looked for, in cm."""
        return self._point

    def see(self, points: Sequence[Point]) -> None:
        """Take the objects of the next frame, in cm."""
        nearest = self.nearest(points)
        self._frames.append([] if nearest is None else [nearest])
        if nearest is not None:
            self._point = nearest

    def nearest(self, points: Sequence[Point]) -> Optional[Point]:
        """Return the object's position among those of all; None if it is not there."""
        if not points:
            return None
        away = np.linalg.norm(np.array(points) - self._point, axis=1)
        index = int(np.argmin(away))
        return tuple(points[index]) if away[index] <= _REACH_CM else None

    def place(self) -> Place:
        """
        Return where it rests.

        :raises CalibrationError: If it was not there in all frames, or has moved.
        """
        return measured_place(self._frames)
