# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import itertools

from camera_to_base.sources.status import SilenceLimit
import pytest


def limit_after(*intervals):
    """Tell what the limit is after pictures that came at these intervals, in s."""
    limit = SilenceLimit()
    for arrived_at in itertools.accumulate(intervals, initial=100.0):
        limit.note(arrived_at)
    return limit.seconds


def test_camera_that_nothing_is_known_about_is_lost_after_a_second():
    assert SilenceLimit().seconds == limit_after() == 1.0


@pytest.mark.parametrize('interval, expected', [
    (0.005, 1.0), (0.1, 1.0), (0.4, 1.0), (1.0, 2.5), (2.0, 5.0), (4.0, 10.0), (60.0, 10.0)])
def test_limit_is_two_and_a_half_intervals_from_1_to_10_s(interval, expected):
    assert limit_after(*[interval] * 8) == pytest.approx(expected)


def test_one_interval_is_enough_for_a_slow_camera():
    assert limit_after(2.0) == 5.0


@pytest.mark.parametrize('before', [1, 3, 9])
def test_silence_does_not_make_a_fast_camera_slow(before):
    assert limit_after(*[0.03] * before, 60.0) == 1.0
    assert limit_after(*[0.03] * before, 60.0, 0.03) == 1.0


def test_camera_that_becomes_faster_or_slower_is_followed_within_three_pictures():
    assert limit_after(*[2.0] * 8, *[0.03] * 3) == 1.0
    assert limit_after(*[0.03] * 8, *[2.0] * 3) == 5.0
