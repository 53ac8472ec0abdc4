# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Writes uncompressed AVI files, as many capture programs do: BGR, the lowest row first."""

import struct

import numpy as np


def write_uncompressed(path, frames, rate=20):
    """
    Write a video.

    :param frames: Of shape (h, w, 3), uint8, BGR.
    """
    pictures = [_picture(frame) for frame in frames]
    height, width = frames[0].shape[:2]
    size = len(pictures[0])
    main = struct.pack('<14I', 10**6 // rate, size * rate, 0, 0, len(frames), 0, 1, size,
                       width, height, 0, 0, 0, 0)
    stream = b'vidsDIB ' + struct.pack('<IHHIIIIIIII4H', 0, 0, 0, 0, 1, rate, 0, len(frames),
                                       size, 2**32 - 1, 0, 0, 0, width, height)
    form = struct.pack('<IiiHHIIiiII', 40, width, height, 1, 24, 0, size, 0, 0, 0, 0)
    headers = _list(b'hdrl', _chunk(b'avih', main) + _list(
        b'strl', _chunk(b'strh', stream) + _chunk(b'strf', form)))
    movie = _list(b'movi', b''.join(_chunk(b'00db', picture) for picture in pictures))
    with open(path, 'wb') as file:
        file.write(_chunk(b'RIFF', b'AVI ' + headers + movie))
    return path


def _picture(frame):
    rows = frame[::-1].reshape(frame.shape[0], -1)
    return np.pad(rows, ((0, 0), (0, -rows.shape[1] % 4))).tobytes()


def _list(kind, content):
    return _chunk(b'LIST', kind + content)


def _chunk(name, content):
    return name + struct.pack('<I', len(content)) + content + bytes(len(content) % 2)
