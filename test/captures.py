# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What tests of cameras and of files share: a video of grey levels, a stand-in for a device."""

import cv2
import numpy as np

LEVELS = [20, 60, 100, 140, 180, 220, 240]


def write_levels(path):
    """Write a video whose frames are grey, one level each, at 12.5 Hz."""
    writer = cv2.VideoWriter(path, cv2.VideoWriter_fourcc(*'MJPG'), 12.5, (64, 48))
    for level in LEVELS:
        writer.write(np.full((48, 64, 3), level, np.uint8))
    writer.release()
    return path


def read_levels(source, count):
    """Read frames, and give their mean levels."""
    return [round(float(source.read().mean())) for _ in range(count)]


class Device:
    """Stands in for cv2.VideoCapture on a machine without a camera."""

    opened = []
    rate = 0.0

    def __init__(self, index, backend, frames=2):
        Device.opened.append(self)
        self.index = index
        self.backend = backend
        self.wishes = {}
        self.frames = 0 if index in (0, 9) else frames

    def isOpened(self):
        return self.index != 1

    def get(self, prop):
        return self.rate if prop == cv2.CAP_PROP_FPS else 0.0

    def set(self, prop, value):  # noqa: A003
        self.wishes[prop] = value

    def read(self):
        self.frames -= 1
        level = self.index if isinstance(self.index, int) else 0
        return self.frames >= 0, np.full((48, 64, 3), level, np.uint8)

    def release(self):
        self.frames = 0
