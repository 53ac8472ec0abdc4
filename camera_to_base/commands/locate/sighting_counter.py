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

"""Runs the camera's pipeline on a recording, and counts the results."""

from collections import Counter
from typing import Dict, List, Optional

from camera_to_base.errors import CameraToBaseError
from camera_to_base.reason import Level, Reason
from camera_to_base.settings import CameraSettings
from camera_to_base.sources import SourceKind, TimedFrame, VIDEO_FILE
from camera_to_base.trust import DamageCheck, FrameUncertainty, Sighting
import numpy as np

# Kinds of reasons that do not depend on the detector's settings.
_UNUSABLE = {'damaged', 'frame_size', 'frame_unusable', 'beyond_horizon'}


class SightingCounter:
    """
    The camera node's pipeline, with counts of its results.

    :param settings: The camera node's settings.
    :param kind: The kind of source.
    :param source: The source's name; '' if it is not known.
    :param damage: Finds damaged frames; None for a recording.
    """

    def __init__(
        self, settings: CameraSettings, kind: SourceKind = VIDEO_FILE, source: str = '',
        damage: Optional[DamageCheck] = None,
    ) -> None:
        self._pipeline = settings.pipeline(source, kind, damage=damage)
        self._uncertainty = settings.uncertainty
        self.frames = self._with_one = self._with_more = 0
        self._counts: Counter = Counter()
        self._first: Dict[str, Reason] = {}
        self._doubts: Dict[str, Reason] = {}

    def see(self, timed: TimedFrame) -> Sighting:
        """
        Find the objects on a frame.

        :returns: The objects, and the reason if they would not be published, for example if the
            frame cannot be decoded.
        """
        self.frames += 1
        sighting = self._sighting(timed)
        reason = sighting.warning
        if reason is not None:
            self._counts[reason.kind] += 1
            self._first.setdefault(reason.kind, reason)
        elif len(sighting.objects) == 1:
            self._with_one += 1
        elif sighting.objects:
            self._with_more += 1
        return sighting

    def uncertainty(self, frame: np.ndarray) -> FrameUncertainty:
        """Return the uncertainty of the positions on the last frame."""
        return self._pipeline.frame_uncertainty(frame, self._uncertainty)

    def check_any_used(self) -> None:
        """
        Check that at least one frame could be used.

        :raises CameraToBaseError: If no frame could be used; the message says why.
        """
        unusable = [kind for kind in self._counts if kind in _UNUSABLE]
        refused = sum(self._counts[kind] for kind in unusable)
        background = sum(count for kind, count in self._counts.items()
                         if kind.startswith('background_'))
        if self.frames and refused >= max(self.frames - background - 1, 1):
            raise CameraToBaseError(
                f'no frame could be used: {self._first[unusable[0]].sentence}')

    def summary(self) -> List[str]:
        """Return the counts as lines of text."""
        lines = [f'{self.frames} frames: {self._with_one + self._with_more} with an object '
                 f'({self._with_one} with one, {self._with_more} with more)']
        lines += [
            f'frames held back: {count} ({kind}, the first: {self._first[kind].sentence})'
            for kind, count in self._counts.most_common()]
        return lines + [f'warning: {doubt.sentence}' for doubt in self._doubts.values()]

    def _sighting(self, timed: TimedFrame) -> Sighting:
        try:
            frame = timed.frame
        except CameraToBaseError as error:
            return Sighting([], Reason('damaged', Level.ERROR, str(error)))
        sighting = self._pipeline.process(frame, timed.taken_at)
        doubt = self._pipeline.doubt
        if doubt is not None and sighting.reason is None:
            self._doubts.setdefault(doubt.kind, doubt)
        return sighting
