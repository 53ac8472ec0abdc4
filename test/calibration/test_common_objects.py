# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Objects that two cameras see are found by their distances; what is not clear is said."""

from camera_to_base.calibration import resting_places, shared_places, SharedPlace
from camera_to_base.errors import CalibrationError
import numpy as np
import pytest

OBJECTS = [(1.0, 2.0), (14.0, 3.5), (25.0, 1.0), (23.0, 17.0), (4.0, 19.0), (12.0, 9.0)]
TURN, SHIFT = 0.7, np.array([-17.8, 24.4])


def in_base(points, random=None):
    """Return points of the camera frame in the base frame, whose z points the other way."""
    turned = np.array([[np.cos(TURN), np.sin(TURN)], [np.sin(TURN), -np.cos(TURN)]])
    moved = np.reshape(points, (-1, 2)) @ turned.T + SHIFT
    if random is not None:
        moved = moved + random.normal(0, 0.03, moved.shape)
    return [tuple(point) for point in moved.tolist()]


def test_objects_are_paired_whatever_their_order_and_whatever_else_is_seen():
    random = np.random.default_rng(1)
    for _ in range(20):
        here = [OBJECTS[index] for index in random.permutation(6)]
        there = in_base([*OBJECTS[1:], (30.0, 30.0)], random)
        random.shuffle(there)
        found = shared_places(here, there, True)
        assert sorted(place.camera_point for place in found) == sorted(OBJECTS[1:])
        for place in found:
            np.testing.assert_allclose(
                place.base_point, in_base([place.camera_point])[0], atol=0.15)


def test_later_objects_are_paired_by_the_earlier_ones_and_none_twice():
    known = [SharedPlace(*pair) for pair in zip(OBJECTS[:4], in_base(OBJECTS[:4]))]
    new = [(7.0, 14.0), OBJECTS[0]]
    found = shared_places(new, in_base(new)[::-1], True, known)
    assert [place.camera_point for place in found] == [(7.0, 14.0)]


def test_too_few_common_objects_are_said():
    with pytest.raises(CalibrationError, match='3 objects of the 4 .* needed are 4'):
        shared_places(OBJECTS[:4], in_base([*OBJECTS[:3], (40.0, 40.0)]), True)
    with pytest.raises(CalibrationError, match='0 objects of the 1'):
        shared_places(OBJECTS[:1], in_base(OBJECTS[:1]), True)


def test_an_even_pattern_is_not_guessed():
    even = [(0.0, 0.0), (20.0, 0.0), (20.0, 12.0), (0.0, 12.0), (10.0, 6.0)]
    with pytest.raises(CalibrationError, match='several ways: move one of them'):
        shared_places(even, in_base(even), True)
    assert len(shared_places(even[1:], in_base(even[1:]), True)) == 4


def test_frames_seen_from_the_same_side_are_not_paired_as_from_the_other():
    with pytest.raises(CalibrationError, match='same distances'):
        shared_places(OBJECTS, in_base(OBJECTS), False)


def test_objects_at_rest_are_the_means_and_one_that_moves_is_named():
    random = np.random.default_rng(2)
    frames = [[(x + random.normal(0, 0.01), y) for x, y in OBJECTS] for _ in range(20)]
    frames[3], frames[7] = frames[3][:2], []  # a passing shadow
    frames[9] = [*frames[9], (40.0, 5.0)]  # a reflection
    np.testing.assert_allclose(resting_places(frames), OBJECTS, atol=0.02)
    frames[12] = [(1.4, 2.0), *frames[12][1:]]
    frames[13] = [(1.5, 2.0), *frames[13][1:]]
    with pytest.raises(CalibrationError, match='has moved'):
        resting_places(frames)
    with pytest.raises(CalibrationError, match='no object lies still'):
        resting_places([[]] * 20)
