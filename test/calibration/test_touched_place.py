# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The position of an object at rest, from several frames."""

from camera_to_base.calibration.base import measured_place
from camera_to_base.errors import CalibrationError
import numpy as np
import pytest


def frames(count=20, point=(3.0, 4.0), noise=0.005):
    random = np.random.default_rng(1)
    return [[tuple(point + random.normal(0, noise, 2))] for _ in range(count)]


def test_mean_and_spread_are_those_of_the_frames():
    place = measured_place([[(1.0, 2.0)], [(1.0, 2.02)], [(1.0, 1.98)]])
    assert (place.x, place.y, place.frame_count) == (1.0, pytest.approx(2.0), 3)
    assert place.spread_cm == pytest.approx(0.02 * np.sqrt(2 / 3))


def test_a_few_frames_without_the_object_do_no_harm():
    place = measured_place(frames(16) + [[]] * 4)
    assert place.frame_count == 16 and place.x == pytest.approx(3.0, abs=0.01)


@pytest.mark.parametrize('seen, said', [
    ([[]] * 20, '20 of 20 frames show no object'),
    (frames(13) + [[]] * 7, '7 of 20 frames show no object'),
    (frames(19) + [[(3.0, 4.0), (9.0, 9.0)]], '2 objects are in the picture: leave only one'),
    (frames(10) + frames(10, (3.4, 4.0)), r'spread by 2.0 mm, allowed are 1 mm')])
def test_what_is_no_place_is_refused_with_what_to_do(seen, said):
    with pytest.raises(CalibrationError, match=said):
        measured_place(seen)
