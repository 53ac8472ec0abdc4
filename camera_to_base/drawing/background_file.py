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

"""Keeps a background in a file, so that a restarted node can use it."""

import os
import time
from typing import NamedTuple, Optional

from camera_to_base.drawing.overlay import write_picture
from camera_to_base.errors import InvalidValueError
from camera_to_base.files import check_folder
from camera_to_base.sources import decode_compressed
import numpy as np


class KeptBackground(NamedTuple):
    """A background, shape (h, w, 3), uint8, BGR, and its age in s."""

    picture: np.ndarray
    age_s: float


class BackgroundFile:
    """
    Writes each new background, and reads the last one.

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
        _refuse_no_file(self._path)
        try:
            with open(self._path, 'rb') as file:
                self._kept = decode_compressed(file.read())
            age_s = time.time() - os.path.getmtime(self._path)
        except OSError as error:
            raise InvalidValueError(self._unusable(error.strerror)) from error
        except InvalidValueError as error:
            raise InvalidValueError(self._unusable('it holds no whole picture')) from error
        return KeptBackground(self._kept, max(0.0, age_s))

    def keep(self, background: Optional[np.ndarray]) -> None:
        """
        Write a background if it is new; None if there is none yet.

        :raises InvalidValueError: If the file cannot be written.
        """
        if self._path and background is not None and background is not self._kept:
            self._kept = background
            write_picture(self._path, background)

    def _unusable(self, reason: str) -> str:
        return f"cannot read background_file '{self._path}': {reason}"


def check_background_path(path: str) -> str:
    """
    Check that a file keeps a background without loss.

    :returns: The path, with the home folder for a `~` at its beginning.
    :raises InvalidValueError: If it is not an ordinary .png file, or its folder does not exist.
    """
    path = os.path.expanduser(path)
    if path:
        if not path.lower().endswith('.png'):
            raise InvalidValueError(f"background_file must end in .png, got '{path}'")
        check_folder(path, 'background_file')
        _refuse_no_file(path)
    return path


def _refuse_no_file(path: str) -> None:
    # Reading a pipe, or a device, would never end.
    if os.path.exists(path) and not (os.path.isfile(path) or os.path.isdir(path)):
        raise InvalidValueError(f"background_file '{path}' is no ordinary file: name another")
