# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Cameras: local devices and network streams, opened with time-outs short enough for a node."""

from contextlib import suppress
import glob
import math
import os
import re
import subprocess
from typing import List, Optional, Union

from camera_to_base.checks import DEFAULT_IMAGE_SIZE, ImageSize
from camera_to_base.errors import FrameSourceError
from camera_to_base.sources.kinds import AUTO, DEVICE, kind_of, STREAM
import cv2
import numpy as np

# OpenCV raises an exception for a larger index.
_LARGEST_INDEX = 2**31 - 1


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


class Camera:
    """
    A camera: a local device or a network stream.

    :param name: An index ('0'), a device path ('/dev/video0') or a stream's URL.
    :param image_size: The picture size to request when a device is opened; the device may use
        another.
    :param open_now: Whether to open it now; otherwise the first read opens it, in its thread.
    :raises FrameSourceError: If it cannot be opened.
    """

    def __init__(
        self, name: str, image_size: ImageSize = DEFAULT_IMAGE_SIZE, open_now: bool = True
    ) -> None:
        self.name = name
        self.kind = kind_of(name)
        self.image_size = image_size
        self._capture = self._open_capture() if open_now else None

    def read(self) -> np.ndarray:
        """
        Wait for the next frame, see `FrameSource.read`; a camera has no end.

        After a failed read, the next call opens the camera again.
        """
        if self._capture is None:
            self._capture = self._open_capture()
        try:
            good, frame = self._capture.read()
        except cv2.error:
            good = False  # a USB camera may send an empty JPEG, unchecked by OpenCV
        if not good:
            self.release()
            raise FrameSourceError(
                f"camera '{self.name}' gives no frame: was it unplugged or switched off?")
        return frame

    @property
    def stamp_s(self) -> Optional[float]:
        """The last frame's stamp, in s from any beginning, where an RTSP stream gives stamps."""
        # Of other streams FFmpeg counts frames, by a rate that it guesses.
        if self._capture is None or not self.name.startswith(('rtsp://', 'rtsps://')):
            return None
        return self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000

    def release(self) -> None:
        """Release the camera."""
        if self._capture is not None:
            self._capture.release()
            self._capture = None

    def _open_capture(self) -> cv2.VideoCapture:
        if self.kind == STREAM:
            capture = open_stream(self.name)
        else:
            capture = open_device(_device_index(self.name))
        if capture is None:
            hint = '' if self.kind == STREAM else f' {device_hint(self.name)}'
            raise FrameSourceError(
                f"cannot open camera '{self.name}': is it plugged in, reachable, and free?{hint}")
        if self.kind != STREAM:
            capture.set(cv2.CAP_PROP_FRAME_WIDTH, self.image_size[0])
            capture.set(cv2.CAP_PROP_FRAME_HEIGHT, self.image_size[1])
        return capture


def device_hint(name: str, pattern: str = '/dev/video*') -> str:
    """
    Tell which devices there are, and whether this user may read the one that is meant.

    :param name: A device's index or path.
    :param pattern: Of the devices' paths.
    """
    devices = sorted(glob.glob(pattern), key=_device_number)
    if not devices:
        return f'There is no {pattern}: this computer sees no camera.'
    path = f'{pattern.rstrip("*")}{name}' if name.isdecimal() else name
    if os.path.exists(path) and not os.access(path, os.R_OK | os.W_OK):
        return (f'{path} is there, but this user may not read it: add the user to the group '
                'video, with sudo usermod -aG video $USER, and log in again.')
    return f'There are {", ".join(devices)}.'


def first_camera(image_size: ImageSize = DEFAULT_IMAGE_SIZE) -> Optional[Camera]:
    """
    Open the first attached camera that gives a frame.

    One camera may appear as several devices, of which only one gives frames.

    :param image_size: The picture size to request, in px.
    :returns: None if no camera is attached.
    """
    for path in sorted(glob.glob('/dev/video*'), key=_device_number):
        try:
            camera = Camera(path, image_size)
        except FrameSourceError:
            continue
        try:
            camera.read()
            return camera
        except FrameSourceError:
            camera.release()
    return None


class FirstCamera:
    """
    The first attached camera; each read searches for one until it is found.

    :param image_size: The picture size to request, in px; can be changed at any time.
    """

    kind = DEVICE
    name = AUTO.form

    def __init__(self, image_size: ImageSize = DEFAULT_IMAGE_SIZE) -> None:
        self.image_size = image_size
        self._camera: Optional[Camera] = None

    def read(self) -> np.ndarray:
        """Wait for the next frame, see :meth:`Camera.read`."""
        if self._camera is None:
            self._camera = first_camera(self.image_size)
        if self._camera is None:
            raise FrameSourceError(
                'no camera is attached: plug one in, or name a camera or a file with the '
                'parameter source (random for random pixels)')
        try:
            return self._camera.read()
        except FrameSourceError:
            self._camera = None
            raise

    def release(self) -> None:
        """Release the camera."""
        if self._camera is not None:
            self._camera.release()
            self._camera = None


def _device_number(path: str) -> float:
    number = re.search(r'(\d+)$', path)
    return float(number.group()) if number else math.inf


def _device_index(name: str) -> int:
    # OpenCV 4.6 opens a V4L2 device by its index only; /dev/v4l/by-id/... are links to one.
    number = float(name) if name.isdecimal() else _device_number(os.path.realpath(name))
    if number > _LARGEST_INDEX:
        raise FrameSourceError(
            f"cannot open camera '{name}': expected a device's number, or /dev/video and a number")
    return int(number)
