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

"""OpenCV's captures: opened without its warnings, with time-outs that a node can live with."""

from contextlib import suppress
import os
import subprocess
import sys
from typing import List, Optional, Union

import cv2

# FFmpeg, too, writes to standard error what we report in one sentence; OpenCV reads this when it
# opens its first video.
os.environ.setdefault('OPENCV_FFMPEG_LOGLEVEL', '-8')
# An RTSP stream is otherwise watched for 1 s while it is opened, to guess its rate.
os.environ.setdefault('OPENCV_FFMPEG_CAPTURE_OPTIONS', 'rtsp_transport;tcp|fpsprobesize;0')
# OpenCV's own timeouts are 30 s. `set` after opening has no effect; V4L2 knows neither, and takes
# its 10 s from the environment.
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
    """Open a video file; None where OpenCV cannot."""
    return _open(path, cv2.CAP_ANY)


def is_readable(path: str, capture: cv2.VideoCapture) -> bool:
    """
    Tell whether reading an opened file leaves the process alive.

    OpenCV 5.0.0 crashes on uncompressed BGR whose lowest row comes first, as AVI files have it. A
    process of its own reads the first frame of a file that might be one.
    """
    if int(capture.get(cv2.CAP_PROP_CODEC_PIXEL_FORMAT)) != _BGR_24:
        return True
    with suppress(subprocess.TimeoutExpired):
        return subprocess.run(
            [sys.executable, '-c', _READ_ONE, path], stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL, timeout=_LONGEST_PROBE_S).returncode == 0
    return False


def open_stream(url: str) -> Optional[cv2.VideoCapture]:
    """Open a stream from the network; None where OpenCV cannot, or not in time."""
    return _open(url, cv2.CAP_FFMPEG, _STREAM_TIMEOUTS)


def open_device(index: int) -> Optional[cv2.VideoCapture]:
    """Open a device of this machine; None where OpenCV cannot."""
    return _open(index, cv2.CAP_V4L2)


def _open(
    target: Union[int, str], backend: int, *properties: List[int]
) -> Optional[cv2.VideoCapture]:
    # OpenCV writes warnings of its own to standard error for what we report in one sentence.
    level = _set_log_level(0)
    try:
        capture = cv2.VideoCapture(target, backend, *properties)
    finally:
        _set_log_level(level)
    if capture.isOpened():
        return capture
    capture.release()
    return None
