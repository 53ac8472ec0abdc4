# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What a frame's checks have in common: a stage takes the frame's record and returns it."""

from typing import NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection import LeftOut, LocatedObject
from camera_to_base.errors import Reason
from camera_to_base.pipeline.sighting import Sighting
from camera_to_base.pipeline.standpoint import Standpoint
from camera_to_base.pipeline.view.view_watch import FrameMotion
import numpy as np


class FrameRecord(NamedTuple):
    """
    What is known of a frame. Each stage returns it with what the stage has found.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param standpoint: Where the camera stands.
    :param taken_at: Its capture time by time.monotonic(); None for now.
    :param now: The same, in s; None for a recording, of which each frame stands for itself.
    :param motion: How its view has moved since the background was taken.
    :param aligned: The frame as the camera would see it without that motion, of the same shape;
        None before the detection.
    :param objects: The largest first.
    :param left_out: What was detected, but is not among the objects, each with its reason.
    :param reason: Why nothing of it may be published; None while nothing is known against it.
    :param retaken: From so many of the next frames a new background is to be taken.
    """

    frame: np.ndarray
    standpoint: Standpoint
    taken_at: Optional[float] = None
    now: Optional[float] = None
    motion: FrameMotion = FrameMotion()
    aligned: Optional[np.ndarray] = None
    objects: Sequence[LocatedObject] = ()
    left_out: Tuple[LeftOut, ...] = ()
    reason: Optional[Reason] = None
    retaken: int = 0

    @property
    def sighting(self) -> Sighting:
        """What it shows, for others."""
        return Sighting(self.objects, self.reason, self.left_out)

    def held(self, reason: Reason) -> 'FrameRecord':
        """Hold the frame back: nothing of it may be published; its objects are left out."""
        return self.without([reason] * len(self.objects))._replace(reason=reason)

    def without(self, reasons: Sequence[Optional[Reason]]) -> 'FrameRecord':
        """
        Leave objects out.

        :param reasons: Why, in the order of the objects; None for one that stays.
        """
        pairs = list(zip(self.objects, reasons))
        left_out = (LeftOut(one.detection, reason, one.point)
                    for one, reason in pairs if reason is not None)
        return self._replace(objects=[one for one, reason in pairs if reason is None],
                             left_out=(*self.left_out, *left_out))


class Stage:
    """
    A check that each frame passes.

    `sees_held_back` tells whether it also judges frames that an earlier stage has held back. All
    others are left out for such a frame.
    """

    sees_held_back = False

    def judge(self, record: FrameRecord) -> FrameRecord:
        """
        Judge a frame.

        :returns: The record with what the stage has found.
        :raises CameraToBaseError: If the frame cannot be used.
        """
        raise NotImplementedError
