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

"""Looks for a board in the newest frame, one frame after the other."""

from typing import Any, Callable, Optional, Sequence

from camera_to_base.calibration import BoardLook, look_for, PrintedBoard
from camera_to_base.dashboard.sessions.board.data import look_data
from camera_to_base.dashboard.sessions.board.drawing import board_picture
from camera_to_base.dashboard.sessions.worker import sentence_of, Worker
import numpy as np


class BoardWatch:
    """
    Looks at the newest frame; those that come while it looks are left out.

    `data` is what the newest one shows, as JSON; None before the first one.

    :param worker: Looks.
    :param on_change: Called when another thing is seen.
    :param on_picture: Called with each frame as JPEG, the found corners drawn into it.
    """

    def __init__(
        self, worker: Worker, on_change: Callable[[], None], on_picture: Callable[[bytes], None]
    ) -> None:
        self._worker, self._on_change, self._on_picture = worker, on_change, on_picture
        self._board: Optional[PrintedBoard] = None
        self._is_looking = False
        self.data: Any = None

    def start(self, board: Optional[PrintedBoard]) -> None:
        """Look for a board from now on; None ends it."""
        self._board, self.data = board, None

    def see(self, image: np.ndarray, taken: Sequence[np.ndarray]) -> None:
        """
        Look at a frame, unless the one before is still looked at.

        :param image: Shape (h, w, 3), uint8, BGR.
        :param taken: Outlines to draw, each of shape (n, 2), in px.
        """
        if self._is_looking:
            return
        self._is_looking, board = True, self._board

        def look() -> BoardLook:
            found = look_for(board, image)
            self._on_picture(board_picture(image, found.corners, taken))
            return found
        self._worker.run(look, lambda found: self._take(board, image, found))

    def _take(self, board: PrintedBoard, image: np.ndarray, found: Any) -> None:
        self._is_looking = False
        if board != self._board:
            return  # it has ended, or another board is looked for
        if isinstance(found, Exception):
            found = BoardLook(False, sentence_of(found), np.empty((0, 2)))
        data = look_data(image, found)
        if data != self.data:
            self.data = data
            self._on_change()
