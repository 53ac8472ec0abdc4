# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Pictures of the board held at a tilt: taken by themselves when it is still."""

from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence

from camera_to_base.calibration import (
    held_tilt, HeldTilt, make_placement, missing_side, Placement, PrintedBoard, refuse_unlike,
    rough_surface, tilt_suggestion, tilt_trouble)
from camera_to_base.dashboard.sessions.placements import placement_data
from camera_to_base.errors import CalibrationError
import numpy as np

# As in the command: a hand that holds a board still moves its corners by 1 to 2 px.
_STILL_PX, _STILL_WIDTH, _STILL_LOOKS = 2.0, 640, 3
# The board must be moved by so much before the next picture, in shares of the picture's width.
_MOVED = 0.008
WANTED = 4


class TiltedPicture(NamedTuple):
    """A picture of the board, and how it was held."""

    placement: Placement
    held: HeldTilt


class TiltedList:
    """Keeps the pictures of the tilted board, and tells when the next one can be taken."""

    def __init__(self) -> None:
        self.all: List[TiltedPicture] = []
        self._last: Optional[np.ndarray] = None
        self._refused: Optional[np.ndarray] = None
        self._still_count = 0

    def __len__(self) -> int:
        return len(self.all)

    @property
    def placements(self) -> List[Placement]:
        """The pictures, as placements."""
        return [one.placement for one in self.all]

    @property
    def images(self) -> List[np.ndarray]:
        """The picture of each, of shape (h, w, 3), uint8, BGR."""
        return [one.placement.image for one in self.all]

    @property
    def side(self) -> Optional[str]:
        """The side of the picture to raise the board at; None when there are enough."""
        return missing_side(self._held) if len(self) < WANTED else None

    @property
    def suggestion(self) -> str:
        """How to hold the board next; '' when there are enough."""
        said = tilt_suggestion(self._held, WANTED)
        return said and f'{said[:1].upper()}{said[1:]}. Keep it still: the picture is taken by ' \
                        'itself.'

    @property
    def data(self) -> List[Dict[str, Any]]:
        """The pictures as JSON."""
        return [{**placement_data(number, one.placement), 'side': one.held.side,
                 'degrees': round(one.held.degrees)} for number, one in enumerate(self.all, 1)]

    def see(self, corners: np.ndarray, width: int) -> bool:
        """
        Take the corners of the newest picture.

        :param corners: Shape (n, 2), in px; none if no board was found.
        :param width: Of the picture.
        :returns: Whether the board is still, and elsewhere than in the picture before.
        """
        last, self._last = self._last, corners if len(corners) else None
        taken = [one.placement.matched.pixels for one in self.all[-1:]]
        before = [*taken, *([] if self._refused is None else [self._refused])]
        is_still = (
            last is not None and self._last is not None
            and _moved_px(corners, last) <= _STILL_PX * width / _STILL_WIDTH
            and all(_moved_px(corners, one) > _MOVED * width for one in before))
        self._still_count = self._still_count + 1 if is_still else 0
        return self._still_count >= _STILL_LOOKS

    def maker(
        self, board: PrintedBoard, frames: Sequence[np.ndarray], flat: Sequence[Placement]
    ) -> Callable[[], TiltedPicture]:
        """
        Return a function that makes the next picture; it may run in another thread.

        The function raises a CameraToBaseError if the picture cannot be used.

        :param frames: Each of shape (h, w, 3), uint8, BGR.
        :param flat: The placements on the table.
        """
        before, self._refused, self._still_count = self.placements, self._last, 0

        def make() -> TiltedPicture:
            image = np.median(frames, axis=0).astype(np.uint8)
            found = tilted_picture(board, image, len(before), flat)
            refuse_unlike([*flat, *before, found.placement])
            trouble = tilt_trouble(found.held)
            if trouble:
                raise CalibrationError(trouble)
            return found
        return make

    def add(self, picture: TiltedPicture) -> None:
        """Add a picture."""
        self.all, self._refused = [*self.all, picture], None

    def put_back(self, pictures: Sequence[TiltedPicture]) -> None:
        """Take pictures in place of the present ones."""
        self.all, self._refused, self._still_count = list(pictures), None, 0

    @property
    def _held(self) -> List[HeldTilt]:
        return [one.held for one in self.all]


def tilted_picture(
    board: PrintedBoard, image: np.ndarray, number: int, flat: Sequence[Placement]
) -> TiltedPicture:
    """
    Find the board in a picture, and how it is held.

    :param image: Shape (h, w, 3), uint8, BGR.
    :param number: How many tilted pictures there are before.
    :param flat: The placements on the table.
    :raises CalibrationError: If the picture shows no such board.
    """
    # A number above 0: its points are in the board's own coordinates.
    placement = make_placement(
        board, image, f'tilted picture {number + 1}', len(flat) + number, says_name=False)
    surface = rough_surface([one.matched for one in flat], image.shape[1::-1])
    held = HeldTilt(30.0, 'left') if surface is None else held_tilt(placement.matched, surface)
    return TiltedPicture(placement, held)


def _moved_px(corners: np.ndarray, others: np.ndarray) -> float:
    """Return how far corners are from the nearest ones of another look, on average."""
    offsets = corners[:, None] - others[None]
    return float(np.linalg.norm(offsets, axis=2).min(axis=1).mean())
