# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Parameters that are to be set on a cell's two nodes, and a thread for what takes longer."""

from concurrent.futures import ThreadPoolExecutor
import threading
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence

from camera_to_base.calibration import BASE, grown, parts_of, SURFACE
from camera_to_base.errors import CameraToBaseError, InvalidValueError
from camera_to_base.markers import Corners, known_markers
from camera_to_base.parameters import checked_values, ParameterSpec, TRANSFORM_SPECS, Values
from camera_to_base.settings import camera_settings, CAMERA_SPECS, CameraSettings
import numpy as np

SPECS: Dict[str, Dict[str, ParameterSpec]] = {
    'camera': {spec.name: spec for spec in CAMERA_SPECS},
    'transform': {spec.name: spec for spec in TRANSFORM_SPECS}}
_ALL = {**SPECS['camera'], **SPECS['transform']}


class Worker:
    """
    Runs one function after the other, in a thread that starts with the first one.

    :param lock: Held while results are taken over; see :meth:`run`.
    """

    def __init__(self, lock: Any) -> None:
        self._lock = lock
        self._thread: Optional[ThreadPoolExecutor] = None

    def run(self, function: Callable[[], Any], then: Callable[[Any], None]) -> None:
        """
        Run a function, and take its result over with the lock held.

        :param function: Runs without the lock.
        :param then: Called with its result, or with the exception that it raised.
        """
        if self._thread is None:
            self._thread = ThreadPoolExecutor(1, thread_name_prefix='session')
        self._thread.submit(self._run, function, then)

    def later(self, seconds: float, function: Callable[[], None]) -> None:
        """Call a function with the lock held, after some time."""
        def call() -> None:
            with self._lock:
                function()
        timer = threading.Timer(seconds, call)
        timer.daemon = True
        timer.start()

    def close(self) -> None:
        """Run nothing more."""
        if self._thread is not None:
            self._thread.shutdown(wait=False, cancel_futures=True)

    def _run(self, function: Callable[[], Any], then: Callable[[Any], None]) -> None:
        try:
            result = function()
        except Exception as error:
            result = error
        with self._lock:
            then(result)


def sentence_of(error: Exception) -> str:
    """Say what went wrong; a defect is called one."""
    if isinstance(error, CameraToBaseError):
        return str(error)
    return f'the dashboard has a defect: {type(error).__name__}: {error}'


class CellChanges(NamedTuple):
    """
    What a step of the set-up changes.

    :param values: For each node, 'camera' and 'transform', the new values by full name.
    :param dropped: What becomes invalid, in words.
    """

    values: Dict[str, Dict[str, Any]]
    dropped: List[str]


class Setup(NamedTuple):
    """
    How far a cell is set up.

    :param parts: What is calibrated: SURFACE, MARKERS, BASE; None while a node does not run.
    :param sees_board: Whether a board is looked for, and seen now.
    :param new_surface: Another object for each surface that was accepted; None before.
    :param not_kept: Why the steps are not on the disk; None if they are.
    """

    parts: Optional[List[str]] = None
    sees_board: bool = False
    new_surface: Any = None
    not_kept: Optional[str] = None


class CellValues:
    """
    The parameters of a cell's nodes, as far as they are known.

    `camera` and `transform` are None while the node does not run, and so is `parts`, which is
    calibrated, while one of them does not run.
    """

    def __init__(self) -> None:
        self.camera: Optional[Values] = None
        self.transform: Optional[Values] = None
        self.parts: Optional[List[str]] = None
        self._settings: Optional[CameraSettings] = None

    def see(self, node: str, values: Optional[Values]) -> None:
        """Take the values of 'camera' or 'transform'; None where it does not run."""
        setattr(self, node, dict(values) if values else None)
        self._settings = None
        self.parts = None
        if self.camera is not None and self.transform is not None:
            # The base frame is the transform node's; the camera node only shows it.
            has_base = BASE in parts_of(_given('transform', self.transform))
            self.parts = [part for part in parts_of(self.given) if part != BASE or has_base]

    @property
    def settings(self) -> CameraSettings:
        """
        The camera node's settings.

        :raises CameraToBaseError: If it does not run.
        """
        if self.camera is None:
            raise InvalidValueError('camera_publisher does not run: start it')
        if self._settings is None:
            self._settings = camera_settings(checked_values(CAMERA_SPECS, self.camera))
        return self._settings

    @property
    def needs_surface(self) -> Optional[str]:
        """Say why points on the surface are not known; None if they are."""
        if self.camera is None:
            return 'camera_publisher does not run: start it.'
        if SURFACE not in parts_of(self.given):
            return 'There is no surface yet: calibrate it with the board first.'
        return None

    @property
    def markers(self) -> Corners:
        """The markers that the camera node knows."""
        return {} if self.camera is None else known_markers(self.camera)

    def pixel_of(self, point: Sequence[float]) -> Optional[List[float]]:
        """Return the pixel that shows a point of the surface, in cm; None if there is none."""
        if self.camera is None:
            return None
        pixel, = self.settings.surface.pixels([point])
        return np.round(pixel, 1).tolist() if np.isfinite(pixel).all() else None

    @property
    def given(self) -> Dict[str, Any]:
        """The values that differ from their defaults, of both nodes."""
        return {**_given('camera', self.camera), **_given('transform', self.transform)}

    def with_part(self, new: Values, part: str) -> CellChanges:
        """
        Add a part of the calibration: what depends on a part that it replaces is dropped.

        :param new: The part's values by full name.
        :param part: SURFACE, MARKERS or BASE.
        """
        old = self.given
        growth = grown(old, new, part)
        reset = {name: _ALL[name].default for name in old if name not in growth.values}
        return CellChanges(self._of_nodes({**reset, **new}), growth.dropped)

    def dropped_by(self, part: str) -> List[str]:
        """Name what a new part would make invalid."""
        return [] if part == BASE else grown(self.given, {}, SURFACE).dropped

    def _of_nodes(self, values: Values) -> Dict[str, Dict[str, Any]]:
        running = {'camera': self.camera, 'transform': self.transform}
        changes = {node: {name: value for name, value in values.items() if name in SPECS[node]}
                   for node, known in running.items() if known is not None}
        return {node: one for node, one in changes.items() if one}


def _given(node: str, values: Optional[Mapping[str, Any]]) -> Dict[str, Any]:
    return {name: value for name, value in (values or {}).items()
            if name in SPECS[node] and value != SPECS[node][name].default}
