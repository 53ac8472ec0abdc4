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

"""Runs the camera's pipeline on a recording, and counts what came of it."""

from collections import Counter
from typing import Dict, List

from camera_to_base.errors import CameraToBaseError, HorizonError
from camera_to_base.settings import CameraSettings
from camera_to_base.sources import TimedFrame
from camera_to_base.trust import CameraPipeline, Sighting


class SightingCounter:
    """
    A pipeline as the camera node has it, and how often it saw what.

    :param settings: The camera node's.
    :param is_live: Whether a camera takes the frames; a recording is shown as it is.
    """

    def __init__(self, settings: CameraSettings, is_live: bool = False) -> None:
        self._pipeline = CameraPipeline(
            settings.surface, settings.detector,
            settings.limits if is_live else settings.limits.for_recording,
            settings.background_frames)
        self._is_live = is_live
        self.frames = self.with_one = self.with_more = 0
        self.held_back: Counter = Counter()
        self.errors: Dict[type, List[str]] = {}

    @property
    def with_any(self) -> int:
        """On how many frames there was an object."""
        return self.with_one + self.with_more

    def see(self, timed: TimedFrame) -> Sighting:
        """
        Find the objects on a frame.

        :returns: The objects, and why they would not be published where they would not; a frame
            that cannot be used is such a reason, too.
        """
        self.frames += 1
        try:
            sighting = self._pipeline.process(
                timed.frame, timed.taken_at if self._is_live else None)
        except CameraToBaseError as error:
            self.errors.setdefault(type(error), []).append(str(error))
            return Sighting([], str(error))
        if sighting.beyond_horizon is not None:
            self.errors.setdefault(HorizonError, []).append(sighting.beyond_horizon)
        elif sighting.held_back is not None:
            self.held_back[sighting.held_back] += 1
        elif len(sighting.objects) == 1:
            self.with_one += 1
        elif sighting.objects:
            self.with_more += 1
        return sighting

    def check_any_used(self) -> None:
        """
        Check that what was seen can tell anything.

        :raises CameraToBaseError: If not a single frame could be used: why.
        """
        refused = [text for texts in self.errors.values() for text in texts]
        background = self.held_back['the background is being taken']
        if self.frames and len(refused) >= max(self.frames - background - 1, 1):
            raise CameraToBaseError(f'no frame could be used: {refused[0]}')

    def summary(self) -> List[str]:
        """Tell in lines what was seen."""
        lines = [f'{self.frames} frames: {self.with_any} with an object ({self.with_one} with '
                 f'one, {self.with_more} with more)']
        lines += [f'frames held back: {count} ({reason})'
                  for reason, count in self.held_back.most_common()]
        return lines + [f'frames left out: {len(texts)} (the first: {texts[0]})'
                        for texts in self.errors.values()]
