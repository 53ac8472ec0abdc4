# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The board that is searched for: what is printed, what the newest picture shows, its pictures."""

import math
import time
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.calibration import (
    BoardLook, covered_shares, look_for, PAPERS, PrintedBoard, sheet_content)
from camera_to_base.checks import finite_number, whole_number
from camera_to_base.dashboard.sessions.values import sentence_of, Worker
from camera_to_base.errors import FrameSourceError, InvalidValueError
import cv2
import numpy as np

# Their median is the picture, as in `sources.median_frame`; slow machines give 2 frames a second.
_FRAMES = 5
_LONGEST_WAIT_S = 5.0
# A board that was not found for so long, in no picture, is not there.
_SEEN_S = 2.0
_NO_FRAMES = ('no pictures come from the camera node: is it running, and the camera plugged in? '
              'Then take the placement again')
_OTHER_SIZE = 'the picture has changed its size: take it again'

# A board of 40 x 40 takes a second to draw, one of 100 x 100 sixteen.
_MOST_CORNERS = 40

# Blue, green, red.
_CORNER, _RIM, _TAKEN = (80, 220, 60), (0, 0, 0), (255, 170, 0)
# Larger pictures are made smaller for the page.
_WIDTH = 960
_QUALITY = 85


class BoardOptions(NamedTuple):
    """
    What is printed.

    :param corners: Inner corners along a row and along a column.
    :param square_mm: A square's edge as printed.
    :param charuco: Whether it has markers.
    :param paper: What it is printed on.
    """

    corners: Tuple[int, int] = (9, 6)
    square_mm: float = 25.0
    charuco: bool = False
    paper: str = 'A4'

    @property
    def board(self) -> PrintedBoard:
        """The board."""
        return PrintedBoard(self.corners, self.square_mm, self.charuco)

    @property
    def data(self) -> Dict[str, Any]:
        """The options as JSON."""
        return {**self._asdict(), 'corners': list(self.corners)}

    def changed(self, body: Mapping[str, Any]) -> 'BoardOptions':
        """
        Return the options with some changed.

        :param body: As a page sends it; names as those of the fields.
        :raises InvalidValueError: If one cannot be used.
        """
        wanted = {**self._asdict(), **{name: body[name] for name in self._fields if name in body}}
        corners = wanted['corners']
        if not isinstance(corners, (list, tuple)) or len(corners) != 2:
            raise InvalidValueError(f'corners must be two counts as in 9 x 6, got {corners!r:.80}')
        if wanted['paper'] not in list(PAPERS):
            raise InvalidValueError(
                f'paper must be one of {", ".join(PAPERS)}, got {wanted["paper"]!r:.80}')
        return BoardOptions(
            tuple(whole_number('the count of inner corners', count, 3, _MOST_CORNERS)
                  for count in corners),
            finite_number('square_mm', wanted['square_mm'], 1, 1000), bool(wanted['charuco']),
            wanted['paper'])

    def sheet(self) -> bytes:
        """
        Draw the board, as `calibrate sheet` does.

        :returns: A PDF.
        :raises InvalidValueError: If it does not fit on the paper.
        """
        return sheet_content(self.paper, *self.corners, self.square_mm, 'pdf',
                             with_markers=self.charuco)


def look_data(image: np.ndarray, look: BoardLook) -> Dict[str, Any]:
    """Describe what the newest picture shows."""
    height, width = image.shape[:2]
    covered = 0.0
    if look.is_found:
        covered = float(covered_shares([_outline(look.corners)], (width, height)).mean())
    return {'found': look.is_found, 'sentence': look.sentence,
            'corners': np.round(look.corners, 1).tolist(), 'covered': round(covered, 2),
            'sharp_px': None if look.edge_px is None else round(look.edge_px, 1),
            'sharpness': look.sharpness}


def _outline(corners: np.ndarray) -> np.ndarray:
    return cv2.convexHull(corners.astype(np.float32)).reshape(-1, 2)


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


def board_picture(
    image: np.ndarray, corners: np.ndarray, taken: Sequence[np.ndarray] = ()
) -> bytes:
    """
    Draw what is found.

    :param image: Shape (h, w, 3), uint8, BGR.
    :param corners: Shape (n, 2), u and v, in px.
    :param taken: The outlines of the placements that were taken, each of shape (m, 2), in px.
    :returns: A JPEG.
    """
    scale = min(1.0, _WIDTH / image.shape[1])
    drawn = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    for outline in taken:
        cv2.polylines(drawn, [np.round(outline * scale).astype(np.int32)], True, _TAKEN, 2,
                      cv2.LINE_AA)
    for u, v in np.round(corners * scale).astype(int).tolist():
        cv2.circle(drawn, (u, v), 6, _RIM, 3, cv2.LINE_AA)
        cv2.circle(drawn, (u, v), 6, _CORNER, 2, cv2.LINE_AA)
    return cv2.imencode('.jpg', drawn, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])[1].tobytes()


class BoardWatch:
    """
    Looks at the newest frame; those that come while it looks are left out.

    `data` is what the newest one shows, as JSON; None before the first one.

    :param worker: Looks.
    :param on_change: Called when another thing is seen.
    :param on_picture: Called with each frame as JPEG, the found corners drawn into it.
    :param on_look: Called with the corners of each look, and the picture's width.
    """

    def __init__(
        self, worker: Worker, on_change: Callable[[], None], on_picture: Callable[[bytes], None],
        on_look: Callable[[np.ndarray, int], None],
    ) -> None:
        self._worker, self._on_change, self._on_picture = worker, on_change, on_picture
        self._on_look = on_look
        self._board: Optional[PrintedBoard] = None
        self._is_looking, self._seen_at = False, -math.inf
        self.data: Any = None

    @property
    def sees_board(self) -> bool:
        """Whether the board was seen within the last seconds."""
        return time.monotonic() - self._seen_at < _SEEN_S

    def start(self, board: Optional[PrintedBoard]) -> None:
        """Look for a board from now on; None ends it."""
        self._board, self.data, self._seen_at = board, None, -math.inf

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
        if found.is_found:
            self._seen_at = time.monotonic()
        self._on_look(found.corners, image.shape[1])
        data = look_data(image, found)
        if data != self.data:
            self.data = data
            self._on_change()
