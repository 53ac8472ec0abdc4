# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
The frames of the cameras: what rests from one frame to the next, and which stamps can be compared.

What rests may be fused of frames of any time, and what moves of frames of one moment. Whether two
frames are of one moment is told by their stamps, and by the clocks that made these.
"""

from collections import deque
from dataclasses import dataclass
from typing import Deque, Dict, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.fusion.shape import COUNT, reach
from camera_to_base.fusion.solver import SeenOutline
import numpy as np

# An outline that has moved by less is at rest: half a pixel and the noise.
REST_CM = 0.1
# What rests is seen within so much of an outline's noise on 99 of 100 pairs of frames.
_NOISES = 2.5
# A frame that is that old is no longer needed to tell what rests.
HISTORY_S = 1.0
# The shortest of so many ways through the network tells how far a clock is off.
_MESSAGES = 30


@dataclass(frozen=True)
class CameraFrame:
    """
    What a camera sees at a time.

    :param stamp_s: When the frame was taken.
    :param seen: The silhouettes.
    :param reaches: How far each reaches in each direction, shape (n, directions), in cm.
    :param squares: The sum of the squares of each, shape (n,), in cm².
    """

    stamp_s: float
    seen: Tuple[SeenOutline, ...]
    reaches: np.ndarray
    squares: np.ndarray

    @classmethod
    def of(cls, stamp_s: float, seen: Sequence[SeenOutline]) -> 'CameraFrame':
        """Make a frame of its silhouettes."""
        reaches = np.array([reach(one.corners) for one in seen]).reshape(len(seen), COUNT)
        return cls(stamp_s, tuple(seen), reaches, np.einsum('ij,ij->i', reaches, reaches))

    def at_rest(self, reached: np.ndarray) -> Optional[int]:
        """Return the number of the silhouette that was there before; None where none is."""
        if not len(self.reaches):
            return None
        # Of what moves as a whole, the reach changes by the move times a cosine.
        squares = self.squares - 2 * (self.reaches @ reached) + reached @ reached
        nearest = int(squares.argmin())
        return nearest if 2 / COUNT * squares[nearest] < REST_CM ** 2 else None

    def is_as_before(self, number: int, reached: np.ndarray) -> bool:
        """Tell whether a silhouette has changed by no more than its noise."""
        apart = self.reaches[number] - reached
        return float(2 / COUNT * apart @ apart) < (_NOISES * self.seen[number].noise_cm) ** 2

    def touching(self, reached: np.ndarray) -> List[int]:
        """List the silhouettes that touch another one."""
        meets = (self.reaches + np.roll(reached, COUNT // 2)).min(axis=1) > 0 if len(
            self.reaches) else np.zeros(0, bool)
        return np.flatnonzero(meets).tolist()


class FrameHistory:
    """The frames of a camera in the last second."""

    def __init__(self) -> None:
        self._frames: List[CameraFrame] = []

    def keep(self, frame: CameraFrame) -> None:
        """Keep a frame, unless it is the last one still."""
        frames = self._frames
        if not frames or frame is not frames[-1]:
            frames.append(frame)
            while frames[0].stamp_s < frame.stamp_s - HISTORY_S and len(frames) > 2:
                frames.pop(0)

    def rested(self, reached: np.ndarray, since_s: float) -> bool:
        """Tell whether a silhouette was there at a time, and since."""
        frames = self._frames
        if frames[0].stamp_s > since_s:
            return False
        first = max(number for number, frame in enumerate(frames) if frame.stamp_s <= since_s)
        return all(frame.at_rest(reached) is not None for frame in frames[first:])


class ClockError(NamedTuple):
    """
    A clock that is off.

    :param camera: The camera's name.
    :param ahead_s: By how much; negative where it is behind.
    """

    camera: str
    ahead_s: float


class ClockCheck:
    """
    Compares when messages were sent, by the sender's clock, with when they came, by this one's.

    A message is on its way for a millisecond or so. If the shortest of many ways took a negative
    time, or far more, it was not the network.
    """

    def __init__(self) -> None:
        self._ways: Dict[str, Deque[float]] = {}

    def note(self, camera: str, sent_s: float, received_s: float) -> None:
        """Note a message."""
        self._ways.setdefault(camera, deque(maxlen=_MESSAGES)).append(received_s - sent_s)

    def error(self, tolerance_s: float) -> Optional[ClockError]:
        """Return the clock that is off most, if it is by more than a tolerance."""
        errors = [ClockError(camera, -min(ways)) for camera, ways in self._ways.items()
                  if len(ways) == _MESSAGES]
        worst = max(errors, key=lambda one: abs(one.ahead_s), default=None)
        return worst if worst is not None and abs(worst.ahead_s) > tolerance_s else None
