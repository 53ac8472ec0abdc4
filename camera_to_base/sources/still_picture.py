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


"""One picture to calibrate with: from a file, or the median of several frames."""

import os
from typing import List, NamedTuple, Optional

from camera_to_base.errors import FrameSourceError, InvalidValueError
from camera_to_base.sources.frame_source import FrameSource
import cv2
import numpy as np

# A camera's exposure settles within its first frames.
WARM_UP_FRAMES = 10
# An odd number, so that the median of each pixel is one of its values. The noise falls to about
# 0.4 of a single frame's.
FRAMES = 9


class StillPicture(NamedTuple):
    """
    A picture as the camera has stored it.

    :param frame: Shape (h, w, 3), uint8, BGR.
    :param is_shown_turned: Whether its EXIF orientation tells viewers to turn or mirror it.
    """

    frame: np.ndarray
    is_shown_turned: bool


def read_picture(path: str) -> StillPicture:
    """
    Read a picture file, without the turn that its EXIF orientation asks viewers for.

    A camera's frames come without EXIF: as they are stored is how the node gets them.

    :raises InvalidValueError: If there is none, or it is no picture.
    """
    # Not by cv2.imread, which would print its own warning in addition to this error.
    try:
        content = np.fromfile(os.path.expanduser(path), np.uint8)
    except OSError as error:
        raise InvalidValueError(f"cannot read picture '{path}': {error.strerror}") from error
    frame = _decoded(content, cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
    if frame is None:
        raise InvalidValueError(
            f"cannot read picture '{path}': it is no picture that OpenCV knows, damaged, or "
            'larger than OpenCV reads')
    return StillPicture(frame, not np.array_equal(frame, _decoded(content, cv2.IMREAD_COLOR)))


def _decoded(content: np.ndarray, flags: int) -> Optional[np.ndarray]:
    try:
        return cv2.imdecode(content, flags) if content.size else None
    except cv2.error:  # such as a size beyond all limits
        return None


def median_frame(source: FrameSource) -> np.ndarray:
    """
    Return the median of several frames: it has less noise, and no hand that passes by.

    :returns: Shape (h, w, 3), uint8, BGR.
    :raises FrameSourceError: If the source gives no frame.
    """
    return np.median(still_frames(source), axis=0).astype(np.uint8)


def still_frames(source: FrameSource) -> List[np.ndarray]:
    """
    Return several frames of a camera that stands still, after those in which it settles.

    :returns: Each of shape (h, w, 3), uint8, BGR.
    :raises FrameSourceError: If the source gives no frame.
    """
    for _ in range(WARM_UP_FRAMES if source.kind.is_live else 0):
        source.read()
    frames = [source.read() for _ in range(FRAMES)]
    frames = [frame for frame in frames if frame is not None]
    if not frames:
        raise FrameSourceError('the source has ended before its first frame: name another')
    return frames
