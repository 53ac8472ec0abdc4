# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""
Reads a serialized MarkerArray without making a message of it.

A Marker has some sixty fields of which silhouettes need ten; making them all takes most of the
time of a node that gets a dozen markers 60 times a second.
"""

import struct
from types import SimpleNamespace
from typing import Any

from camera_to_base.errors import InvalidValueError
import numpy as np
from rclpy.serialization import deserialize_message
from visualization_msgs.msg import MarkerArray

# The first bytes of what is serialized as plain CDR, little-endian; offsets count from behind.
_LITTLE_ENDIAN, _HEAD = b'\x00\x01', 4
_NUMBERS = struct.Struct('<iii')
_PLACE = struct.Struct('<10d')
_STAMP = struct.Struct('<iI')
_COUNT = struct.Struct('<I')
_PADDING = 8


def markers_of_bytes(raw: bytes) -> Any:
    """
    Read a serialized visualization_msgs/MarkerArray.

    :returns: What has `markers` as the message has, where each has `header`, `ns`, `id`, `type`,
        `action`, `pose`, `scale`, and `points` of shape (n, 3), in m. The message itself where it
        is serialized in another way.
    :raises InvalidValueError: If it is none.
    """
    if raw[:2] == _LITTLE_ENDIAN:
        try:
            reader = _Reader(raw)
            markers = [reader.marker() for _ in range(reader.count())]
            if 0 <= len(raw) - reader.at - _HEAD < _PADDING:
                return SimpleNamespace(markers=markers)
        except (struct.error, ValueError):
            pass  # The message's own reader tells what is wrong.
    try:
        return deserialize_message(raw, MarkerArray)
    except RuntimeError as error:
        raise InvalidValueError(f'expected a MarkerArray, got {len(raw)} other bytes') from error


class _Reader:
    """Goes through the bytes: `at` is the next one, counted as CDR aligns."""

    def __init__(self, raw: bytes) -> None:
        self._raw, self.at = raw, 0

    def marker(self) -> SimpleNamespace:
        """Read a marker."""
        header = self._header()
        namespace = self._text()
        number, kind, action = self._take(_NUMBERS, 4)
        x, y, z, *turn, width, depth, height = self._take(_PLACE, 8)
        self.at += 4 * 4 + 8 + 1  # colour, lifetime, frame_locked
        points = self._doubles(self.count())
        self._skip(16)  # colours
        self._text()  # texture_resource
        self._header()  # texture
        self._text()
        self._skip(1)
        self._skip(8)  # uv_coordinates
        self._text()  # text
        self._text()  # mesh_resource
        self._text()  # mesh_file
        self._skip(1)
        self.at += 1  # mesh_use_embedded_materials
        return SimpleNamespace(
            header=header, ns=namespace, id=number, type=kind, action=action,
            pose=SimpleNamespace(
                position=SimpleNamespace(x=x, y=y, z=z),
                orientation=SimpleNamespace(**dict(zip('xyzw', turn)))),
            scale=SimpleNamespace(x=width, y=depth, z=height), points=points)

    def count(self) -> int:
        """Read how many follow."""
        return self._take(_COUNT, 4)[0]

    def _skip(self, size: int) -> None:
        """Pass over a sequence of elements of a size, in bytes."""
        count = self.count()
        self.at += size * count

    def _take(self, what: struct.Struct, alignment: int) -> tuple:
        self.at += -self.at % alignment
        values = what.unpack_from(self._raw, self.at + _HEAD)
        self.at += what.size
        return values

    def _text(self) -> str:
        length = self.count()
        start = self.at + _HEAD
        self.at += length
        return str(self._raw[start:start + max(length - 1, 0)], 'utf-8', 'replace')

    def _header(self) -> SimpleNamespace:
        sec, nanosec = self._take(_STAMP, 4)
        return SimpleNamespace(
            stamp=SimpleNamespace(sec=sec, nanosec=nanosec), frame_id=self._text())

    def _doubles(self, count: int) -> np.ndarray:
        if not count:
            return np.empty((0, 3))
        self.at += -self.at % 8
        points = np.frombuffer(self._raw, '<f8', 3 * count, self.at + _HEAD).reshape(-1, 3)
        self.at += points.nbytes
        return points
