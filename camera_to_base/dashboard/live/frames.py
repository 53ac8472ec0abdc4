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

"""The newest frames of a cell, put together from the messages on several topics."""

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Any, List, Optional, Tuple

from camera_to_base.coordinate_transform import Pose
from camera_to_base.ros import UncertainPose

# As many frames are kept while their messages arrive one after the other.
_MOST_FRAMES = 30
# If no base positions came for so many frames, the camera positions are shown alone.
_LONGEST_WAIT_FRAMES = 10

Stamp = Tuple[int, int]


@dataclass
class LeftOutPlace:
    """Something that was left out: where, in cm in the camera frame, and why."""

    kind: str
    sentence: str
    x: float
    y: float


@dataclass
class SeenFrame:
    """
    What came about one frame; None for what has not come.

    :param stamp_s: When it was taken.
    :param latency_s: The time from then until its objects came.
    """

    camera: Optional[List[Pose]] = None
    base: Optional[List[Pose]] = None
    camera_ellipses: List[UncertainPose] = field(default_factory=list)
    base_ellipses: List[UncertainPose] = field(default_factory=list)
    left_out: List[LeftOutPlace] = field(default_factory=list)
    stamp_s: float = 0.0
    latency_s: float = 0.0


class SeenFrames:
    """Keeps the newest frames by their stamps."""

    def __init__(self) -> None:
        self._frames: 'OrderedDict[Stamp, SeenFrame]' = OrderedDict()

    def at(self, stamp: Any) -> SeenFrame:
        """Return the frame with a stamp; a new one if none has it."""
        key = stamp.sec, stamp.nanosec
        if key not in self._frames:
            self._frames[key] = SeenFrame(stamp_s=stamp.sec + stamp.nanosec / 1e9)
            while len(self._frames) > _MOST_FRAMES:
                self._frames.popitem(last=False)
        return self._frames[key]

    @property
    def newest(self) -> Optional[SeenFrame]:
        """
        The newest frame with base positions; the newest one at all if these do not come.

        Base positions come some milliseconds after the camera positions.
        """
        seen = [frame for frame in reversed(self._frames.values()) if frame.camera is not None]
        whole = (frame for frame in seen[:_LONGEST_WAIT_FRAMES] if frame.base is not None)
        return next(whole, seen[0] if seen else None)
