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

"""The exceptions of this package; they have a common base class."""


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
