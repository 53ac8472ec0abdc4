# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Objects on the surface, seen by a camera that this process opens itself."""

import time
from typing import Callable, Iterator, List, Optional, Tuple

from camera_to_base.calibration import FRAMES, suggested_places, Suggestion
from camera_to_base.commands.calibrate.prompts import ask, ask_for_object, tell
from camera_to_base.errors import CalibrationError, FrameSourceError, Reason
from camera_to_base.pipeline import DamageCheck
from camera_to_base.settings import CameraSettings, NamedSource
from camera_to_base.sources import FrameReader, FrameSource, SIMULATED, SourceKind, TakenFrame
from camera_to_base.surface import view_thumbnail
import numpy as np

# After a jump the first frames may be held back, or still show the hand.
_PASSED_OVER = 5
_BACKGROUND_FRAMES = 15
# A camera that settles needs more frames for a background.
_MOST_FRAMES = 150
# Frames without a position from which on their reason is told.
_MANY = 5
_LONGEST_WAIT_S = 8.0
# Kinds of reasons that do not pass: the calibration is not this camera's.
_OTHER = 'other_camera', 'other_view'


def display_text(point: Tuple[float, float]) -> str:
    """Tell what the simulated robot's display shows."""
    return 'The simulated robot touches it. Its display shows: x {:.2f}, y {:.2f} cm'.format(
        *point)


class _SeenObjects:
    """What a camera and a simulated one have in common."""

    def __init__(self, settings: CameraSettings, name: str, kind: SourceKind) -> None:
        self.name = f"the camera '{name}'"
        self.thumbnail = ''
        self._settings = settings
        self._pipeline = settings.pipeline(name, kind, _BACKGROUND_FRAMES)

    def suggestions(self) -> Iterator[Suggestion]:
        """Suggest places, see `Positions`."""
        return suggested_places(
            self._settings.surface, self._settings.hull, self._settings.image_size)

    def _take_background(self) -> None:
        self._pipeline.capture_background(_BACKGROUND_FRAMES)
        for _ in range(_MOST_FRAMES):
            reason = self._pipeline.process(*self._frame()).reason
            if self._pipeline.background is not None:
                self.thumbnail = view_thumbnail(self._pipeline.background)
                self._tell_doubt()
                return
        raise CalibrationError(reason.sentence)

    def _tell_doubt(self) -> None:
        reason, doubt = self._pipeline.reason, self._pipeline.doubt
        if reason is not None and reason.kind in _OTHER:
            raise CalibrationError(reason.sentence)
        if doubt is not None:
            tell(doubt.sentence)

    def _positions(self) -> List[List[Tuple[float, float]]]:
        for _ in range(_PASSED_OVER):
            self._pipeline.process(*self._frame())
        seen = [self._pipeline.process(*self._frame()) for _ in range(FRAMES)]
        reasons = [sighting.warning for sighting in seen if sighting.warning is not None]
        if len(reasons) > _MANY:
            raise CalibrationError(f'no position: {reasons[-1].sentence}')
        return [[tuple(found.point) for found in sighting.objects] for sighting in seen]

    def _frame(self) -> Tuple[np.ndarray, float]:
        raise NotImplementedError


class FreshFrames:
    """
    A camera's frames of now: it is read all the time.

    Otherwise frames that are minutes old wait in a stream's buffer while a person is asked.

    :param frames: The opened camera.
    :param name: What an error calls it.
    :param damage: Returns why a frame is damaged and left out, see `FrameReader`.
    :raises FrameSourceError: If it gives no frame.
    """

    def __init__(
        self, frames: FrameSource, name: str,
        damage: Callable[[np.ndarray], Optional[Reason]] = lambda frame: None,
    ) -> None:
        self.kind = frames.kind
        self._name = name
        self._reader = FrameReader(frames, damage=damage, may_lag=frames.kind.may_lag)
        try:
            self._reader.wait_for_first_attempt()
        except FrameSourceError:
            self._reader.close()
            raise

    def drop(self) -> None:
        """Drop what has come so far: the next frame is a later one."""
        self._reader.take()

    def read(self) -> np.ndarray:
        """Wait for the next frame, see `FrameSource.read`."""
        return self.take().image

    def take(self) -> TakenFrame:
        """
        Wait for the next frame.

        :raises FrameSourceError: If none comes for some seconds.
        """
        until = time.monotonic() + _LONGEST_WAIT_S
        while time.monotonic() < until:
            taken = self._reader.take()
            if taken is not None:
                return taken
            time.sleep(0.005)
        raise FrameSourceError(
            f'{self._name} gives no frame for {_LONGEST_WAIT_S:g} s: '
            f'{self._reader.error or "is it plugged in, and free?"}')

    def release(self) -> None:
        """Release the camera."""
        self._reader.close()


class CameraPositions(_SeenObjects):
    """
    Positions from a camera.

    :param settings: The camera node's settings from the file.
    :param source: The opened source.
    :raises FrameSourceError: If it gives no frame.
    """

    def __init__(self, settings: CameraSettings, source: NamedSource) -> None:
        super().__init__(settings, source.name, source.kind)
        self._frames = FreshFrames(source.frames, self.name, DamageCheck().reason)

    def prepare(self) -> None:
        """Take the background of the empty surface."""
        ask('Clear the surface, and take your hand and the robot out of the picture. Then press '
            'Enter:')
        self._frames.drop()
        self._take_background()

    def see(self, suggestion: Suggestion) -> List[List[Tuple[float, float]]]:
        """Ask for an object, see `Positions`."""
        ask_for_object(suggestion)
        self._frames.drop()
        return self._positions()

    def robot_hint(self) -> str:
        """Return nothing: the robot is a real one."""
        return ''

    def close(self) -> None:
        """Release the camera."""
        self._frames.release()

    def _frame(self) -> Tuple[np.ndarray, float]:
        return self._frames.take()


class SimulatedPositions(_SeenObjects):
    """
    Positions from the simulated camera, which lays its coin by itself.

    :param settings: The camera node's settings from the file.
    """

    def __init__(self, settings: CameraSettings) -> None:
        super().__init__(settings, SIMULATED.form, SIMULATED)
        self._table = settings.simulated.touch_table(settings.image_size)

    def prepare(self) -> None:
        """Take the background of the empty surface."""
        tell('The simulated table is empty: its background is taken.')
        self._take_background()

    def see(self, suggestion: Suggestion) -> List[List[Tuple[float, float]]]:
        """Lay the coin, and see it."""
        tell(f'  The simulated coin lies near the {suggestion.name} of the calibrated area.')
        self._table.lay_coin(suggestion.pixel)
        return self._positions()

    def robot_hint(self) -> str:
        """Return what the simulated robot's display shows."""
        return display_text(self._table.robot_position())

    def close(self) -> None:
        """Do nothing: there is no device to give back."""

    def _frame(self) -> Tuple[np.ndarray, float]:
        return self._table.read(), time.monotonic()
