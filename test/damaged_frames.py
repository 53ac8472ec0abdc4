# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What can happen to a JPEG on its way: each damage makes bytes of a picture's bytes."""

import random

import cv2
import numpy as np

_random = random.Random(5)


def cut_in_half(jpeg):
    """Lose the second half and the end marker."""
    return jpeg[:len(jpeg) // 2]


def cut_anywhere(jpeg):
    """Lose the rest from a random byte on."""
    return jpeg[:_random.randrange(700, len(jpeg) - 10)]


def cut_but_ended(jpeg):
    """Lose the rest from a random byte on, but put an end marker there."""
    return cut_anywhere(jpeg) + b'\xff\xd9'


def flip_bits(jpeg, count=5):
    """Flip bits of the picture's data, behind the header."""
    flipped = bytearray(jpeg)
    for _ in range(count):
        flipped[_random.randrange(700, len(flipped) - 2)] ^= 1 << _random.randrange(8)
    return bytes(flipped)


def flip_one_bit(jpeg):
    """Flip a single bit."""
    return flip_bits(jpeg, 1)


def lose_a_piece(jpeg):
    """Lose 1400 bytes in the middle, as a lost packet does."""
    at = _random.randrange(700, len(jpeg) - 1500)
    return jpeg[:at] + jpeg[at + 1400:]


def empty(jpeg):
    """Send no bytes at all."""
    return b''


def grey(jpeg):
    """Send a whole picture of one grey."""
    return _encoded(np.full_like(_decoded(jpeg), 128))


def half_grey(jpeg):
    """Send a picture whose lower half is one grey: what a camera makes of data it lost."""
    frame = _decoded(jpeg)
    frame[frame.shape[0] // 2:] = 128
    return _encoded(frame)


def noise(jpeg):
    """Send random bytes."""
    return _random.randbytes(len(jpeg))


def other_size(jpeg):
    """Send the same picture at 320 x 240 px."""
    return _encoded(cv2.resize(_decoded(jpeg), (320, 240)))


def _decoded(jpeg):
    return cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)


def _encoded(frame):
    return cv2.imencode('.jpg', frame, [cv2.IMWRITE_JPEG_QUALITY, 90])[1].tobytes()


DAMAGES = {function.__name__: function for function in (
    cut_in_half, cut_anywhere, cut_but_ended, flip_bits, flip_one_bit, lose_a_piece, empty,
    grey, half_grey, noise)}
