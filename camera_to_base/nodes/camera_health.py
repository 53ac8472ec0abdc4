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

"""What a user should know about a camera: a level, a sentence that says what to do, numbers."""

import time
from typing import Dict, NamedTuple, Optional

from camera_to_base.errors import TopicTypeError
from camera_to_base.ros import Level
from camera_to_base.sources import ReaderState, ReaderStatus
from camera_to_base.trust import BLACK, CameraPipeline, REPEATED, TOO_LATE, UNCONFIRMED, View

# A camera that gives damaged frames only is said to do so after this many.
_DAMAGED_IN_A_ROW = 10
# A stream that was just opened, or had stalled, gives old frames for a second or two.
_OLD_FOR_S = 4.0
# What to do where the reason itself does not say so.
_CABLE = 'check its cable and its network, or lower its rate'
_DAMAGE_CURES = {
    BLACK: 'switch the light on, and uncover the lens',
    REPEATED: "restart the camera or its driver; a simulation's driver wants use_sim_time:=true"}
_CURES = {
    TOO_LATE: ': use smaller pictures or a faster computer, or raise max_frame_age',
    UNCONFIRMED: ": keep hands away, or raise the detector's threshold"}


class Problem(NamedTuple):
    """Why nothing is published: its kind stays while numbers in the sentence change."""

    kind: str
    level: Level
    sentence: str


def camera_problem(
    reader: Optional[ReaderStatus], pipeline: CameraPipeline, name: str
) -> Optional[Problem]:
    """
    Tell what keeps positions from being published.

    :param reader: None for a source that is no camera.
    :param name: The source's, or its topic's.
    :returns: None where an object on the surface would be published.
    """
    if reader is not None and reader.state is not ReaderState.RUNNING:
        return _reader_problem(reader, name)
    if reader is not None and reader.damaged_in_a_row >= _DAMAGED_IN_A_ROW:
        return Problem('damaged', Level.ERROR, (
            f"no picture of camera '{name}' can be used, {reader.last_damage}: "
            f'{_DAMAGE_CURES.get(reader.last_damage, _CABLE)}'))
    if reader is not None and reader.seconds_of_old_frames >= _OLD_FOR_S:
        return Problem('old', Level.ERROR, (
            f"camera '{name}' gives more frames than can be read, so that they are old when they "
            'come: lower its rate or its picture size'))
    if pipeline.background is None:
        reason = pipeline.background_problem or 'keep the surface clear'
        return Problem(f'background: {reason}', Level.WARN, f'taking the background: {reason}')
    if pipeline.size_problem is not None:
        return Problem('size', Level.ERROR, pipeline.size_problem)
    if pipeline.view_problem is not None:
        return Problem('view', Level.ERROR, pipeline.view_problem)
    reason = pipeline.held_back.reason
    if reason is not None:
        return Problem('held back', Level.WARN, (
            f'no position is published: {reason}{_CURES.get(reason, "")}'))
    return None


def _reader_problem(reader: ReaderStatus, name: str) -> Problem:
    cause = reader.error or f"camera '{name}' gives no frame: is it switched on, and reachable?"
    if reader.error is None and reader.seconds_without_frame < reader.longest_silence_s:
        return Problem('opening', Level.WARN, f"waiting for the first frame of '{name}'")
    if isinstance(cause, TopicTypeError):
        return Problem('topic type', Level.ERROR, f'nothing is published: {cause}')
    if reader.state is ReaderState.WAITING:
        return Problem('waiting', Level.ERROR, f'waiting for the camera: {cause}')
    return Problem('lost', Level.ERROR, f'nothing is published: {cause}')


class DetectionRate:
    """How many frames go through detection, and show an object, between one look and the next."""

    def __init__(self) -> None:
        self._looked_at, self._frames, self._with_object = time.monotonic(), 0, 0

    def values(self, pipeline: CameraPipeline) -> Dict[str, str]:
        """Give both rates since the last look, as texts for the diagnostics."""
        now, counts = time.monotonic(), pipeline.counts
        seconds = max(now - self._looked_at, 1e-3)
        frames, with_object = counts['frames'], counts['frames with an object']
        values = {'detection rate (frames/s)': f'{(frames - self._frames) / seconds:.1f}',
                  'frames with an object (1/s)':
                      f'{(with_object - self._with_object) / seconds:.1f}'}
        self._looked_at, self._frames, self._with_object = now, frames, with_object
        return values


def has_no_structure(view: Optional[View]) -> bool:
    """Tell whether a surface shows nothing by which a nudge of the camera could be seen."""
    return view is not None and view.shift_px is None and not view.has_structure


def _shift_text(view: Optional[View]) -> str:
    if view is None:
        return 'not checked'
    if has_no_structure(view):
        return 'cannot be checked, the surface has no structure'
    return 'cannot be told' if view.shift_px is None else f'{view.shift_px:.1f}'


def camera_values(reader: Optional[ReaderStatus], pipeline: CameraPipeline) -> Dict[str, str]:
    """Give all numbers about a camera, as texts for the diagnostics."""
    values = {'background': _background_text(pipeline),
              'view shift (px)': _shift_text(pipeline.view)}
    values.update((name, str(number)) for name, number in sorted(pipeline.counts.items()))
    if reader is not None:
        counts = reader.counts
        values.update({
            'state': reader.state.value,
            'frames read': str(counts.read),
            'frames dropped: replaced by a newer one': str(counts.overwritten),
            'frames dropped: too old on arrival': str(counts.old),
            'frames dropped: damaged': str(counts.damaged),
            'reconnects': str(counts.reconnects),
            'attempts to open': str(counts.attempts),
            'age of the last frame (s)': f'{reader.seconds_without_frame:.2f}'})
    return values


def _background_text(pipeline: CameraPipeline) -> str:
    if pipeline.background is None:
        return 'none'
    origin = 'from the file, ' if pipeline.background_is_restored else ''
    return '{1} x {0} px, '.format(*pipeline.background.shape) + (
        f'{origin}taken {pipeline.background_age_s:.0f} s ago')
