# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Recorded frames: video files, pictures that are repeated, rosbag2 bags; opens what is named."""

from contextlib import contextmanager
from functools import partial
import os
from pathlib import Path
from typing import Any, Iterator, List, Optional

from camera_to_base.checks import DEFAULT_IMAGE_SIZE, ImageSize
from camera_to_base.errors import FrameSourceError, InvalidValueError
from camera_to_base.sources.cameras import Camera, is_readable, open_file
from camera_to_base.sources.decoding import frame_from_compressed_message, frame_from_image_message
from camera_to_base.sources.kinds import BAG, FrameSource, kind_of, misspelt_word, VIDEO_FILE
from camera_to_base.sources.recording import read_picture, TimedFrame
import cv2
import numpy as np

# Frames per second of a video file without a frame rate.
_DEFAULT_FRAME_RATE = 30.0

_PICTURES = ('.bmp', '.jpeg', '.jpg', '.png', '.tif', '.tiff', '.webp')
_PICTURE_RATE = 10.0

_DECODERS = {'sensor_msgs/msg/Image': frame_from_image_message,
             'sensor_msgs/msg/CompressedImage': frame_from_compressed_message}


class VideoFile:
    """
    A video file, played once at its own rate.

    :param path: The file.
    :raises FrameSourceError: If it does not exist or holds no video.
    """

    def __init__(self, path: str) -> None:
        if not os.path.isfile(path):
            raise FrameSourceError(f"cannot open video '{path}': {_missing(path)}")
        self._capture = open_file(path)
        if self._capture is None:
            raise FrameSourceError(
                f"cannot open video '{path}': it is no video that OpenCV can read")
        if not is_readable(path, self._capture):
            self.release()
            raise FrameSourceError(
                f"cannot read video '{path}': OpenCV {cv2.__version__} crashes on its "
                f"uncompressed pictures: convert it, ffmpeg -i '{path}' -c:v ffv1 converted.avi")
        self._first = self._next()
        if self._first is None:
            self.release()
            raise FrameSourceError(
                f"cannot read video '{path}': OpenCV decodes no frame of it; was it cut off?")
        rate = self._capture.get(cv2.CAP_PROP_FPS)
        self.kind = VIDEO_FILE._replace(
            frame_rate=rate if 0.1 <= rate <= 1000 else _DEFAULT_FRAME_RATE)

    @property
    def frame_count(self) -> Optional[int]:
        """Number of frames according to the file; None if it does not say."""
        count = self._capture.get(cv2.CAP_PROP_FRAME_COUNT)
        return int(count) if count > 0 else None

    def read(self) -> Optional[np.ndarray]:
        """Return the next frame, see :meth:`FrameSource.read`."""
        frame, self._first = self._first, None
        return self._next() if frame is None else frame

    def _next(self) -> Optional[np.ndarray]:
        good, frame = self._capture.read()
        return frame if good else None

    def release(self) -> None:
        """Close the file."""
        self._capture.release()


def _missing(path: str) -> str:
    if os.path.isdir(path):
        return 'it is a folder'
    word = misspelt_word(path)
    return 'there is no such file' + (f"; did you mean '{word}'?" if word else '')


def open_repeated(path: str) -> FrameSource:
    """
    Open a picture or a video file whose frames never end.

    :raises FrameSourceError: If it holds no video.
    :raises InvalidValueError: If it is to be a picture and is none.
    """
    is_picture = Path(path).suffix.lower() in _PICTURES
    return _RepeatedPicture(path) if is_picture else _RepeatedVideo(path)


class _RepeatedPicture:

    kind = VIDEO_FILE._replace(frame_rate=_PICTURE_RATE)

    def __init__(self, path: str) -> None:
        self._frame = read_picture(path).frame

    def read(self) -> np.ndarray:
        return self._frame.copy()

    def release(self) -> None:
        pass


