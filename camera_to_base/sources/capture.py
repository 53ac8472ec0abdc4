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

"""Opens OpenCV captures without OpenCV's warnings, and with time-outs short enough for a node."""

from contextlib import suppress
import os
import subprocess
from typing import List, Optional, Union

import cv2

# Silences FFmpeg's own messages: this package reports each error in one sentence. OpenCV reads
# the variable when it opens its first video.
os.environ.setdefault('OPENCV_FFMPEG_LOGLEVEL', '-8')
# Otherwise FFmpeg reads an RTSP stream for 1 s while opening it, to estimate its frame rate.
os.environ.setdefault('OPENCV_FFMPEG_CAPTURE_OPTIONS', 'rtsp_transport;tcp|fpsprobesize;0')
# OpenCV's default time-outs are 30 s, and cannot be changed after opening. The V4L2 backend has
# neither property; its default of 10 s is changed by the environment variable.
_STREAM_TIMEOUTS = [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, 1500, cv2.CAP_PROP_READ_TIMEOUT_MSEC, 1200]
os.environ.setdefault('OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT', '1')
# FFmpeg's name of the format, 'BGR' and 24 bits.
_BGR_24 = int.from_bytes(b'BGR\x18', 'little')
_READ_ONE = """
import resource, sys
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
import cv2
cv2.VideoCapture(sys.argv[1]).read()
"""
_LONGEST_PROBE_S = 30.0
# OpenCV 5 has moved it.
_set_log_level = getattr(cv2, 'setLogLevel', None) or cv2.utils.logging.setLogLevel


def open_file(path: str) -> Optional[cv2.VideoCapture]:
    """Open a video file; return None if OpenCV cannot."""
    return _open(path, cv2.CAP_ANY)


def is_readable(path: str, capture: cv2.VideoCapture) -> bool:
    """
    Return whether reading an opened file leaves the process alive.

    OpenCV 5.0.0 crashes on uncompressed BGR whose lowest row comes first, as AVI files have it. A
    process of its own reads the first frame of a file that might be one.
    """
    if int(capture.get(cv2.CAP_PROP_CODEC_PIXEL_FORMAT)) != _BGR_24:
        return True
    from multiprocessing.spawn import get_executable
    with suppress(subprocess.TimeoutExpired):
        return subprocess.run(
            [get_executable(), '-c', _READ_ONE, path], stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL, timeout=_LONGEST_PROBE_S).returncode == 0
    return False


def open_stream(url: str) -> Optional[cv2.VideoCapture]:
    """Open a network stream; return None if OpenCV cannot, or not in time."""
    return _open(url, cv2.CAP_FFMPEG, _STREAM_TIMEOUTS)


def open_device(index: int) -> Optional[cv2.VideoCapture]:
    """Open a local device; return None if OpenCV cannot."""
    return _open(index, cv2.CAP_V4L2)


def _open(
    target: Union[int, str], backend: int, *properties: List[int]
) -> Optional[cv2.VideoCapture]:
    # Silences OpenCV's own warnings: the caller reports the error in one sentence.
    level = _set_log_level(0)
    try:
        capture = cv2.VideoCapture(target, backend, *properties)
    finally:
        _set_log_level(level)
    if capture.isOpened():
        return capture
    capture.release()
    return None
