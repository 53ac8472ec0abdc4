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

"""Where frames come from: a camera device, a stream, a video file, the simulated board."""

import glob
import math
import os
import re
from typing import List, Optional, Protocol, Union

from camera_to_base.errors import FrameSourceError
from camera_to_base.surface import ImageSize
import cv2
import numpy as np

# A video file that does not tell its rate plays at this many frames per second.
_DEFAULT_FRAME_RATE = 30.0
# FFmpeg, too, writes to standard error what we report in one sentence; OpenCV reads this when it
# opens its first video.
os.environ.setdefault('OPENCV_FFMPEG_LOGLEVEL', '-8')
# An RTSP stream is otherwise watched for 1 s while it is opened, to guess its rate.
os.environ.setdefault('OPENCV_FFMPEG_CAPTURE_OPTIONS', 'rtsp_transport;tcp|fpsprobesize;0')
# OpenCV's own timeouts are 30 s. `set` after opening has no effect; V4L2 knows neither, and takes
# its 10 s from the environment.
_STREAM_TIMEOUTS = [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, 1500, cv2.CAP_PROP_READ_TIMEOUT_MSEC, 1200]
os.environ.setdefault('OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT', '1')
# OpenCV raises an error of its own for a larger one.
_LARGEST_INDEX = 2**31 - 1
# OpenCV 5 has moved it.
_set_log_level = getattr(cv2, 'setLogLevel', None) or cv2.utils.logging.setLogLevel


class FrameSource(Protocol):
    """
    Gives one frame after another.

    `frame_rate` is how often a reader should come for one, in Hz; 0 where `read` itself waits
    until the camera has one.
    """

    frame_rate: float

    def read(self) -> Optional[np.ndarray]:
        """
        Give the next frame.

        :returns: Shape (h, w, 3), uint8, BGR; None at the end of a recording.
        :raises FrameSourceError: If there should be a frame, but none came.
        """

    def release(self) -> None:
        """Give the device or file back; no frame can be read afterwards."""


class VideoFile:
    """
    A recording, played once, at its own rate.

    :param path: The file.
    :raises FrameSourceError: If it does not exist or holds no video.
    """

    def __init__(self, path: str) -> None:
        if not os.path.isfile(path):
            found = 'it is a folder' if os.path.isdir(path) else 'there is no such file'
            raise FrameSourceError(f"cannot open video '{path}': {found}")
        self._capture = _open(path, cv2.CAP_ANY)
        if self._capture is None:
            raise FrameSourceError(
                f"cannot open video '{path}': it is no video that OpenCV can read")
        rate = self._capture.get(cv2.CAP_PROP_FPS)
        self.frame_rate = rate if 0.1 <= rate <= 1000 else _DEFAULT_FRAME_RATE

    @property
    def frame_count(self) -> Optional[int]:
        """How many frames the file says that it has; None where it does not."""
        count = self._capture.get(cv2.CAP_PROP_FRAME_COUNT)
        return int(count) if count > 0 else None

    def read(self) -> Optional[np.ndarray]:
        """Give the next frame, see :meth:`FrameSource.read`."""
        good, frame = self._capture.read()
        return frame if good else None

    def release(self) -> None:
        """Close the file."""
        self._capture.release()


class Camera:
    """
    A camera: a device of this machine, or a stream from the network.

    :param name: An index ('0'), a device path ('/dev/video0') or a stream's URL.
    :param image_size: The picture size to ask a device for; a camera may give another.
    :param open_now: Otherwise the first read opens it, in the thread that reads.
    :raises FrameSourceError: If it cannot be opened.
    """

    frame_rate = 0.0

    def __init__(
        self, name: str, image_size: ImageSize = (640, 480), open_now: bool = True
    ) -> None:
        self.name = name
        self._image_size = image_size
        self._capture = self._open_capture() if open_now else None

    def read(self) -> np.ndarray:
        """
        Wait for the next frame, see :meth:`FrameSource.read`; a camera has no end.

        After a frame that did not come, the next call opens the camera anew.
        """
        if self._capture is None:
            self._capture = self._open_capture()
        try:
            good, frame = self._capture.read()
        except cv2.error:
            good = False  # a USB camera may give an empty JPEG, which V4L2 decodes unchecked
        if not good:
            self.release()
            raise FrameSourceError(
                f"camera '{self.name}' gives no frame: was it unplugged or switched off?")
        return frame

    def release(self) -> None:
        """Give the device back."""
        if self._capture is not None:
            self._capture.release()
            self._capture = None

    def _open_capture(self) -> cv2.VideoCapture:
        if is_stream(self.name):
            capture = _open(self.name, cv2.CAP_FFMPEG, _STREAM_TIMEOUTS)
        else:
            capture = _open(_device_index(self.name), cv2.CAP_V4L2)
        if capture is None:
            raise FrameSourceError(
                f"cannot open camera '{self.name}': is it plugged in, reachable, and free?")
        if not is_stream(self.name):
            capture.set(cv2.CAP_PROP_FRAME_WIDTH, self._image_size[0])
            capture.set(cv2.CAP_PROP_FRAME_HEIGHT, self._image_size[1])
        return capture


def is_stream(name: str) -> bool:
    """Tell whether a source's name is a URL."""
    return '://' in name


def is_camera(name: str) -> bool:
    """Tell whether a source's name is that of a camera: an index, a device path or a URL."""
    return name.isdecimal() or name.startswith('/dev/') or is_stream(name)


def open_frame_source(name: str, image_size: ImageSize = (640, 480)) -> FrameSource:
    """
    Open a camera or a video file by its name.

    :param name: A device index or path, a stream's URL, or a video file.
    :param image_size: The picture size to ask a device for, in px.
    :raises FrameSourceError: If it cannot be opened.
    """
    if is_camera(name):
        return Camera(name, image_size)
    return VideoFile(os.path.expanduser(name))


def first_camera(image_size: ImageSize = (640, 480)) -> Optional[Camera]:
    """
    Open the first attached camera that gives a frame.

    One camera may show up as several devices, of which only one gives frames.

    :param image_size: The picture size to ask for, in px.
    :returns: None where no camera is attached.
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
