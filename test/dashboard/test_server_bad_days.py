# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""What a page is told when something is wrong: nodes that are missing or die, slow pages."""

import asyncio
import json
import time

from camera_to_base.dashboard.server.pictures import Line, Picture
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
import cv2
from dashboard_client import DashboardClient
import numpy as np
import pytest
from ros_helpers import assert_in_time, SIMULATED_CELL
from slow_line import SlowLine

SIMULATED = ('-p', 'source:=simulated')


def silence_comes(ros, page, reason):
    """Wait until the page tells that nothing is published for a reason; return the sentence."""
    ros.spin_until(lambda: (page.parts.get('watch', {}).get('state') or {}).get(
        'reason') == reason)
    return page.parts['watch']['state']['sentence']


def has_reported(page):
    """Tell whether the camera node has: of one that never did, nobody can say that it hangs."""
    nodes = page.parts.get('health', {}).get('nodes', [])
    return any('camera_publisher' in one['name'] and one['reason'] != 'no_report' for one in nodes)


@pytest.mark.slow
def test_a_node_that_was_never_started_is_named_with_its_command(ros, dashboard):
    page = dashboard()
    page.look()
    sentence = silence_comes(ros, page, 'not_running')
    assert 'ros2 run camera_to_base camera_publisher' in sentence
    assert page.parts['cells'] == [{'cell': '/'}]
    status, answer = page.post(
        '/api/parameters?cell=/', {'node': 'camera', 'values': {'detector.threshold': 70}})
    assert status == 409 and 'does not run' in answer['error']
    status, answer = page.post('/api/background?cell=/', {})
    assert status == 409 and 'does not run' in answer['error']


@pytest.mark.slow
@pytest.mark.flaky(reruns=2, only_rerun=['NotInTime'])
def test_a_node_that_dies_is_told_and_one_that_comes_back_is_found(ros, start, dashboard):
    ros.add(RobotBasePublisher)
    page = dashboard()
    page.look()
    arguments = (*SIMULATED, '-p', 'detector.threshold:=70')
    camera = start('camera_publisher', *arguments)
    ros.spin_until(lambda: page.parts.get('watch', {}).get('objects') and has_reported(page))
    camera.kill()
    # The graph tells of a node that was killed when its lease has ended, after 20 s.
    silence_comes(ros, page, 'node_hangs')
    assert page.parts['watch']['objects'] == []
    start('camera_publisher', *SIMULATED)
    ros.spin_until(lambda: page.parts['watch']['objects'] and page.parts['watch'][
        'state']['reason'] in ('ok', 'not_calibrated'))
    ros.spin_until(lambda: any(
        (one['name'], one['value']) == ('detector.threshold', 95)
        for one in page.parts['parameters']['camera']))


@pytest.mark.slow
def test_a_node_that_ends_is_told(ros, dashboard):
    camera = ros.add(CameraPublisher, *SIMULATED)
    page = dashboard()
    page.look()
    ros.spin_until(lambda: page.parts.get('watch', {}).get('objects')
                   and page.parts['parameters']['camera'])
    ros.executor.remove_node(camera)
    camera.destroy_node()
    assert 'has ended' in silence_comes(ros, page, 'node_ended')
    ros.spin_until(lambda: page.parts['parameters']['camera'] == [])


@pytest.mark.slow
def test_a_camera_that_is_not_there_is_told_in_the_words_of_its_node(ros, dashboard):
    ros.add(CameraPublisher, '-p', 'source:=/dev/video99')
    page = dashboard()
    page.look()
    assert '/dev/video99' in silence_comes(ros, page, 'camera_waiting')
    assert page.parts['watch']['state']['level'] == 'error'


def test_without_the_transform_node_camera_positions_are_shown_alone(ros, dashboard):
    ros.add(CameraPublisher, *SIMULATED)
    page = dashboard()
    page.look()
    ros.spin_until(lambda: page.parts.get('watch', {}).get('objects'))
    assert 'robot_base_publisher' in silence_comes(ros, page, 'transform_not_running')
    assert page.parts['watch']['objects'][0]['base'] is None


@pytest.mark.slow
def test_random_positions_are_shown_with_a_warning(ros, dashboard):
    ros.add(CameraPublisher, '-p', 'source:=random', '-p', 'period:=0.2')
    ros.add(RobotBasePublisher)
    page = dashboard()
    page.look()
    ros.spin_until(
        lambda: page.parts.get('watch', {}).get('state', {}).get('reason') == 'random')
    assert 'RANDOM' in page.parts['watch']['state']['sentence']


@pytest.mark.slow
def test_a_page_that_does_not_read_gets_the_newest_picture_when_it_does(ros, dashboard):
    ros.add(CameraPublisher, *SIMULATED)
    page = dashboard()
    slow = page.socket('/ws/picture?cell=/&kind=annotated')
    page.send(slow, 'next')
    ros.spin_for(3.0)
    page.read(slow)
    # The one that came while it did not ask is not sent; neither are those that waited.
    begin = time.monotonic()
    for _ in range(3):
        page.send(slow, 'next')
        assert page.read(slow)
    assert_in_time(time.monotonic() - begin, 2.0)
    page.send(slow, 'next')
    page.send(slow, 'next')
    assert page.read(slow)


