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

"""Video files, played once at their own rate."""

import os
from typing import Optional

from camera_to_base.errors import FrameSourceError
from camera_to_base.sources.capture import is_readable, open_file
from camera_to_base.sources.source_kind import misspelt_word, VIDEO_FILE
import cv2
import numpy as np

# Frames per second of a video file without a frame rate.
_DEFAULT_FRAME_RATE = 30.0


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
