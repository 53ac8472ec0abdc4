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

"""The errors that this package raises on purpose: one family, so that a caller catches one."""


class CameraToBaseError(Exception):
    """Base of all errors of this package; its text says what failed, with which value."""


class InvalidValueError(CameraToBaseError, ValueError):
    """A value that a caller, a parameter or a message gave cannot be used."""


class FrameSizeError(CameraToBaseError):
    """A frame does not have the size that the background or the calibration was made for."""


class FrameSourceError(CameraToBaseError):
    """A camera, a stream or a file cannot be opened, or gives no frame."""


class TopicTypeError(FrameSourceError):
    """A topic carries another type of messages than the one that was subscribed to."""


class OutOfReachError(CameraToBaseError):
    """A position lies farther from the robot's base than its arm can reach."""


class OtherFrameError(CameraToBaseError):
    """A position is given in another coordinate frame than the one that is converted."""


class HorizonError(CameraToBaseError):
    """A pixel does not look at the work surface: it lies near the horizon or beyond it."""


class CalibrationError(CameraToBaseError):
    """A calibration cannot be computed from the points or the picture that were given."""
