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

"""The placements of a board; the first one defines the camera frame."""

from typing import Any, Callable, Dict, List, Optional

from camera_to_base.calibration import (
    make_placement, Placement, PrintedBoard, refuse_unlike, renumbered)
from camera_to_base.dashboard.sessions.board.data import (
    covered_data, placement_data, suggestion)
from camera_to_base.errors import InvalidValueError
import numpy as np


class PlacementList:
    """Keeps the placements in the order in which they were taken."""

    def __init__(self) -> None:
        self._placements: List[Placement] = []

    def __len__(self) -> int:
        return len(self._placements)

    @property
    def outlines(self) -> List[np.ndarray]:
        """The outline of each, of shape (n, 2), in px."""
        return [one.outline for one in self._placements]

    def maker(self, board: PrintedBoard, frames: List[np.ndarray]) -> Callable[[], Placement]:
        """
        Return a function that makes the next placement, which takes a while.

        The function raises a CameraToBaseError if the board is not found, or the placement does
        not fit those before. It may run in another thread.

        :param frames: Each of shape (h, w, 3), uint8, BGR.
        """
        before = list(self._placements)
        number = len(before)

        def make() -> Placement:
            image = np.median(frames, axis=0).astype(np.uint8)
            found = make_placement(
                board, image, f'placement {number + 1}', number, says_name=number > 0)
            refuse_unlike([*before, found])
            return found
        return make

    def add(self, placement: Placement) -> None:
        """Add a placement."""
        self._placements.append(placement)

    def remove(self, board: PrintedBoard, number: Any) -> None:
        """
        Remove a placement, counted from 1.

        :raises InvalidValueError: If there is none with the number.
        """
        if number not in range(1, 1 + len(self._placements)):
            raise InvalidValueError(f'there is no placement {number!r:.20}')
        del self._placements[number - 1]
        self._placements = [renumbered(board, one, index)
                            for index, one in enumerate(self._placements)]

    def clear(self) -> None:
        """Remove all placements."""
        self._placements = []

    def named(self, name: str) -> List[Placement]:
        """Return the placements with a name for the report."""
        return [one._replace(name=name) for one in self._placements]

    @property
    def data(self) -> List[Dict[str, Any]]:
        """The placements as JSON."""
        return [placement_data(number, one) for number, one in enumerate(self._placements, 1)]

    @property
    def covered(self) -> Dict[str, Any]:
        """How much of the picture they cover, as JSON."""
        return covered_data(self._placements)

    @property
    def suggestion(self) -> Optional[Dict[str, Any]]:
        """Where the board is best laid next, as JSON; None before the first placement."""
        return suggestion(self._placements)
