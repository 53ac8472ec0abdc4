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

from camera_to_base.sources.freshness import Freshness
import pytest


def judge(freshness, waits, now=100.0):
    """Judge frames read one right after another, each after so long a wait, in s."""
    fresh = []
    for wait in waits:
        fresh.append(freshness.is_fresh(now, now + wait))
        now += wait
    return fresh


@pytest.mark.parametrize('rate', [0.5, 2.0, 5.0, 20.0, 60.0, 100.0])
def test_steady_camera_is_fresh_after_a_few_frames(rate):
    assert all(judge(Freshness(), [1 / rate] * 40)[3:])


@pytest.mark.parametrize('rate', [165, 170, 200, 300, 500, 1000])
def test_camera_of_any_rate_is_fresh_after_3_s(rate):
    fresh = judge(Freshness(), [1 / rate] * 10 * rate)
    assert all(fresh[3 * rate:])


def test_what_a_fast_stream_gathered_in_a_stall_is_old():
    freshness = Freshness()
    assert judge(freshness, [0.005] * 1000)[-1]
    later = judge(freshness, [2.0] + [0.0005] * 400 + [0.005] * 40, now=105.0)
    assert not any(later[:401]) and later[-1]


def test_frames_that_were_gathered_while_a_stream_was_opened_are_old():
    # Measured: an RTSP stream at 20 Hz, 21 frames gathered, one of them slow to decode.
    waits = [0.004, 0.001, 0.001, 0.004, 0.004, 0.023] + [0.001] * 15
    assert judge(Freshness(), waits + [0.05] * 4) == [False] * 22 + [True] * 3


def test_frames_that_came_while_nobody_read_are_old():
    freshness = Freshness()
    assert judge(freshness, [0.05] * 20)[-1]
    # The reader was held up for 2 s; 40 frames lay in the socket.
    later = judge(freshness, [0.003] * 40 + [0.05] * 3, now=103.0)
    assert not any(later[:40]) and later[-1]


def test_first_frame_after_the_network_has_stalled_is_old():
    freshness = Freshness()
    judge(freshness, [0.05] * 20)
    later = judge(freshness, [2.0] + [0.001] * 40 + [0.05] * 3, now=101.0)
    assert not any(later[:41]) and later[-1]


def test_reader_that_is_slower_than_the_camera_has_old_frames_only():
    fresh = judge(Freshness(), [0.05] * 10 + [0.005] * 200)
    assert fresh[9] and not any(fresh[60:])


def test_stream_that_is_opened_anew_is_not_trusted_at_once():
    freshness = Freshness()
    judge(freshness, [0.05] * 20)
    freshness.restart()
    assert judge(freshness, [0.001] * 5, now=200.0) == [False] * 5


def test_old_frames_that_a_busy_machine_is_slow_to_read_are_not_taken_for_new_ones():
    freshness = Freshness()
    assert judge(freshness, [0.05] * 20)[-1]
    # Measured, with eight programs for two processors: what lay in the socket took 10 to 17 ms.
    later = judge(freshness, [0.010, 0.013, 0.017, 0.012] * 7 + [0.05] * 3, now=102.4)
    assert not any(later[:28]) and later[-1]


@pytest.mark.parametrize('before, after', [(20.0, 60.0), (100.0, 5.0), (10.0, 100.0), (5.0, 0.5)])
def test_camera_that_changes_its_rate_is_fresh_again_within_3_s(before, after):
    freshness = Freshness()
    judge(freshness, [1 / before] * 20)
    later = judge(freshness, [1 / after] * 400, now=100 + 20 / before)
    assert all(later[max(10, round(3 * after)):])
