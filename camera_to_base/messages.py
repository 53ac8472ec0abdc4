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

"""The only place where ROS messages become numbers and numbers become messages."""

import math
from typing import Tuple

from camera_to_base.errors import InvalidValueError
from std_msgs.msg import Float64MultiArray

# A position has two numbers, or a few more; a message of thousands was meant for another topic.
MOST_NUMBERS = 16


def position_message(x: float, y: float) -> Float64MultiArray:
    """
    Make the message of both tutorial topics.

    :param x: In cm.
    :param y: In cm.
    """
    return Float64MultiArray(data=[x, y])


def position_from_message(message: Float64MultiArray) -> Tuple[float, float]:
    """
    Read a message of either tutorial topic.

    Numbers after the first two are left alone, as the tutorial leaves them.

    :returns: x and y, in cm.
    :raises InvalidValueError: If it does not start with two finite numbers, or has far too many.
    """
    if len(message.data) > MOST_NUMBERS:
        raise InvalidValueError(f'expected [x, y] in cm, got {len(message.data)} numbers')
    position = tuple(message.data[:2])
    if len(position) < 2:
        raise InvalidValueError(f'expected [x, y] in cm, got {len(position)} number(s)')
    if not all(math.isfinite(value) for value in position):
        raise InvalidValueError(f'expected two finite numbers in cm, got {list(position)}')
    return position