@pytest.mark.parametrize('content', [b'{', b'[]', b'"text"', b'\xff\xfe', b'{"node": "camera"}',
                                     b'{"node": "arm", "values": {"a": 1}}',
                                     b'{"node": "camera", "values": 3}'])
def test_a_request_without_sense_is_refused_in_one_sentence(dashboard, content):
    status, answer = dashboard().post('/api/parameters?cell=/', content)
    assert status == 400 and answer['error'].startswith('expected ')


def test_a_cell_without_a_proper_name_is_refused(dashboard):
    status, answer = dashboard().post('/api/background?cell=../etc', {})
    assert status == 400 and 'namespace' in answer['error']


@pytest.mark.slow
def test_cells_that_somebody_has_invented_are_few_and_forgotten(ros, dashboard):
    page = dashboard()
    sockets = [page.socket(f'/ws/state?cell=/invented_{number}') for number in range(16)]
    more = page.socket('/ws/state?cell=/one_more')
    while page.read(more) is not None:
        pass
    assert more.close_code == 1008 and 'close a page' in more.close_reason
    sessions = page.node._sessions._sessions
    # The node's thread makes them, when it is its turn.
    ros.spin_until(lambda: len(sessions) == 16)
    for one in sockets:
        page.close_socket(one)
    ros.spin_until(lambda: not sessions)
    again = page.socket('/ws/state?cell=/one_more')
    assert page.read(again) is not None


@pytest.mark.slow
def test_a_slow_network_gets_small_pictures_with_their_true_age(ros, dashboard, tell):
    ros.add(CameraPublisher, *SIMULATED, *SIMULATED_CELL)
    page = dashboard()
    line = SlowLine(int(page.origin.rpartition(':')[2]), 30_000)
    slow = DashboardClient(ros, f'http://localhost:{line.port}')
    try:
        began = time.monotonic()
        states = slow.socket('/ws/state?cell=/&confirms=yes')
        pictures = slow.socket('/ws/picture?cell=/&kind=annotated&adapts=yes')
        told, shown = [], []

        async def confirm():
            while await states.read_message() is not None:
                await states.write_message('got')

        async def look():
            while time.monotonic() < began + 10.0:
                await pictures.write_message('next')
                told.append(json.loads(await pictures.read_message()))
                await pictures.read_message()
                shown.append(time.monotonic())

        asyncio.run_coroutine_threadsafe(confirm(), slow._loop)
        slow.run(look(), 40.0)
    finally:
        slow.close()
        line.close()
    ages = [one['age_ms'] for one in told[2:]]
    tell(f'30 kB/s: first picture after {shown[0] - began:.1f} s, {len(shown)} pictures in 10 s, '
         f'at most {max(ages) / 1e3:.1f} s old')
    assert shown[0] - began < 3.0 and len(shown) >= 8
    assert all(one.get('width', 640) == 640 for one in told) and 0 < min(ages)


def test_a_page_that_confirms_nothing_gets_a_few_messages_and_then_the_newest(ros, dashboard):
    ros.add(CameraPublisher, *SIMULATED)
    page = dashboard()
    silent = page.socket('/ws/state?cell=/&confirms=yes')
    before = [json.loads(page.read(silent)) for _ in range(6)]
    ros.spin_for(2.0)
    page.send(silent, 'got')
    newest = json.loads(page.read(silent))
    assert len(before) == 6 and newest['part']


def test_the_size_of_pictures_follows_the_network(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(time, 'monotonic', lambda: now[0])
    jpeg = cv2.imencode('.jpg', np.zeros((480, 640, 3), np.uint8))[1].tobytes()
    line, sizes = Line(), []
    for took_s in (0.1, 0.1, 0.1, 2.0, 2.0, 0.5, 0.1):
        content, told = line.sent(Picture(1, jpeg, time.time() - 0.25))
        assert 250 <= told['age_ms'] < 3000
        sizes.append(cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR).shape[1])
        now[0] += took_s
        line.arrived()
    assert sizes == [160, 320, 640, 640, 320, 160, 160]


def test_a_size_that_was_too_slow_is_tried_again_after_a_while_only(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(time, 'monotonic', lambda: now[0])
    jpeg = cv2.imencode('.jpg', np.zeros((480, 640, 3), np.uint8))[1].tobytes()
    line, sizes = Line(), []
    for _ in range(70):
        content, _ = line.sent(Picture(1, jpeg))
        sizes.append(cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR).shape[1])
        now[0] += 3.0 if sizes[-1] == 640 else 0.2
        line.arrived()
    assert sizes[:4] == [160, 320, 640, 320]
    assert 640 not in sizes[3:50] and sizes[50:].count(640) == 1
