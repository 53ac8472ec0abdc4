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

"""What a frame shows, and why it may not be published where it may not."""

from collections import Counter
from typing import Callable, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection import LeftOut, LocatedObject
from camera_to_base.errors import CameraToBaseError, FrameSizeError
from camera_to_base.reason import Level, Reason


class Sighting(NamedTuple):
    """
    What a frame shows.

    :param objects: The largest first; none where the surface is empty.
    :param reason: Why none of this may be published, not even that there is nothing; None where
        an arm may follow it.
    :param left_out: What was detected, but is not among the objects, each with its reason.
    """

    objects: Sequence[LocatedObject]
    reason: Optional[Reason] = None
    left_out: Tuple[LeftOut, ...] = ()

    @property
    def warning(self) -> Optional[Reason]:
        """
        Why no position comes of the frame: its reason, or why its only objects were left out.

        None where an object is published, and where nothing worth a warning was seen.
        """
        if self.reason is not None or self.objects:
            return self.reason
        reasons = (left_out.reason for left_out in self.left_out)
        return next((reason for reason in reasons if reason.level > Level.OK), None)

    def told(self, write: Callable[[str], str]) -> 'Sighting':
        """Return it with the sentences of its reasons rewritten for those who read them."""
        return self._replace(
            reason=self.reason and self.reason.told(write),
            left_out=tuple(one._replace(reason=one.reason.told(write)) for one in self.left_out))


def unusable_reason(error: CameraToBaseError, may_retake: bool) -> Reason:
    """
    Tell why a frame cannot be used.

    :param may_retake: Whether a new background would cure a wrong size.
    """
    if not isinstance(error, FrameSizeError):
        return Reason('frame_unusable', Level.ERROR, f'no position is published: {error}')
    cure = ', or clear the surface and call ~/capture_background' if may_retake else ''
    return Reason('frame_size', Level.ERROR, f'{error}{cure}')


class FrameCounts(Counter):
    """Counts frames: all of them, those with an object, and those held back by their reason."""

    def add(self, sighting: Sighting) -> None:
        """Count a frame."""
        self['frames'] += 1
        if sighting.objects:
            self['frames with an object'] += 1
        if sighting.reason is not None:
            self[f'frames held back: {sighting.reason.kind}'] += 1