class _RepeatedVideo:

    def __init__(self, path: str) -> None:
        self._path, self._video = path, VideoFile(path)
        self.kind = self._video.kind

    def read(self) -> Optional[np.ndarray]:
        frame = self._video.read()
        if frame is not None:
            return frame
        # Not every format can be wound back.
        self._video.release()
        self._video = VideoFile(self._path)
        return self._video.read()

    def release(self) -> None:
        self._video.release()


class BagFile:
    """
    The pictures of one topic of a bag, in recorded order.

    :param name: The bag's folder, or one of its files: .mcap or .db3.
    :param topic: The pictures' topic; None if the bag has only one.
    :raises FrameSourceError: If it cannot be opened.
    :raises InvalidValueError: If the bag has no such topic, or has several and none is named.
    """

    def __init__(self, name: str, topic: Optional[str] = None) -> None:
        self._name = name
        with self._naming_the_bag():
            self._reader = _reader(Path(name).expanduser())
            self._reader.open()
        try:
            self._connections = self._choose(topic)
        except InvalidValueError:
            self.release()
            raise
        self.frame_count = sum(connection.msgcount for connection in self._connections)
        self.kind = BAG._replace(
            frame_rate=self.frame_count / max(self._reader.duration / 1e9, 1e-3))

    def frames(self) -> Iterator[TimedFrame]:
        """Read one frame after another, see :meth:`Recording.frames`."""
        with self._naming_the_bag():
            messages = self._reader.messages(self._connections)
            for number, (connection, received_ns, content) in enumerate(messages):
                message = self._reader.deserialize(content, connection.msgtype)
                stamp = message.header.stamp
                # The stamp is 0 if the driver does not set it.
                stamp_ns = stamp.sec * 10**9 + stamp.nanosec or received_ns
                yield TimedFrame(number, stamp_ns, partial(_DECODERS[connection.msgtype], message))

    def release(self) -> None:
        """Close the bag."""
        self._reader.close()

    def _choose(self, topic: Optional[str]) -> List[Any]:
        pictures = [connection for connection in self._reader.connections
                    if connection.msgtype in _DECODERS and connection.msgcount]
        topics = sorted({connection.topic for connection in pictures})
        if not topics:
            raise InvalidValueError(f"bag '{self._name}' holds no pictures: record the topic of a "
                                    'camera (sensor_msgs/Image or CompressedImage)')
        if topic is None and len(topics) > 1:
            raise InvalidValueError(f"bag '{self._name}' holds several topics with pictures: "
                                    f'choose one with --topic: {", ".join(topics)}')
        wanted = topics[0] if topic is None else f'/{topic.lstrip("/")}'
        if wanted not in topics:
            raise InvalidValueError(f"bag '{self._name}' holds no pictures on the topic {topic}: "
                                    f'there are those on {", ".join(topics)}')
        return [connection for connection in pictures if connection.topic == wanted]

    @contextmanager
    def _naming_the_bag(self) -> Iterator[None]:
        try:
            yield
        except (FrameSourceError, InvalidValueError):
            raise
        # With a damaged file the library and its dependencies may raise any exception.
        except Exception as error:
            reason = ' '.join(str(error).split()) or type(error).__name__
            raise FrameSourceError(
                f"cannot read bag '{self._name}': {reason}; if the recording was cut off, try "
                '`ros2 bag reindex`, or one of its files') from error


def _reader(path: Path) -> Any:
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import get_typestore, Stores
    except ImportError as error:
        raise FrameSourceError(
            f"to read the bag '{path}' the library rosbags is needed: pip install --user "
            '--break-system-packages rosbags (in a venv without the two options)') from error
    # Older sqlite3 bags do not contain their message definitions.
    return AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY))


def open_frame_source(name: str, image_size: ImageSize = DEFAULT_IMAGE_SIZE) -> FrameSource:
    """
    Open a camera or a video file by its name.

    :param name: A device's index or path, a stream's URL, or a video file.
    :param image_size: The picture size to request from a device, in px.
    :raises FrameSourceError: If it cannot be opened.
    """
    if kind_of(name).is_live:
        return Camera(name, image_size)
    return VideoFile(os.path.expanduser(name))
