# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.pipeline.view.view_stage import Pace
import pytest

STEP_S = 1 / 30


class Frames:
    """Frames that are held back, each comparison at the same cost."""

    def __init__(self, cost_s):
        self._cost_s, self._time_s, self._now = cost_s, 50.0, 7.0
        self._pace = Pace(lambda: self._time_s)

    def see(self, count, is_held_back=True, may_be_corrected=False, has_time=True):
        """Return which of the frames are compared."""
        return [self._see_one(is_held_back, may_be_corrected, has_time) for _ in range(count)]

    def _see_one(self, is_held_back, may_be_corrected, has_time):
        self._now += STEP_S
        is_turn = self._pace.begin(self._now if has_time else None)
        if is_turn:
            self._time_s += self._cost_s
        self._pace.end(is_held_back=is_held_back, may_be_corrected=may_be_corrected)
        return is_turn


@pytest.mark.parametrize('cost_s, most_share', [(0.005, 0.2), (0.02, 0.25), (0.1, 0.26)])
def test_comparisons_take_at_most_a_quarter_of_the_time(cost_s, most_share):
    compared = Frames(cost_s).see(900)
    assert 0.1 < sum(compared) * cost_s / (900 * STEP_S) <= most_share


def test_no_rest_is_longer_than_half_a_second():
    compared = Frames(2.0).see(900)
    turns = [number for number, is_turn in enumerate(compared) if is_turn]
    assert max(after - before for before, after in zip(turns, turns[1:])) <= 2.5 / STEP_S + 1


def test_first_frame_that_is_held_back_is_compared():
    frames = Frames(0.1)
    assert frames.see(5) == [True] + 4 * [False]
    frames.see(1, is_held_back=False)
    assert frames.see(1) == [True]


def test_nudge_is_compared_eight_times_in_a_row_and_then_twice_after_each_rest():
    compared = Frames(0.05).see(40, may_be_corrected=True)
    rows = ''.join('x' if is_turn else ' ' for is_turn in compared).split()
    assert [len(row) for row in rows[:-1]] == [8] + [2] * (len(rows) - 2)
    assert sum(compared) >= 14


def test_frame_that_stands_for_itself_is_compared():
    assert all(Frames(0.1).see(20, has_time=False))
