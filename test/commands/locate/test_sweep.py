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

from dataclasses import replace

from camera_to_base.commands.locate.sweep import sweep, sweep_lines, sweep_range
from camera_to_base.commands.locate.sweep_picture import sweep_picture
from camera_to_base.errors import InvalidValueError
from camera_to_base.settings.node_settings import read_node_settings
from camera_to_base.sources.recording import TimedFrame
import numpy as np
import pytest
from recordings import disc_frame

SETTINGS = read_node_settings(None).camera
TUTORIAL = replace(SETTINGS, detector=replace(SETTINGS.detector, method='tutorial'))
# Three frames without a disc, two with one, one with two of them.
SCENES = [None, None, None, (60, 60), (200, 60), [(60, 60), (200, 150)]]


def frames():
    return [TimedFrame(number, 0, lambda scene=scene: disc_frame(scene))
            for number, scene in enumerate(SCENES)]


@pytest.mark.parametrize('text, name, values', [
    ('threshold=40:120:40', 'threshold', [40, 80, 120]),
    ('threshold=40:100:40', 'threshold', [40, 80]),
    ('min_area_cm2=0:0.3:0.1', 'min_area_cm2', [0, 0.1, 0.2, 0.3])])
def test_range_reaches_its_last_value_where_the_steps_meet_it(text, name, values):
    assert sweep_range(text) == (name, values)


@pytest.mark.parametrize('text', [
    'threshold', 'threshold=', 'threshold=40:120', 'threshold=a:b:c', 'treshold=40:120:10',
    'publish_cut_off=0:1:1', 'threshold=1:2:nan', 'threshold=40:120:10:5'])
def test_range_in_another_form_is_refused_with_the_form(text):
    with pytest.raises(InvalidValueError, match=f"NAME=FIRST:LAST:STEP .*got '{text}'"):
        sweep_range(text)


@pytest.mark.parametrize('text', [
    'threshold=40:40:10', 'threshold=120:40:10', 'threshold=1:2:0', 'threshold=1:9:-1',
    'threshold=0:255:0.1'])
def test_range_of_too_few_or_too_many_values_is_refused(text):
    with pytest.raises(InvalidValueError, match='must have 2 to 100 values'):
        sweep_range(text)


@pytest.mark.parametrize('settings, text, name, now, values, counts', [
    (SETTINGS, 'threshold=40:200:80', 'faintest', 13.0, [40, 120, 200],
     [(2, 1), (2, 1), (0, 0)]),
    (TUTORIAL, 'threshold=40:200:80', 'threshold', 95, [40, 120, 200], [(2, 1), (2, 1), (0, 0)]),
    (TUTORIAL, 'median_size=1:5:2', 'median_size', 5, [1, 3, 5], [(2, 1)] * 3),
    (SETTINGS, 'max_area_cm2=1:100:99', 'max_area_cm2', 1e6, [1, 100], [(0, 0), (2, 1)])])
def test_each_value_is_tried_on_the_same_frames(settings, text, name, now, values, counts):
    result = sweep(settings, sweep_range(text), frames())
    assert (result.name, result.current) == (f'detector.{name}', now)
    assert result.values == values
    assert [(counter.with_one, counter.with_more) for counter in result.counters] == counts
    header, *lines = sweep_lines(result)
    assert {len(line) for line in lines} == {len(header)} and f'(now {now:g})' in header
    for line, value, (one, more) in zip(lines, values, counts):
        assert line.split() == [f'{value:g}', str(6 - one - more), str(one), str(more)]


@pytest.mark.parametrize('settings, text, said', [
    (SETTINGS, 'closing_size=5:9:2', 'closing_size has no effect with detector.method precise'),
    (TUTORIAL, 'faintest=5:9:2', 'has no effect with detector.method tutorial'),
    (TUTORIAL, 'median_size=1:4:1', '2'), (TUTORIAL, 'threshold=250:260:5', '260'),
    (TUTORIAL, 'threshold=40:41:0.5', '40.5')])
def test_value_that_cannot_be_used_is_refused(settings, text, said):
    with pytest.raises(InvalidValueError, match=said):
        sweep(settings, sweep_range(text), frames())


# matplotlib's first, second and fourth colour, as blue, green and red.
ANY, ONE, NOW = (180, 119, 31), (14, 127, 255), (40, 39, 214)


def places(picture, colour):
    """Return the v and u of the pixels of a colour."""
    return np.nonzero((picture == colour).all(axis=2))


def test_picture_shows_both_curves_and_the_current_value():
    result = sweep(SETTINGS, sweep_range('threshold=20:200:20'), frames())._replace(current=45.0)
    picture = sweep_picture(result)
    any_v, any_u = places(picture, ANY)
    one_v, one_u = places(picture, ONE)
    _, now_u = places(picture, NOW)
    assert picture.shape == (540, 960, 3) and any_v.size and one_v.size
    # Three frames have any object, two exactly one; at the last value both curves are at 0.
    bottom = one_v.max()
    chart = one_u < 700  # left of the legend
    assert (bottom - one_v[chart].min()) / (bottom - any_v[any_u < 700].min()) == pytest.approx(
        2 / 3, abs=0.05)
    left, right = one_u.min(), one_u.max()
    assert np.median(now_u) == pytest.approx(left + (right - left) * (45 - 20) / 180, abs=6)
    beyond = sweep_picture(result._replace(current=300.0))
    assert not places(beyond, NOW)[0].size
