# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""
Random days over the pipeline: nothing wrong is published, and no silence lasts for ever.

RANDOM_DAYS=1000 plays as many more days, from number RANDOM_DAY on; a failure prints its day.
"""

import os

import pytest
from random_day import Day, Event, play, random_day, shrunk

MORE_DAYS = int(os.environ.get('RANDOM_DAYS', '200'))
FIRST_DAY = int(os.environ.get('RANDOM_DAY', '5'))

# Days that went wrong once, without the events that they did not need.
SMALL_DAYS = {
    'edge of an object that has moved in a patch of sun was taken for a texture': Day(163, (
        Event('put', 0.5, 806641), Event('leave', 1.33, 259388), Event('patch', 2.0, 850626),
        Event('leave', 3.98, 107378))),
    'neighbour that is parted from an object in the third turn only': Day(141, (
        Event('put', 0.5, 736296), Event('neighbour', 1.02, 687924))),
    'camera that is put back after a corrected bump': Day(2029, (
        Event('put', 0.5, 799117), Event('bump', 1.46, 606644), Event('take', 3.91, 155033),
        Event('hand', 4.33, 786244), Event('light', 6.0, 667332), Event('put', 6.01, 765870),
        Event('hand', 7.22, 910475), Event('hand', 9.97, 625919))),
    'arm that the nudged background cuts off from the edge': Day(114, (
        Event('move', 2.71, 715923), Event('put', 8.3, 317131), Event('hand', 8.74, 214057),
        Event('bump', 9.45, 996621))),
    'camera that swings was not moved back under two arms': Day(24, (
        Event('hand', 10.03, 619925), Event('wobble', 10.11, 802939),
        Event('hand', 10.2, 626358))),
    'camera that swings far was not moved back': Day(62, (Event('wobble', 14.23, 514338),)),
    'object of the background moves by less than its width': Day(1053, (
        Event('put', 5.9, 831669), Event('retake', 6.36, 799026), Event('move', 12.28, 558226))),
    'fist hides a disc of its size': Day(2092, (
        Event('put', 0.5, 736598), Event('put', 3.57, 673465), Event('put', 5.35, 838231),
        Event('put', 7.32, 94278), Event('take', 9.21, 340423), Event('take', 14.93, 738991))),
    'object that has left a table with a strong pattern was seen in parts': Day(9262, (
        Event('put', 0.5, 573268), Event('put', 1.99, 611848), Event('bump', 2.56, 454637),
        Event('hand', 2.64, 21916), Event('put', 2.95, 464545), Event('bump', 4.48, 747188),
        Event('move', 5.5, 701363))),
    'patch of sun that saturates has no edge to a white sheet': Day(417, (
        Event('put', 0.5, 952808), Event('light', 6.17, 854125), Event('patch', 10.72, 223882),
        Event('sheet', 12.79, 286085))),
    'dark half of an object at the edge of a patch of sun was taken for shade': Day(16, (
        Event('put', 0.5, 566916), Event('put', 1.26, 754417), Event('patch', 5.18, 955669))),
}


def check(day):
    failure, count = play(day)
    if failure is not None:
        small = shrunk(day, failure.kind)
        pytest.fail(f'{failure}\nof {day}\nshrunk to {small}: {play(small)[0]}')
    return count


@pytest.mark.slow
@pytest.mark.parametrize('day', SMALL_DAYS.values(), ids=SMALL_DAYS)
def test_day_that_went_wrong_once_goes_well(day):
    check(day)


@pytest.mark.parametrize('seed', range(5))
def test_random_day_has_no_wrong_point_and_no_lasting_silence(seed, tell):
    tell(f'random day {seed}: {check(random_day(seed))} points')


@pytest.mark.slow
@pytest.mark.parametrize('part', range(4))
def test_many_random_days_have_no_wrong_point_and_no_lasting_silence(part, tell):
    seeds = range(FIRST_DAY + part, FIRST_DAY + MORE_DAYS, 4)
    count = sum(check(random_day(seed)) for seed in seeds)
    tell(f'random days {seeds[0]}, {seeds[0] + 4}, ... {seeds[-1]}: {count} points')


@pytest.mark.slow
def test_day_fails_where_a_hand_is_published(monkeypatch):
    monkeypatch.setattr(
        'camera_to_base.pipeline.arms._leaves_out_cut_off', lambda settings: False)
    day = Day(3, tuple(Event('hand', 2.0 + number, number) for number in range(12)))
    failure, _ = play(day)
    assert failure.kind == 'wrong'
    assert 1 <= len(shrunk(day, 'wrong').events) < 12
