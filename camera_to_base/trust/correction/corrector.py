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

"""Decides when a nudge is measured, and whether it is believed."""

from typing import Optional

from camera_to_base.image_size import ImageSize
from camera_to_base.reason import Reason
from camera_to_base.surface import Surface
from camera_to_base.trust.correction.correction import Correction, correction_of
from camera_to_base.trust.correction.nudge_meter import Nudge, NudgeMeter
from camera_to_base.trust.limits import Limits
import numpy as np

# Two frames give the same nudge where no corner of the picture differs by more, in px of a picture
# that is this long, or in standard deviations of the correction.
_SAME_PX, _USUAL_LENGTH, _SAME_DEVIATIONS = 0.3, 960, 1.5
# A smaller nudge than this is none, in px.
_LEAST_NUDGE_PX = 0.5
# A shift that is not held back is measured where it stays above this, in px, for so many frames.
_DRIFT_PX, _DRIFT_FRAMES = 0.8, 4
# Of frames that are not held back so many are measured in a row; from then on two of each so many.
_AT_ONCE, _PERIOD = 8, 8


class Corrector:
    """
    Measures nudges of the camera since the background was taken.

    `correction` is the one that is believed; None for none. `doubt` is why there was none in the
    last frame that was measured. `is_refused` is whether a limit forbade to correct what it gave.

    :param background: Shape (h, w, 3), uint8, BGR.
    :param surface: Maps the background's pixels to the work surface.
    """

    def __init__(self, background: np.ndarray, surface: Surface) -> None:
        self.correction: Optional[Correction] = None
        self.doubt: Optional[str] = None
        self.is_refused = False
        self._background, self._surface = background, surface
        self._size: ImageSize = (background.shape[1], background.shape[0])
        self._meter: Optional[NudgeMeter] = None
        self._last: Optional[Correction] = None
        self._drift_count = self._failures = 0

    def has_changed(self, frame: np.ndarray, limits: Limits, *, is_held_back: bool,
                    shift_px: float) -> bool:
        """
        Measure a frame's nudge: of each frame that is held back, of others where that is due.

        :param frame: Shape (h, w, 3), uint8, BGR, of the background's size.
        :param is_held_back: Whether its view cannot be believed.
        :param shift_px: Its shift since the last correction, as far as that is known.
        :returns: Whether there is another correction now.
        """
        if not self._is_due(is_held_back, shift_px):
            return False
        before, self._last = self._last, self._measured(frame, limits)
        if self._last is None or before is None or not self._is_same(before, self._last):
            return False
        return self._use(self._last)

    def may_correct(self, shift_px: Optional[float], limits: Limits) -> bool:
        """
        Tell whether the next frame may give a correction.

        :param shift_px: How far the view has moved since the background; None for not known.
        """
        return self._last is not None or (
            shift_px is not None and shift_px <= limits.correct_up_to_px)

    def use_surface(self, surface: Surface) -> None:
        """Use another surface from the next measurement on: objects of another height."""
        self._surface = surface

    def forget(self) -> None:
        """Take the camera to stand where it stood for the background."""
        self.correction = self._last = self.doubt = None
        self.is_refused = False
        self._failures = self._drift_count = 0

    def explained(self, reason: Optional[Reason]) -> Optional[Reason]:
        """Add to the reason of a moved view why it is not corrected."""
        if reason is None or reason.kind != 'view_moved' or self.doubt is None:
            return reason
        return reason._replace(sentence=f'{reason.sentence}; it is not corrected: {self.doubt}')

    def _is_due(self, is_held_back: bool, shift_px: float) -> bool:
        is_off = is_held_back or shift_px > _DRIFT_PX
        self._drift_count = self._drift_count + 1 if is_off else 0
        if not is_off:
            self._failures, self._last, self.doubt = 0, None, None
            return False
        if is_held_back:
            return True
        if self._drift_count < _DRIFT_FRAMES:
            return False
        self._failures += 1
        is_turn = self._failures <= _AT_ONCE or self._failures % _PERIOD < 2
        if not is_turn:
            self._last = None
        return is_turn

    def _measured(self, frame: np.ndarray, limits: Limits) -> Optional[Correction]:
        if self._meter is None:
            self._meter = NudgeMeter(self._background, self._surface.distortion)
        nudge = self._meter.measure(frame)
        self.is_refused = False
        if isinstance(nudge, str):
            self.doubt = nudge
            return None
        correction = correction_of(nudge, self._surface, self._size)
        self.doubt = _doubt(correction, limits)
        self.is_refused = self.doubt is not None
        return correction if self.doubt is None else None

    def _is_same(self, one: Correction, other: Correction) -> bool:
        limit = max(_SAME_PX * max(1.0, max(self._size) / _USUAL_LENGTH),
                    _SAME_DEVIATIONS * other.deviation_px)
        is_same = self._apart_px(one.nudge, other.nudge) <= limit
        self.doubt = None if is_same else 'two frames do not give the same movement'
        return is_same

    def _use(self, correction: Correction) -> bool:
        if correction.shift_px < _LEAST_NUDGE_PX:
            is_new = self.correction is not None
            self.correction = None
            return is_new
        if self.correction is not None and self._is_same(self.correction, correction):
            return False
        self.correction, self._failures, self._drift_count = correction, 0, 0
        return True

    def _apart_px(self, one: Nudge, other: Nudge) -> float:
        width, height = self._size
        places = np.array([[0, 0], [width, 0], [0, height], [width, height],
                           [width / 2, height / 2]], float)
        apart = one.frame_from_background.pixels(places) - other.frame_from_background.pixels(
            places)
        return float(np.hypot(*apart.T).max())


def _doubt(correction: Correction, limits: Limits) -> Optional[str]:
    if correction.shift_px > limits.correct_up_to_px:
        return f'view.correct_up_to_px is {limits.correct_up_to_px:g}'
    if correction.error_mm > limits.correct_error_mm:
        return (f'positions would be off by up to {correction.error_mm:.1f} mm, and '
                f'view.correct_error_mm is {limits.correct_error_mm:g}')
    return None
