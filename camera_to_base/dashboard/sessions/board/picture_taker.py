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

"""Takes one picture from several frames."""

from typing import Any, Callable, List, Optional

from camera_to_base.dashboard.sessions.worker import Worker
from camera_to_base.errors import FrameSourceError
import numpy as np

# Their median is the picture, as in `sources.median_frame`; slow machines give 2 frames a second.
_FRAMES = 5
_LONGEST_WAIT_S = 5.0
_NO_FRAMES = ('no pictures come from the camera node: is it running, and the camera plugged in? '
              'Then take the placement again')
_OTHER_SIZE = 'the picture has changed its size: take it again'


class PictureTaker:
    """
    Collects frames, and ends where none come.

    :param worker: Tells when it has waited for too long.
    """

    def __init__(self, worker: Worker) -> None:
        self._worker = worker
        self._frames: Optional[List[np.ndarray]] = None
        self._then: Callable[[Any], None] = lambda result: None

    @property
    def is_taking(self) -> bool:
        """Whether it waits for frames."""
        return self._frames is not None

    def start(self, then: Callable[[Any], None]) -> None:
        """
        Take the next frames.

        :param then: Called with a list of frames of one size, or with an error.
        """
        self._frames, self._then = [], then
        self._give_up_later()

    def cancel(self) -> None:
        """Take no more frames."""
        self._frames = None

    def see(self, image: np.ndarray) -> None:
        """Take a frame, shape (h, w, 3), uint8, BGR."""
        self._frames.append(image)
        if len({frame.shape for frame in self._frames}) > 1:
            self._end(FrameSourceError(_OTHER_SIZE))
        elif len(self._frames) == _FRAMES:
            self._end(self._frames)

    def _end(self, result: Any) -> None:
        self._frames = None
        self._then(result)

    def _give_up_later(self) -> None:
        frames, count = self._frames, len(self._frames)
        self._worker.later(_LONGEST_WAIT_S, lambda: self._give_up(frames, count))

    def _give_up(self, frames: List[np.ndarray], count: int) -> None:
        """End if no frame has come since there were `count`."""
        if self._frames is not frames:
            return  # that picture has been taken
        if len(frames) > count:
            self._give_up_later()
        else:
            self._end(FrameSourceError(_NO_FRAMES))
