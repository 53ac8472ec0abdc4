# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Pictures in files: a kept background, and a video of the objects found."""

import os
import time
from typing import NamedTuple, Optional

from camera_to_base.checks import check_frame, ImageSize
from camera_to_base.errors import InvalidValueError
from camera_to_base.files import check_folder, refuse_no_file, write_files
from camera_to_base.sources import decode_compressed
import cv2
import numpy as np

# Where the header of a PNG file says what a pixel holds, and what it says of four channels.
_PNG_COLOUR_TYPE, _PNG_RGBA = 25, 6

_CODEC = 'mp4v'


class KeptBackground(NamedTuple):
    """
    A background.

    :param picture: Shape (h, w, 3), uint8, BGR.
    :param age_s: Its age.
    :param unknown: What it does not show, shape (h, w), uint8, 255 there; None for nothing.
    """

    picture: np.ndarray
    age_s: float
    unknown: Optional[np.ndarray] = None


class BackgroundFile:
    """
    Writes each new background, and reads the last one.

    What a background does not show is transparent in the file.

    :param path: The file, .png; '' for none.
    """

    def __init__(self, path: str) -> None:
        self._path = os.path.expanduser(path)
        self._kept: Optional[np.ndarray] = None

    def read(self) -> Optional[KeptBackground]:
        """
        Read the background of the previous run.

        :returns: None if there is none.
        :raises InvalidValueError: If the file cannot be read, or holds no complete picture.
        """
        if not os.path.exists(self._path):
            return None
        refuse_no_file(self._path)
        try:
            with open(self._path, 'rb') as file:
                content = file.read()
            self._kept = decode_compressed(content)
            age_s = time.time() - os.path.getmtime(self._path)
        except OSError as error:
            raise InvalidValueError(self._unusable(error.strerror)) from error
        except InvalidValueError as error:
            raise InvalidValueError(self._unusable('it holds no whole picture')) from error
        return KeptBackground(self._kept, max(0.0, age_s), _transparent(content))

    def keep(
        self, background: Optional[np.ndarray], unknown: Optional[np.ndarray] = None
    ) -> None:
        """
        Write a background if it is new; None if there is none yet.

        :param unknown: See :class:`KeptBackground`.
        :raises InvalidValueError: If the file cannot be written.
        """
        if self._path and background is not None and background is not self._kept:
            write_files({self._path: _content(background, unknown)})
            self._kept = background

    def _unusable(self, reason: str) -> str:
        return f"cannot read background_file '{self._path}': {reason}"


def _content(picture: np.ndarray, unknown: Optional[np.ndarray]) -> bytes:
    if unknown is not None:
        picture = np.dstack([picture, cv2.bitwise_not(unknown)])
    return cv2.imencode('.png', picture)[1].tobytes()


def _transparent(content: bytes) -> Optional[np.ndarray]:
    if content[_PNG_COLOUR_TYPE] != _PNG_RGBA:
        return None
    picture = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    has_alpha = picture.ndim == 3 and picture.shape[2] == 4
    return cv2.bitwise_not(picture[:, :, 3]) if has_alpha else None


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


def encoded_picture(path: str, picture: np.ndarray) -> bytes:
    """
    Encode a picture as the content of a file.

    :param path: The file's name; the ending sets the format.
    :raises InvalidValueError: If the ending is unknown, or the picture is invalid.
    """
    ending = check_picture_path(path)
    check_frame(picture, 'picture')
    return cv2.imencode(ending, picture)[1].tobytes()


def check_picture_path(path: str) -> str:
    """
    Check that a picture's file name has a known ending, and that its folder exists.

    :returns: The ending: '.png' or '.jpg'.
    :raises InvalidValueError: If the ending is unknown, or the folder does not exist.
    """
    ending = os.path.splitext(path)[1].lower()
    if ending not in ('.png', '.jpg'):
        raise InvalidValueError(f"a picture's name must end in .png or .jpg, got '{path}'")
    check_folder(path, 'picture')
    return ending
