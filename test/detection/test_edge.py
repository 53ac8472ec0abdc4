# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.detection import Box, touches_edge
import numpy as np
import pytest

PICTURE = np.zeros((48, 64, 3), np.uint8)


@pytest.mark.parametrize('box', [
    Box(0, 20, 5, 5), Box(20, 0, 5, 5), Box(59, 20, 5, 5), Box(20, 43, 5, 5)])
def test_box_that_holds_an_outermost_pixel_touches_the_edge(box):
    assert touches_edge(box, PICTURE)


@pytest.mark.parametrize('box', [
    Box(1, 20, 5, 5), Box(20, 1, 5, 5), Box(58, 20, 5, 5), Box(20, 42, 5, 5)])
def test_box_one_pixel_inside_does_not_touch_the_edge(box):
    assert not touches_edge(box, PICTURE)
