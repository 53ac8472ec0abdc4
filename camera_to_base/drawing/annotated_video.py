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

"""Writes a video of the objects found."""

from typing import Optional

from camera_to_base.errors import InvalidValueError
from camera_to_base.files import check_folder
from camera_to_base.image_size import ImageSize
import cv2
import numpy as np

_CODEC = 'mp4v'


class AnnotatedVideo:
    """
    A video file that is written frame by frame.

    :param path: The file's path, see :func:`check_video_path`.
    :param frame_rate: In Hz.
    """

    def __init__(self, path: str, frame_rate: float) -> None:
        self._path, self._frame_rate = path, frame_rate
        self._writer: Optional[cv2.VideoWriter] = None

    def add(self, picture: np.ndarray) -> None:
        """
        Add a picture; OpenCV skips a picture whose size differs from the first.

        :param picture: Shape (h, w, 3), uint8, BGR.
        :raises InvalidValueError: If the video cannot be written.
        """
        if self._writer is None:
            self._writer = self._open((picture.shape[1], picture.shape[0]))
        self._writer.write(picture)

    def release(self) -> None:
        """Finish the file."""
        if self._writer is not None:
            self._writer.release()

    def _open(self, size: ImageSize) -> cv2.VideoWriter:
        writer = cv2.VideoWriter(
            self._path, cv2.VideoWriter_fourcc(*_CODEC), self._frame_rate, size)
        if not writer.isOpened():
            raise InvalidValueError(
                f"cannot write video '{self._path}': may this folder be written to, and has this "
                f'OpenCV an encoder for {_CODEC}? That of pip and that of Ubuntu have one')
        return writer


def check_video_path(path: str) -> None:
    """
    Check that a video's file name has a known ending, and that its folder exists.

    :raises InvalidValueError: If the ending is unknown, or the folder does not exist.
    """
    if not path.lower().endswith('.mp4'):
        raise InvalidValueError(f"a video's name must end in .mp4, got '{path}'")
    check_folder(path, 'video')
