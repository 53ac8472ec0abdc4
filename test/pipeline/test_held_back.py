# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import time

from camera_to_base.errors import Level, Reason
from camera_to_base.pipeline.sighting import HeldBack
import pytest

JUMP, LATE = (Reason(kind, Level.WARN, kind, is_passing=True) for kind in ('jump', 'late'))
MOVED = Reason('moved', Level.ERROR, 'the view has moved')


@pytest.fixture
def shown(monkeypatch):
    """Record frames, 0.1 s apart, and give the kind that is shown after each."""
    now = 100.0
    monkeypatch.setattr(time, 'monotonic', lambda: now)
    held_back = HeldBack()

    def note(*reasons):
        nonlocal now
        kinds = []
        for reason in reasons:
            now += 0.1
            held_back.note(reason)
            kinds.append(held_back.reason and held_back.reason.kind)
        return kinds
    return note


def test_reason_that_passes_is_shown_after_a_second(shown):
    assert shown(*[JUMP] * 9) == [None] * 9
    assert shown(*[JUMP] * 3)[-1] == 'jump'
    assert shown(None, JUMP) == [None, None]


def test_reason_that_stays_is_shown_at_once(shown):
    assert shown(MOVED, MOVED, None) == ['moved', 'moved', None]


def test_one_of_two_reasons_that_take_turns_is_shown_all_the_time(shown):
    kinds = shown(*[JUMP, LATE] * 20)[12:]
    assert len(set(kinds)) == 1 and None not in kinds


def test_reason_that_comes_no_more_gives_way_to_the_one_that_does(shown):
    assert shown(*[JUMP] * 15)[-1] == 'jump'
    assert shown(*[LATE] * 5)[-1] == 'jump'
    assert shown(*[LATE] * 7)[-1] == 'late'


def test_reason_that_passes_waits_for_a_second_after_one_that_stays(shown):
    assert shown(MOVED, *[JUMP] * 9) == ['moved', *[None] * 9]
    assert shown(*[JUMP] * 3)[-1] == 'jump'
