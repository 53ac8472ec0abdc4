# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Kinds of sources: what a name stands for, what all sources offer, lasting names of devices."""

import os
import re
from typing import NamedTuple, Optional, Protocol

from camera_to_base.parameters import misspelt_name
import numpy as np

LINKS = '/dev/v4l/by-id'


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


class FrameSource(Protocol):
    """
    A source of frames.

    `kind` is the kind of source. If its frame rate is 0, `read` waits for the next frame.
    """

    kind: SourceKind

    def read(self) -> Optional[np.ndarray]:
        """
        Return the next frame.

        :returns: Shape (h, w, 3), uint8, BGR; None at the end of a recording.
        :raises FrameSourceError: If a frame should follow but cannot be read.
        """

    def release(self) -> None:
        """Release the device or file; no frame can be read afterwards."""


def lasting_name(name: str, links: str = LINKS) -> str:
    """
    Return a camera's lasting name.

    :param name: A device's index or path, a stream's URL, or another source.
    :param links: The folder with the links to devices.
    :returns: For a device its link there, or its path if it has none; others as they are, without
        the password of a URL.
    """
    kind = kind_of(name)
    if kind == STREAM:
        return re.sub(r'(?<=://)[^/@]*@', '', name)
    if kind != DEVICE:
        return name
    path = f'/dev/video{name}' if name.isdecimal() else name
    if path.startswith('/dev/v4l/'):
        return path
    found = [os.path.join(links, link) for link in sorted(_listed(links))]
    target = os.path.realpath(path)
    return next((link for link in found if os.path.realpath(link) == target), path)


def is_other_camera(name: str, calibrated: str) -> bool:
    """
    Return whether a source is certainly another camera than the one that was calibrated.

    A driver's topic, a recording and `auto` may show the same camera.

    :param name: The source.
    :param calibrated: The lasting name of the calibrated one.
    """
    kinds = kind_of(name), kind_of(calibrated)
    if not calibrated or any(kind == AUTO or kind == TOPIC or kind.ends for kind in kinds):
        return False
    if kinds == (DEVICE, DEVICE):
        here, there = lasting_name(name), calibrated
        return here != there and os.path.realpath(here) != os.path.realpath(there)
    return lasting_name(name) != calibrated


def _listed(folder: str) -> list:
    try:
        return os.listdir(folder)
    except OSError:
        return []
