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

"""Derives from a camera's status why no good frame arrives."""

from typing import Optional

from camera_to_base.errors import TopicTypeError
from camera_to_base.reason import Level, Reason
from camera_to_base.sources.live.reader_status import (
    ReaderSnapshot, ReaderState, ReaderStatus)
from camera_to_base.sources.live.stamp_check import STAMP_KINDS

# A camera is reported after this many damaged frames in a row.
_DAMAGED_IN_A_ROW = 10
# A single late picture does not mean that the clocks differ.
_STAMPS_IN_A_ROW = 3
# After opening or a stall, a stream gives old frames for a second or two.
_OLD_FOR_S = 4.0


def source_reason(status: ReaderStatus, name: str) -> Optional[Reason]:
    """
    Return why a source gives no good frame.

    :param name: The name of the source, or of its topic.
    :returns: None while good frames arrive.
    """
    seen = status.snapshot()
    if seen.state is not ReaderState.RUNNING:
        return _silence(seen, name)
    damage = seen.last_damage
    if seen.damaged_in_a_row >= _STAMPS_IN_A_ROW and damage.kind in STAMP_KINDS:
        return Reason(damage.kind, Level.ERROR, f"nothing of '{name}' is used: {damage.sentence}")
    if seen.damaged_in_a_row >= _DAMAGED_IN_A_ROW:
        return Reason('damaged', Level.ERROR, (
            f"no picture of camera '{name}' can be used, {damage.sentence}"))
    if seen.seconds_of_old_frames >= _OLD_FOR_S:
        return Reason('old_frames', Level.ERROR, (
            f"camera '{name}' gives more frames than can be read, so that they are old when they "
            'come: lower its rate or its picture size'))
    return None


def _silence(seen: ReaderSnapshot, name: str) -> Reason:
    error = seen.error
    cause = error or f"camera '{name}' gives no frame: is it switched on, and reachable?"
    if error is None and seen.seconds_without_frame < seen.longest_silence_s:
        return Reason('camera_opening', Level.WARN, f"waiting for the first frame of '{name}'")
    if isinstance(cause, TopicTypeError):
        return Reason('topic_type', Level.ERROR, f'nothing is published: {cause}')
    if seen.state is ReaderState.WAITING:
        return Reason('camera_waiting', Level.ERROR, f'waiting for the camera: {cause}')
    return Reason('camera_lost', Level.ERROR, f'nothing is published: {cause}')
