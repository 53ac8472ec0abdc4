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

from typing import Iterator, List

from camera_to_base.calibration import measured_place, Suggestion, TouchedPair
from camera_to_base.commands.calibrate.live.sources import Positions, Robot
from camera_to_base.commands.calibrate.prompts import tell, until_right


def collect(positions: Positions, robot: Robot, count: int) -> List[TouchedPair]:
    """
    Ask for one object after the other.

    :param positions: Where objects are seen.
    :param robot: Where the robot is.
    :param count: Number of places.
    """
    tell(f'Positions come from {positions.name}.')
    until_right(positions.prepare, 'Press Enter to try again, q to stop:')
    places: Iterator[Suggestion] = positions.suggestions()
    pairs: List[TouchedPair] = []
    while len(pairs) < count:
        tell(f'Place {len(pairs) + 1} of {count}')
        pairs.append(_pair(next(places), positions, robot))
    return pairs


def measure_again(
    pairs: List[TouchedPair], index: int, positions: Positions, robot: Robot
) -> None:
    """Replace one of the pairs."""
    tell(f'Place {index + 1} again')
    pairs[index] = _pair(pairs[index].suggestion, positions, robot)


def _pair(suggestion: Suggestion, positions: Positions, robot: Robot) -> TouchedPair:
    place = until_right(lambda: measured_place(positions.see(suggestion)),
                        'Press Enter to measure it again, q to stop:')
    tell(f'  seen at ({place.x:.2f}, {place.y:.2f}) cm in the camera frame, in '
         f'{place.frame_count} frames, spread {10 * place.spread_cm:.2f} mm')
    hint = positions.robot_hint()
    if hint:
        tell(f'  {hint}')
    base_point = until_right(robot.touch, 'Press Enter to try again, q to stop:')
    tell(f'  touched at ({base_point[0]:.2f}, {base_point[1]:.2f}) cm in the base frame')
    return TouchedPair(suggestion, (place.x, place.y), base_point)
