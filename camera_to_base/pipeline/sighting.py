# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What a frame shows and why it may not be published, and the limits that decide it."""

from collections import Counter
import time
from typing import Callable, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.detection import LeftOut, LocatedObject, read_polygons
from camera_to_base.errors import CameraToBaseError, FrameSizeError, Level, Reason
from camera_to_base.parameters import default_values, ParameterSpec, Values

LIMIT_SPECS = [
    ParameterSpec(
        'max_frame_age', 0.3,
        'Frames of a camera that are older than this give no positions.',
        (0.01, 60), unit='s'),
    ParameterSpec(
        'confirm_jump_px', 8.0,
        'A position that jumps farther than this is published when a second frame confirms it; 0 '
        'for no check. Cameras only.', (0, 100000), unit='px'),
    ParameterSpec(
        'view.max_shift_px', 3.0,
        'Nothing is published while the view has moved by more than this since the background '
        'was taken; 0 for no check.', (0, 100000), unit='px'),
    ParameterSpec(
        'view.max_changed_share', 0.7,
        'Nothing is published while more than this share of the structure of the surface is '
        'covered or has changed.',
        (0, 1)),
    ParameterSpec(
        'view.correct_up_to_px', 20.0,
        'A movement of the view of up to this many px, at the farthest corner of the picture, is '
        'measured on the structure of the surface, and positions are corrected; 0 for never.',
        (0, 1000), unit='px'),
    ParameterSpec(
        'view.correct_error_mm', 1.0,
        'Nothing is corrected, and nothing published, if one of a hundred positions would be off '
        'by more than this after the correction.', (0.01, 1000), unit='mm'),
    ParameterSpec(
        'view.fixed_areas', '',
        'What stands still with the robot (its foot, a bracket), on the picture: where it has not '
        'moved but the rest has, the table was pushed, and nothing is corrected or published. In '
        'px, corners with , between them, polygons with ; between them.',
        constraints="such as '0 0, 80 0, 80 60'"),
]
_DEFAULTS = default_values(LIMIT_SPECS)

# Shorter interruptions are not reported: the next frame may be good.
_LASTING_S = 1.0


class Limits(NamedTuple):
    """Limits of frames, positions and the view, see the node's parameters."""

    max_frame_age_s: float = _DEFAULTS['max_frame_age']
    confirm_jump_px: float = _DEFAULTS['confirm_jump_px']
    max_shift_px: float = _DEFAULTS['view.max_shift_px']
    max_changed_share: float = _DEFAULTS['view.max_changed_share']
    correct_up_to_px: float = _DEFAULTS['view.correct_up_to_px']
    correct_error_mm: float = _DEFAULTS['view.correct_error_mm']
    fixed_areas: str = _DEFAULTS['view.fixed_areas']

    @property
    def may_correct(self) -> bool:
        """Whether a movement of the view is corrected: where it is checked at all."""
        return self.max_shift_px > 0 and self.correct_up_to_px > 0


def make_limits(values: Values) -> Limits:
    """
    Make the limits from their parameters.

    :param values: By full name, as the specs allow them.
    :raises InvalidValueError: If `view.fixed_areas` are no polygons.
    """
    read_polygons('view.fixed_areas', values['view.fixed_areas'])
    return Limits(*(values[spec.name] for spec in LIMIT_SPECS))


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
    """
    Counts frames: all of them, those with an object, and those held back by their reason.

    What was left out is counted by its reason, too, each thing on each frame.
    """

    def add(self, sighting: Sighting) -> None:
        """Count a frame."""
        self['frames'] += 1
        if sighting.objects:
            self['frames with an object'] += 1
        if sighting.reason is not None:
            self[f'frames held back: {sighting.reason.kind}'] += 1
        self.update(f'left out: {one.reason.kind}' for one in sighting.left_out)


class HeldBack:
    """
    Records why a frame's positions were not published.

    `reason` is the reason to show. A passing reason is shown when a frame is held back a second
    after the first: a slow camera's next frame may be good. If passing reasons alternate, the one
    that is shown stays until it has not occurred for a second.
    """

    def __init__(self) -> None:
        self.reason: Optional[Reason] = None
        self._since: Optional[float] = None
        self._shown_at = 0.0

    def note(self, reason: Optional[Reason]) -> None:
        """Record a frame's reason; None if its positions were published."""
        now = time.monotonic()
        if reason is None:
            self.reason = self._since = None
        elif not reason.is_passing:
            self.reason, self._since = reason, None
        else:
            self._note_passing(reason, now)

    def _note_passing(self, reason: Reason, now: float) -> None:
        if self._since is None:
            self.reason, self._since = None, now
        if now - self._since < _LASTING_S:
            return
        if (self.reason is None or reason.kind == self.reason.kind
                or now - self._shown_at >= _LASTING_S):
            self.reason, self._shown_at = reason, now
