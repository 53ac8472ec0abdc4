# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""The steps of a calibration as a page asks for them, with real nodes."""

import asyncio
import errno
import os

from camera_to_base import files
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
import cv2
import numpy as np
import pytest
from rcl_interfaces.msg import SetParametersResult
from tornado.httpclient import AsyncHTTPClient, HTTPRequest

SIMULATED = ('-p', 'source:=simulated', '-p', 'simulated.frame_rate:=30.0')


@pytest.fixture
def cell(ros):
    """Start both nodes of a cell in the test's executor."""
    return (ros.add(CameraPublisher, *SIMULATED), ros.add(RobotBasePublisher))


@pytest.fixture
def page(ros, dashboard, cell, tmp_path):
    """Open a page that knows both nodes' parameters."""
    page = dashboard('-p', f'params_file:={tmp_path}/cell.yaml')
    page.look()
    ros.spin_until(lambda: page.parts.get('parameters', {}).get('camera')
                   and page.parts['parameters']['transform'] and 'save' in page.parts)
    return page


def act(page, name, **body):
    """Carry a step out; return the state of its part."""
    status, answer = page.post(f'/api/{name}?cell=/', body)
    assert status == 200, answer
    return answer


def test_the_areas_drawn_on_the_picture_become_the_nodes_parameters(page, cell):
    act(page, 'areas', work_area=[[0, 0], [320, 0], [320, 240], [0, 240]])
    assert np.allclose(cell[0].get_parameter('work_area').value,
                       [0, 0, 18, 0, 18, 13.5, 0, 13.5], atol=0.01)
    act(page, 'areas', work_area=None)
    assert list(cell[0].get_parameter('work_area').value) == []


def test_an_area_that_crosses_itself_is_refused_and_nothing_is_set(page, cell):
    status, answer = page.post(
        '/api/areas?cell=/', {'work_area': [[0, 0], [300, 200], [300, 0], [0, 300]]})
    assert status in (400, 409) and 'crosses' in answer['error']
    assert list(cell[0].get_parameter('work_area').value) == []


@pytest.mark.slow
@pytest.mark.flaky(reruns=2, only_rerun=['NotInTime'])
def test_a_board_is_looked_for_and_drawn_while_a_page_is_open_and_found_after_a_reload(
        ros, dashboard, page):
    act(page, 'simulated/show', shows='board', placement=1)
    act(page, 'board/start')
    page.watch_pictures('board')
    ros.spin_until(lambda: (page.parts['board']['look'] or {}).get('found'))
    ros.spin_until(lambda: page.pictures)
    picture = cv2.imdecode(np.frombuffer(page.pictures[-1], np.uint8), cv2.IMREAD_COLOR)
    assert picture.shape == (480, 640, 3)
    act(page, 'board/take')
    ros.spin_until(lambda: page.parts['board']['placements'], 60.0)
    again = type(page)(ros, page.origin)
    again.look()
    ros.spin_until(lambda: 'board' in again.parts)
    assert again.parts['board']['placements'] == page.parts['board']['placements']
    again.close()


def test_a_step_that_is_not_possible_now_is_refused_with_the_cure(page):
    for name, body in (('board/take', {}), ('board/fit', {}), ('board/accept', {}),
                       ('robot/accept', {}), ('board/remove', {'number': 1})):
        status, answer = page.post(f'/api/{name}?cell=/', body)
        assert status == 409 and len(answer['error']) > 10
    assert page.post('/api/board/fly?cell=/', {})[0] == 404
    assert page.fetch('/api/report/fit.png?cell=/')[0] in (404, 409)


def test_the_sheet_and_the_file_are_given(page):
    status, headers, content = page.fetch('/api/sheet?cell=/', {'paper': 'A4'})
    assert status == 200 and headers['Content-Type'] == 'application/pdf'
    assert content.startswith(b'%PDF')
    assert page.fetch('/api/sheet?cell=/', {'paper': 'A99'})[0] == 409
    for wanted in ({'corners': [100, 100], 'square_mm': 1}, {'corners': [3, 41]}):
        assert page.fetch('/api/sheet?cell=/', wanted)[0] == 409
    # It takes a second: a page of another site cannot ask for it.
    assert page.fetch('/api/sheet?cell=/')[0] == 405
    assert page.fetch('/api/sheet?cell=/', {}, Origin=None)[0] == 403
    status, _, content = page.fetch('/api/file?cell=/')
    assert status == 200 and b'ros__parameters' in content


def test_sheets_are_drawn_one_at_a_time(page):
    async def fetch_three():
        client = AsyncHTTPClient()
        return await asyncio.gather(*(client.fetch(HTTPRequest(
            f'{page.origin}/api/sheet?cell=/', method='POST', headers=page.headers, body='{}'),
            raise_error=False) for _ in range(3)))

    answers = page.run(fetch_three())
    assert sorted(answer.code for answer in answers) == [200, 503, 503]


def test_a_full_disk_is_told_and_the_old_file_stays(page, tmp_path, monkeypatch):
    path = tmp_path / 'cell.yaml'
    path.write_text('/**: {ros__parameters: {reach_cm: 30.0}}\n')

    def no_space(descriptor):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(files.os, 'fsync', no_space)
    status, answer = page.post('/api/save?cell=/', {'path': str(path)})
    assert status == 409 and 'No space left on device' in answer['error']
    assert path.read_text() == '/**: {ros__parameters: {reach_cm: 30.0}}\n'
    assert os.listdir(tmp_path) == ['cell.yaml']
    monkeypatch.undo()
    assert act(page, 'save', path=str(path))['saved']['sentence'].endswith('cell.yaml.bak.1.')
    assert 'reach_cm' in (tmp_path / 'cell.yaml.bak.1').read_text()


def test_what_the_second_node_refuses_is_not_kept_by_the_first(ros, page, cell):
    from camera_to_base.dashboard.sessions.values import CellChanges
    camera, transform = cell
    transform.add_on_set_parameters_callback(
        lambda parameters: SetParametersResult(
            successful=all(one.name != 'displacement_cm' for one in parameters),
            reason='not now'))
    sessions = page.node._sessions.of('/')
    wanted = {'displacement_cm': [1.0, 2.0, 3.0]}
    sessions._actions['robot', 'start'] = lambda body: CellChanges(
        {'camera': wanted, 'transform': wanted}, [])
    before = list(camera.get_parameter('displacement_cm').value)
    status, answer = page.post('/api/robot/start?cell=/', {})
    assert status == 400 and answer['error'] == 'not now'
    assert list(camera.get_parameter('displacement_cm').value) == before
