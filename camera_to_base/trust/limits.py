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

"""Limits of frames, positions and the view: the parameters, and their frozen values."""

from typing import NamedTuple

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
]
_DEFAULTS = default_values(LIMIT_SPECS)


class Limits(NamedTuple):
    """Limits of frames, positions and the view, see the node's parameters."""

    max_frame_age_s: float = _DEFAULTS['max_frame_age']
    confirm_jump_px: float = _DEFAULTS['confirm_jump_px']
    max_shift_px: float = _DEFAULTS['view.max_shift_px']
    max_changed_share: float = _DEFAULTS['view.max_changed_share']
    correct_up_to_px: float = _DEFAULTS['view.correct_up_to_px']
    correct_error_mm: float = _DEFAULTS['view.correct_error_mm']

    @property
    def may_correct(self) -> bool:
        """Whether a movement of the view is corrected: where it is checked at all."""
        return self.max_shift_px > 0 and self.correct_up_to_px > 0

    @property
    def for_recording(self) -> 'Limits':
        """The same without limits of the view: no arm follows the positions of a recording."""
        return self._replace(max_shift_px=0.0)


def make_limits(values: Values) -> Limits:
    """
    Make the limits from their parameters.

    :param values: By full name, as the specs allow them.
    """
    return Limits(*(values[spec.name] for spec in LIMIT_SPECS))
