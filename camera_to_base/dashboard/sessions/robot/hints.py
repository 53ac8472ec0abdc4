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

"""What a person does next to measure pairs."""

from typing import Optional

from camera_to_base.dashboard.sessions.robot.open_pair import OpenPair

# With these the base frame is determined, and a bad pair can be told.
WANTED = 5


def hint_at_rest(reason: Optional[str]) -> str:
    """
    Say what to do before pairs are measured.

    :param reason: Why that is not possible; None if it is.
    """
    return reason or 'Start, and put an object down.'


def hint_for_open(pair: OpenPair) -> str:
    """Say what to do with the object of a pair."""
    if pair.place is None:
        return 'The object is measured: leave it alone.'
    return 'Touch its middle with the robot, and type x and y as its display shows them.'


def hint_for_pairs(count: int, next_number: int, is_accepted: bool) -> str:
    """
    Say what to do between two pairs.

    :param count: Number of pairs that are measured.
    """
    if is_accepted:
        return 'Save the calibration.'
    if count < WANTED:
        return (f'{count} of {WANTED} pairs are there: put an object down for pair '
                f'{next_number}, and click it.')
    return 'Accept the fit, or measure further pairs.'
