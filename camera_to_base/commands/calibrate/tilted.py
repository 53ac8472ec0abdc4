# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Pictures of a board that is held at a tilt: taken by themselves when the board is still."""

import select
import sys
import time
from typing import Callable, List, Optional

from camera_to_base.calibration import (
    held_tilt, HeldTilt, look_for, make_placement, Placement, PrintedBoard, rough_surface,
    tilt_suggestion, tilt_trouble)
from camera_to_base.commands.calibrate.prompts import tell
from camera_to_base.errors import CalibrationError, FrameSourceError
from camera_to_base.simulation import SimulatedChessboard
from camera_to_base.sources import FrameSource
import numpy as np

# A hand that holds a board still moves its corners by 1 to 2 px between two looks.
_STILL_PX, _STILL_WIDTH, _STILL_LOOKS = 2.0, 640, 3
# The board must be moved by so much before the next picture, in shares of the picture's width.
_MOVED = 0.008
_FRAMES = 5
# After so long the person is told what is missing; and no board is waited for longer.
_TELL_S, _GIVE_UP_S = 5.0, 300.0


def take_tilted(
    board: PrintedBoard, source: FrameSource, flat: List[Placement], wanted: int,
    clock: Callable[[], float] = time.monotonic,
) -> List[Placement]:
    """
    Take pictures of the board held at a tilt, guided from one to the next.

    :param source: The camera; the simulated one holds its board by itself.
    :param flat: The placements on the table.
    :param wanted: Number of pictures.
    :param clock: Counts seconds.
    :returns: As many placements, or fewer if the person types q.
    """
    height, width = flat[0].image.shape[:2]
    surface = rough_surface([placement.matched for placement in flat], (width, height))
    taken: List[Placement] = []
    held: List[HeldTilt] = []
    while len(taken) < wanted:
        tell(f'{len(taken)} of {wanted} tilted pictures taken: '
             f'{tilt_suggestion(held, wanted)}. Keep it still: the picture is taken by itself '
             '(q and Enter ends with those so far).')
        if isinstance(source, SimulatedChessboard):
            source.hold(len(taken) + 1)
        image = _still_picture(board, source, taken, clock)
        if image is None:
            break
        try:
            placement = make_placement(board, image, f'tilted picture {len(taken) + 1}',
                                       len(flat) + len(taken))
        except CalibrationError as error:
            tell(f'  {error}')
            continue
        tilt = HeldTilt(30.0, 'left') if surface is None else held_tilt(
            placement.matched, surface)
        trouble = tilt_trouble(tilt)
        if trouble and not isinstance(source, SimulatedChessboard):
            tell(f'  {trouble}')
            _wait_until_moved(board, source, placement, clock)
            continue
        tell(f'  taken, raised at the {tilt.side} of the picture')
        taken.append(placement)
        held.append(tilt)
    return taken


def _still_picture(
    board: PrintedBoard, source: FrameSource, taken: List[Placement], clock: Callable[[], float]
) -> Optional[np.ndarray]:
    """Wait until the board is still, elsewhere than before; None if the person types q."""
    still, last, begun, told = 0, None, clock(), clock()
    while not _typed_q():
        image = source.read()
        look = look_for(board, image)
        scale = image.shape[1] / _STILL_WIDTH
        is_new = look.is_found and all(
            _moved_px(look.corners, one.matched.pixels) > _MOVED * image.shape[1]
            for one in taken[-1:])
        is_still = is_new and last is not None and _moved_px(
            look.corners, last) <= _STILL_PX * scale
        still = still + 1 if is_still else 0
        last = look.corners if look.is_found else None
        if still >= _STILL_LOOKS:
            frames = [image, *(source.read() for _ in range(_FRAMES - 1))]
            return np.median(frames, axis=0).astype(np.uint8)
        if clock() - told > _TELL_S:
            told = clock()
            tell('  ' + (look.sentence if not look.is_found else
                         'keep the board still' if is_new else 'tilt the board another way'))
        if clock() - begun > _GIVE_UP_S:
            raise FrameSourceError(
                f'no still board was seen for {_GIVE_UP_S:.0f} s: start again, and hold the board '
                'so that all of it is in the picture')
    return None


def _wait_until_moved(
    board: PrintedBoard, source: FrameSource, placement: Placement, clock: Callable[[], float]
) -> None:
    begun = clock()
    while clock() - begun < _TELL_S:
        image = source.read()
        look = look_for(board, image)
        if look.is_found and _moved_px(
                look.corners, placement.matched.pixels) > _MOVED * image.shape[1]:
            return


def _moved_px(corners: np.ndarray, others: np.ndarray) -> float:
    """Return how far corners are from the nearest ones of another look, on average."""
    offsets = corners[:, None] - others[None]
    return float(np.linalg.norm(offsets, axis=2).min(axis=1).mean())


def _typed_q() -> bool:
    """Return whether a line that starts with q waits at a terminal."""
    try:
        if not sys.stdin.isatty() or not select.select([sys.stdin], [], [], 0)[0]:
            return False
        return sys.stdin.readline().strip().lower().startswith('q')
    except (OSError, ValueError):
        return False
