# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What may go wrong: the exceptions, and the reason why no position is published."""

from enum import IntEnum
import os
from typing import Callable, NamedTuple

CANNOT_START, DEFECT = 1, os.EX_SOFTWARE


class CameraToBaseError(Exception):
    """Base class of this package's errors; the message says what failed, and with which value."""


class InvalidValueError(CameraToBaseError, ValueError):
    """A value from a caller, a parameter or a message cannot be used."""


class FrameSizeError(CameraToBaseError):
    """A frame does not have the picture size of the background or the calibration."""


class FrameSourceError(CameraToBaseError):
    """A camera, a stream or a file cannot be opened, or gives no frame."""


class TopicTypeError(FrameSourceError):
    """A topic has another message type than the subscription."""


class OutOfReachError(CameraToBaseError):
    """A position is farther from the robot's base than its arm can reach."""


class OtherFrameError(CameraToBaseError):
    """A position is given in another coordinate frame than the camera frame."""


class HorizonError(CameraToBaseError):
    """A pixel does not show the work surface: it lies near the horizon or beyond it."""


class CalibrationError(CameraToBaseError):
    """A calibration cannot be computed from the given points or picture."""


class InputEndedError(InvalidValueError):
    """The person at the terminal does not answer any more."""


class Level(IntEnum):
    """Severity, with the numbers of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2


class Reason(NamedTuple):
    """
    Why nothing is published, or why an object is not.

    :param kind: A stable word for programs: `camera_lost`, `view_moved`. Compare kinds, never
        sentences.
    :param level: The level of the diagnostics while the reason applies.
    :param sentence: The problem with its number, and its remedy.
    :param is_passing: Whether it concerns one frame, and the next one may be good: diagnostics
        show it only if it lasts for a second.
    """

    kind: str
    level: Level
    sentence: str
    is_passing: bool = False

    def told(self, write: Callable[[str], str]) -> 'Reason':
        """Return it with its sentence rewritten for those who read it."""
        return self._replace(sentence=write(self.sentence))


def all_well(sentence: str) -> Reason:
    """Make the state that diagnostics show if nothing is wrong; its kind is `ok`."""
    return Reason('ok', Level.OK, sentence)
