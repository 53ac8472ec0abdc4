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
time of a node that gets a dozen markers 60 times a second. What stands at fixed distances is read
at once.
"""

from functools import lru_cache
import struct
from types import SimpleNamespace
from typing import Any, Tuple

from camera_to_base.errors import InvalidValueError
import numpy as np
from rclpy.serialization import deserialize_message
from visualization_msgs.msg import MarkerArray

# The first bytes of what is serialized as plain CDR, little-endian; offsets count from behind.
_LITTLE_ENDIAN, _HEAD = b'\x00\x01', 4
# Pose, scale, what is passed over (colour, lifetime, frame_locked), and how many points.
_BODY = struct.Struct('<10d16x8xx3xI')
# What follows the points of a line or an ellipse: nothing, said in ten lengths. An empty text has
# the length 1; the time of the texture is passed over.
_TAIL, _NOTHING = struct.Struct('<II4x8xI4xI4xIII4xI4xI4xI'), (0, 1, 1, 1, 0, 0, 1, 1, 1, 0)
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


@lru_cache(maxsize=64)
def _start_of(first: int, second: int) -> struct.Struct:
    """Return how a marker begins: stamp, frame_id, ns of these lengths, id, type, action."""
    return struct.Struct(f'<iII{first}s{-first % 4}xI{second}s{-second % 4}x3i')


def _decoded(text: bytes) -> str:
    return text[:-1].decode('utf-8', 'replace')


class _Reader:
    """Goes through the bytes: `at` is the next one, counted as CDR aligns."""

    def __init__(self, raw: bytes) -> None:
        self._raw, self.at = raw, 0
        self._lengths, self._started, self._header_told = (0, 0), (), SimpleNamespace()

    def marker(self) -> SimpleNamespace:
        """Read a marker."""
        header, namespace, number, kind, action = self._start()
        x, y, z, a, b, c, d, width, depth, height, count = self._take(_BODY, 8)
        points = self._doubles(count)
        self._pass_the_tail()
        return SimpleNamespace(
            header=header, ns=namespace, id=number, type=kind, action=action,
            pose=SimpleNamespace(position=SimpleNamespace(x=x, y=y, z=z),
                                 orientation=SimpleNamespace(x=a, y=b, z=c, w=d)),
            scale=SimpleNamespace(x=width, y=depth, z=height), points=points)

    def _start(self) -> Tuple[SimpleNamespace, str, int, int, int]:
        """Read the header, which is that of the markers before as a rule, and four more."""
        self.at += -self.at % 4
        try:
            values = _start_of(*self._lengths).unpack_from(self._raw, self.at + _HEAD)
        except struct.error:
            values = ()
        if (values[2:3], values[4:5]) != ((self._lengths[0],), (self._lengths[1],)):
            begin = self.at
            self.at += _STAMP.size
            first = self.count()
            self.at += first
            self._lengths, self.at = (first, self.count()), begin
            values = _start_of(*self._lengths).unpack_from(self._raw, self.at + _HEAD)
        self.at += _start_of(*self._lengths).size
        sec, nanosec, _, frame_id, _, namespace, number, kind, action = values
        if values[:4] != self._started:
            self._started, self._header_told = values[:4], SimpleNamespace(
                stamp=SimpleNamespace(sec=sec, nanosec=nanosec), frame_id=_decoded(frame_id))
        return self._header_told, _decoded(namespace), number, kind, action

    def _pass_the_tail(self) -> None:
        self.at += -self.at % 4
        if (self.at + _HEAD + _TAIL.size < len(self._raw)
                and _TAIL.unpack_from(self._raw, self.at + _HEAD) == _NOTHING):
            self.at += _TAIL.size + 1  # mesh_use_embedded_materials
            return
        self._skip(16)  # colours
        self._pass_text()  # texture_resource
        self._take(_STAMP, 4)  # texture
        self._pass_text()
        self._pass_text()
        self._skip(1)
        self._skip(8)  # uv_coordinates
        self._pass_text()  # text
        self._pass_text()  # mesh_resource
        self._pass_text()  # mesh_file
        self._skip(1)
        self.at += 1  # mesh_use_embedded_materials

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

    def _pass_text(self) -> None:
        self._skip(1)

    def _doubles(self, count: int) -> np.ndarray:
        if not count:
            return np.empty((0, 3))
        self.at += -self.at % 8
        points = np.frombuffer(self._raw, '<f8', 3 * count, self.at + _HEAD).reshape(-1, 3)
        self.at += points.nbytes
        return points
