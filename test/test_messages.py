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

import math

from camera_to_base.errors import InvalidValueError
from camera_to_base.messages import position_from_message, position_message
import pytest
from std_msgs.msg import Float64MultiArray


def test_position_comes_back_as_it_went_in():
    assert position_from_message(position_message(1.25, -7.5)) == (1.25, -7.5)


def test_message_holds_x_and_y_and_no_layout():
    message = position_message(1.25, -7.5)
    assert list(message.data) == [1.25, -7.5]
    assert message.layout == Float64MultiArray().layout


def test_further_numbers_are_left_alone():
    assert position_from_message(Float64MultiArray(data=[1.0, 2.0, 3.0])) == (1.0, 2.0)


@pytest.mark.parametrize('data', [
    [], [1.0], [math.nan, 1.0], [1.0, math.nan], [math.inf, 1.0], [1.0, -math.inf]])
def test_what_is_no_position_is_refused(data):
    with pytest.raises(InvalidValueError):
        position_from_message(Float64MultiArray(data=data))


def test_message_of_far_too_many_numbers_is_refused():
    assert position_from_message(Float64MultiArray(data=[1.0] * 16)) == (1.0, 1.0)
    with pytest.raises(InvalidValueError, match='1000000 numbers'):
        position_from_message(Float64MultiArray(data=[1.0] * 10**6))
