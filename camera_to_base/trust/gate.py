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

"""Decides what of a frame may be published."""

import time
from typing import List, NamedTuple, Optional

from camera_to_base.detection import LocatedObject
from camera_to_base.trust.jump_filter import JumpFilter

# Why a frame may not be published.
UNCONFIRMED = 'not confirmed by a second frame'
TOO_LATE = 'detection took too long'


class Sighting(NamedTuple):
    """
    What a frame shows.

    :param objects: The largest first; none where the surface is empty.
    :param held_back: Why none of this may be published, not even that there is nothing; None
        where an arm may follow it.
    :param beyond_horizon: Where something is seen, but all of it beyond the horizon, so that the
        surface is empty. Whoever always sees this has tilted the camera too far.
    """

    objects: List[LocatedObject]
    held_back: Optional[str] = None
    beyond_horizon: Optional[str] = None


class PositionGate:
    """
    Lets through what an arm may follow.

    :param max_age_s: The oldest frame of a live camera that a position may come from.
    :param jump_radius_px: See :class:`JumpFilter`.
    """

    def __init__(self, max_age_s: float, jump_radius_px: float) -> None:
        self.view_problem: Optional[str] = None
        self.configure(max_age_s, jump_radius_px)

    def configure(self, max_age_s: float, jump_radius_px: float) -> None:
        """Use other limits from now on."""
        self._max_age_s = max_age_s
        self._jumps = JumpFilter(jump_radius_px)

    def judge(self, objects: List[LocatedObject], taken_at: Optional[float]) -> Sighting:
        """
        Tell which objects of a frame may be published.

        Where the largest one is not confirmed none is; another is left out until it is.

        :param objects: The largest first.
        :param taken_at: When the frame was taken, by time.monotonic(); None where a frame waits
            for its reader, as those of a file do: it is never too old, and nothing damages it.
        """
        believed = objects if taken_at is None else self._believed(objects)
        if self.view_problem is not None:
            return Sighting(objects, 'the view has moved')
        if believed is None:
            return Sighting(objects, UNCONFIRMED)
        if taken_at is not None and time.monotonic() - taken_at > self._max_age_s:
            return Sighting(objects, TOO_LATE)
        return Sighting(believed)

    def _believed(self, objects: List[LocatedObject]) -> Optional[List[LocatedObject]]:
        pixels = [found.detection.centre for found in objects]
        believed = self._jumps.believed(pixels)
        confirmed = pixels[0] in believed if pixels else self._jumps.believes_empty()
        return [found for found, pixel in zip(objects, pixels)
                if pixel in believed] if confirmed else None
