# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.checks import check_image_size
from camera_to_base.errors import InvalidValueError
import pytest


def test_image_size_comes_back_as_two_whole_numbers():
    assert check_image_size([640.0, 480]) == (640, 480)


@pytest.mark.parametrize('image_size', [(), (640,), (640, 480, 3), (0, 480), (640, -1),
                                        (640.5, 480)])
def test_image_size_that_is_none_is_refused(image_size):
    with pytest.raises(InvalidValueError, match='image_size'):
        check_image_size(image_size)
