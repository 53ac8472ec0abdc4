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

"""Kinds of sources; only this module derives the kind from a source's name."""

import os
from typing import NamedTuple, Optional

from camera_to_base.parameters import misspelt_name


class SourceKind(NamedTuple):
    """
    The kind of a source.

    :param form: A word for the kind.
    :param is_live: Whether a camera takes the frames now. Then frames have an age and may be
        damaged, an arm may follow the positions, and a saved background is useful.
    :param may_lag: Whether frames may wait in a buffer.
    :param ends: Whether it is a recording with a last frame.
    :param frame_rate: How often to read a frame, in Hz; 0 if the source sets the pace, or if the
        rate is not known before it is opened.
    """

    form: str
    is_live: bool = False
    may_lag: bool = False
    ends: bool = False
    frame_rate: float = 0.0


DEVICE = SourceKind('device', is_live=True)
STREAM = SourceKind('stream', is_live=True, may_lag=True)
TOPIC = SourceKind('topic', is_live=True)
COMPRESSED_TOPIC = SourceKind('compressed_topic', is_live=True)
# The first attached device; without one, random pixels are used.
AUTO = SourceKind('auto', is_live=True)
RANDOM = SourceKind('random')
SIMULATED = SourceKind('simulated')
VIDEO_FILE = SourceKind('file', ends=True)
BAG = SourceKind('bag', ends=True)

_WORDS = {kind.form: kind for kind in (TOPIC, COMPRESSED_TOPIC, AUTO, RANDOM, SIMULATED)}


def misspelt_word(name: str) -> Optional[str]:
    """Return the word with nearly the same spelling as a source's name; None without one."""
    return misspelt_name(name, _WORDS)


def kind_of(name: str) -> SourceKind:
    """
    Return the kind of source that a name stands for.

    :param name: A word (auto, random, simulated, topic, compressed_topic), a device's index or
        path, a stream's URL, a bag or a video file.
    """
    if name in _WORDS:
        return _WORDS[name]
    if '://' in name:
        return STREAM
    if name.isdecimal() or name.startswith('/dev/'):
        return DEVICE
    path = os.path.expanduser(name)
    return BAG if os.path.isdir(path) or path.endswith(('.mcap', '.db3')) else VIDEO_FILE
