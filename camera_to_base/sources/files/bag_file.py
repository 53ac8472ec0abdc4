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

"""Reads the pictures of a rosbag2 bag, without ROS."""

from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, Iterator, List, Optional

from camera_to_base.errors import FrameSourceError, InvalidValueError
from camera_to_base.sources.decoding import frame_from_compressed_message, frame_from_image_message
from camera_to_base.sources.recording import TimedFrame
from camera_to_base.sources.source_kind import BAG

_DECODERS = {'sensor_msgs/msg/Image': frame_from_image_message,
             'sensor_msgs/msg/CompressedImage': frame_from_compressed_message}


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
