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

from camera_to_base.background_taker import BackgroundTaker
import numpy as np


def frame(level, shape=(6, 8, 3)):
    return np.full(shape, level, np.uint8)


def test_background_of_one_frame_is_that_frame():
    assert (BackgroundTaker(1).add(frame(7)) == 7).all()


def test_background_is_the_median_so_that_what_passes_is_not_in_it():
    taker = BackgroundTaker(5)
    assert [taker.add(frame(level)) for level in (100, 101, 20, 99)] == [None] * 4
    background = taker.add(frame(102))
    assert (background == 100).all()
    assert background.shape == (6, 8, 3) and background.dtype == np.uint8


def test_frame_of_another_size_begins_anew():
    taker = BackgroundTaker(2)
    assert taker.add(frame(1)) is None
    assert taker.add(frame(50, (3, 4, 3))) is None
    assert (taker.add(frame(50, (3, 4, 3))) == 50).all()
