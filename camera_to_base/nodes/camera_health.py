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

"""The numbers that the diagnostics show about a camera."""

import time
from typing import Dict, Optional

from camera_to_base.sources import ReaderStatus
from camera_to_base.trust import CameraPipeline, Correction, View


class DetectionRate:
    """Rates of processed frames and of frames with an object, between two calls."""

    def __init__(self) -> None:
        self._looked_at, self._frames, self._with_object = time.monotonic(), 0, 0

    def values(self, pipeline: CameraPipeline) -> Dict[str, str]:
        """Return both rates since the last call, as text for the diagnostics."""
        now, counts = time.monotonic(), pipeline.counts
        seconds = max(now - self._looked_at, 1e-3)
        frames, with_object = counts['frames'], counts['frames with an object']
        values = {'detection rate (frames/s)': f'{(frames - self._frames) / seconds:.1f}',
                  'frames with an object (1/s)':
                      f'{(with_object - self._with_object) / seconds:.1f}'}
        self._looked_at, self._frames, self._with_object = now, frames, with_object
        return values


def blind_spot(view: Optional[View]) -> Optional[str]:
    """Tell which movements of the camera cannot be noticed, a sentence; None for none."""
    if _has_no_structure(view):
        return ('the view cannot be checked: the surface has no structure, so that nobody would '
                'notice a nudge; put marks into its corners')
    if view is not None and not view.tells_all:
        return ('some movements of the camera cannot be noticed: the surface shows little but '
                'straight lines, and none of them tells a movement along it; put marks into its '
                'corners')
    return None


def _has_no_structure(view: Optional[View]) -> bool:
    return view is not None and view.shift_px is None and not view.has_structure


def _shift_text(view: Optional[View]) -> str:
    if view is None:
        return 'not checked'
    if _has_no_structure(view):
        return 'cannot be checked, the surface has no structure'
    text = 'cannot be told' if view.shift_px is None else f'{view.shift_px:.1f}'
    return text if view.tells_all else f'{text}, without movements along the lines of the surface'


def _correction_text(correction: Optional[Correction]) -> str:
    if correction is None:
        return 'not corrected'
    return (f'{correction.shift_px:.1f} px, {correction.shift_mm:.1f} mm, to about '
            f'{correction.error_mm:.2f} mm')


def camera_values(reader: Optional[ReaderStatus], pipeline: CameraPipeline) -> Dict[str, str]:
    """Return all numbers about a camera, as text for the diagnostics."""
    values = {'background': _background_text(pipeline),
              'view shift (px)': _shift_text(pipeline.view),
              'view corrected by': _correction_text(pipeline.standpoint.correction)}
    values.update((name, str(number)) for name, number in sorted(pipeline.counts.items()))
    if reader is not None:
        status = reader.snapshot()
        counts = status.counts
        values.update({
            'state': status.state.value,
            'frames read': str(counts.read),
            'frames dropped: replaced by a newer one': str(counts.overwritten),
            'frames dropped: too old on arrival': str(counts.old),
            'frames dropped: damaged': str(counts.damaged),
            'reconnects': str(counts.reconnects),
            'attempts to open': str(counts.attempts),
            'age of the last frame (s)': f'{status.seconds_without_frame:.2f}'})
    return values


def _background_text(pipeline: CameraPipeline) -> str:
    if pipeline.background is None:
        return 'none'
    origin = 'from the file, ' if pipeline.backgrounds.current.is_restored else ''
    return '{1} x {0} px, '.format(*pipeline.background.shape) + (
        f'{origin}taken {pipeline.backgrounds.current.age_s:.0f} s ago')
