# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Learns where the markers lie on the calibrated surface."""

from collections import deque
import time
from typing import Any, Callable, Deque, Dict, List, Mapping, Optional

from camera_to_base.calibration import learned_markers, MARKERS
from camera_to_base.dashboard.sessions.values import CellChanges, CellValues
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.markers import Corners, lens_of_values, see_markers
import numpy as np

# The sheet has these.
_PRINTED = range(4)
# A look costs 20 ms of CPU.
_GAP_S = 0.4
# Markers at rest are the same in so many looks.
_LOOKS = 4


class MarkerSession:
    """
    Says which markers are seen, and learns their corners.

    :param values: The cell's parameters.
    :param on_change: Called when the state has changed.
    """

    def __init__(self, values: CellValues, on_change: Callable[[], None]) -> None:
        self._values, self._on_change = values, on_change
        self._is_on, self._looked_at = False, 0.0
        self._looks: Deque[Corners] = deque(maxlen=_LOOKS)
        self._error: Optional[str] = None

    @property
    def wants_frames(self) -> bool:
        """Whether it looks for markers."""
        return self._is_on

    @property
    def state(self) -> Dict[str, Any]:
        """The state as JSON."""
        return {
            'step': 'looking' if self._is_on else 'off', 'needs': self._values.needs_surface,
            'seen': [{'number': number, 'pixel': np.round(corners.mean(axis=0), 1).tolist()}
                     for number, corners in sorted(self._seen.items())],
            'missing': self._missing, 'can_learn': self._can_learn,
            'known': sorted(self._values.markers), 'error': self._error,
            'hint': self._hint() if self._is_on else ''}

    def start(self, body: Mapping[str, Any]) -> None:
        """
        Look for markers from now on.

        :raises InvalidValueError: If there is no surface.
        """
        if self._values.needs_surface:
            raise InvalidValueError(self._values.needs_surface)
        self._is_on, self._error = True, None
        self._looks.clear()
        self._on_change()

    def cancel(self, body: Mapping[str, Any]) -> None:
        """Look no more."""
        self._is_on = False
        self._on_change()

    def see_frame(self, image: np.ndarray) -> None:
        """Look for the markers in the newest frame, shape (h, w, 3), uint8, BGR."""
        now = time.monotonic()
        if not self._is_on or now - self._looked_at < _GAP_S or self._values.camera is None:
            return
        self._looked_at = now
        try:
            self._looks.append(see_markers(image, lens_of_values(self._values.camera)).corners)
        except CameraToBaseError as error:
            self._is_on, self._error = False, str(error)
        self._on_change()

    def learn(self, body: Mapping[str, Any]) -> CellChanges:
        """
        Return what is to be set for the running node to know the markers.

        :raises CameraToBaseError: If they cannot be learned.
        """
        if not self._can_learn:
            raise InvalidValueError('wait until the markers have been seen for two seconds')
        learned = learned_markers(list(self._looks), self._values.camera, source='the page')
        return self._values.with_part(learned.values, MARKERS)

    def set_learned(self) -> None:
        """Look no more: the node knows the markers."""
        self._is_on = False
        self._on_change()

    @property
    def _seen(self) -> Corners:
        return self._looks[-1] if self._looks else {}

    @property
    def _missing(self) -> List[int]:
        return [number for number in _PRINTED if number not in self._seen]

    @property
    def _can_learn(self) -> bool:
        return self._is_on and len(self._looks) == _LOOKS

    def _hint(self) -> str:
        if not self._looks:
            return 'Waiting for a picture.'
        seen, missing = sorted(self._seen), self._missing
        sentence = f'Seen: {_names(seen)}.' if seen else 'No marker is seen.'
        return sentence + (f' Not seen: {_names(missing)}.' if missing else '')


def _names(numbers: List[int]) -> str:
    return ', '.join(map(str, numbers))
