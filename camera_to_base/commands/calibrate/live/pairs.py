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

"""Pairs for the base frame: one object after the other is seen, and touched by the robot."""

from datetime import datetime
from itertools import islice
import os
from typing import List, Sequence, Tuple

from camera_to_base.calibration import (
    measured_place, pairs_text, read_kept_pairs, same_touch, Suggestion, TouchedPair)
from camera_to_base.commands.calibrate.live.sources import Positions, Robot
from camera_to_base.commands.calibrate.prompts import ask, tell, until_right
from camera_to_base.files import refuse_same_file, regular_target, write_files


class KeptPairs:
    """
    The pairs of a calibration, in a file from the first one on, so that it can be gone on with.

    `pairs` are those so far.

    :param cell: The parameter file that is to be written; the pairs are kept beside it.
    :param surface: The record of the surface that the camera points are measured with.
    :raises InvalidValueError: If the file cannot be written, or is another one.
    """

    def __init__(self, cell: str, surface: str) -> None:
        self.path = f'{os.path.splitext(cell)[0]}_touched_pairs.csv'
        self.pairs: List[TouchedPair] = []
        self._surface = surface
        refuse_same_file([cell, self.path])
        regular_target(self.path)
        if os.path.exists(self.path):
            read_kept_pairs(self.path, surface, iter(()))

    def offer(self, positions: Positions, most: int) -> None:
        """Ask whether to go on with the pairs of a calibration that was interrupted."""
        if not os.path.exists(self.path):
            return
        kept = read_kept_pairs(self.path, self._surface, positions.suggestions())[:most]
        if not kept:
            tell(f'The pairs in {self.path} were measured with another surface: they are not '
                 'used.')
            return
        when = datetime.fromtimestamp(os.path.getmtime(self.path))
        answer = ask(
            f'{len(kept)} of {most} pairs are kept in {self.path}, of {when:%Y-%m-%d %H:%M}. If '
            'neither the camera nor the robot was moved since, press Enter to go on with them; '
            'type n to begin anew:')
        if not answer.lower().startswith('n'):
            self.pairs = kept

    def put(self, index: int, pair: TouchedPair) -> None:
        """Add a pair or replace one, and write the file."""
        self.pairs[index:index + 1] = [pair]
        write_files({self.path: pairs_text(self.pairs, self._surface).encode()})

    def remove(self) -> None:
        """Remove the file: the calibration is saved."""
        if os.path.exists(self.path):
            os.remove(self.path)


def collect(positions: Positions, robot: Robot, count: int, kept: KeptPairs) -> None:
    """
    Ask for one object after the other.

    :param positions: Where objects are seen.
    :param robot: Where the robot is.
    :param count: Number of places.
    :param kept: Gets the pairs, and may have some of them.
    """
    tell(f'Positions come from {positions.name}.')
    kept.offer(positions, count)
    until_right(positions.prepare, 'Press Enter to try again, q to stop:')
    first = len(kept.pairs)
    for number, suggestion in enumerate(islice(positions.suggestions(), first, count), first):
        tell(f'Place {number + 1} of {count}')
        kept.put(number, _pair(suggestion, positions, robot, kept.pairs))
        if number == 0:
            tell(f'  kept in {kept.path} until the calibration is saved')


def measure_again(kept: KeptPairs, index: int, positions: Positions, robot: Robot) -> None:
    """Replace one of the pairs."""
    tell(f'Place {index + 1} again')
    others = [pair for number, pair in enumerate(kept.pairs) if number != index]
    kept.put(index, _pair(kept.pairs[index].suggestion, positions, robot, others))


def touch_elsewhere(
    robot: Robot, camera_point: Tuple[float, float], others: Sequence[TouchedPair]
) -> Tuple[float, float]:
    """
    Ask for a touch until it is none of another place; return x and y, in cm, in the base frame.

    :param camera_point: Where the camera sees what is touched, x and y, in cm.
    :param others: The pairs of the other places.
    """
    while True:
        base_point = until_right(robot.touch, 'Press Enter to try again, q to stop:')
        refusal = same_touch(others, camera_point, base_point)
        if refusal is None:
            tell('  touched at ({:.2f}, {:.2f}) cm in the base frame'.format(*base_point))
            return base_point
        tell(f'  {refusal}')


def _pair(
    suggestion: Suggestion, positions: Positions, robot: Robot, others: Sequence[TouchedPair]
) -> TouchedPair:
    place = until_right(lambda: measured_place(positions.see(suggestion)),
                        'Press Enter to measure it again, q to stop:')
    tell(f'  seen at ({place.x:.2f}, {place.y:.2f}) cm in the camera frame, in '
         f'{place.frame_count} frames, spread {10 * place.spread_cm:.2f} mm')
    hint = positions.robot_hint()
    if hint:
        tell(f'  {hint}')
    point = (place.x, place.y)
    return TouchedPair(suggestion, point, touch_elsewhere(robot, point, others))
