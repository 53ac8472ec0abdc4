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

"""A picture, or a video file that starts again when it has ended: a camera for trying things."""

from pathlib import Path
from typing import Optional

from camera_to_base.sources.files.video_file import VideoFile
from camera_to_base.sources.frame_source import FrameSource
from camera_to_base.sources.source_kind import VIDEO_FILE
from camera_to_base.sources.still_picture import read_picture
import numpy as np

_PICTURES = ('.bmp', '.jpeg', '.jpg', '.png', '.tif', '.tiff', '.webp')
_PICTURE_RATE = 10.0


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
