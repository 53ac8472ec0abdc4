# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What is kept of a moment: a snapshot as a file, and recordings beside the parameter file."""

import io
import json
import re
import zipfile

from camera_to_base.dashboard.sessions.record import KEPT, write_recording
from camera_to_base.errors import InvalidValueError
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
import cv2
import numpy as np
import pytest
from session_cell import Cell

POST = {'/api/snapshot': {}, '/api/record/start': {'seconds': 1.5}}


@pytest.fixture
def page(ros, dashboard, tmp_path):
    ros.add(CameraPublisher, '-p', 'source:=simulated')
    ros.add(RobotBasePublisher)
    client = dashboard('-p', f'params_file:={tmp_path / "cell.yaml"}')
    client.look()
    ros.spin_until(lambda: client.parts.get('watch', {}).get('objects'))
    return client


def test_snapshot_holds_a_frame_with_its_own_mask_and_positions(page):
    status, headers, content = page.fetch('/api/snapshot', {})
    assert status == 200 and headers['Content-Type'] == 'application/zip'
    with zipfile.ZipFile(io.BytesIO(content)) as file:
        assert set(file.namelist()) == {'frame.jpg', 'mask.png', 'positions.json', 'cell.yaml'}
        positions = json.loads(file.read('positions.json'))
        frame, mask = (cv2.imdecode(np.frombuffer(file.read(name), np.uint8), cv2.IMREAD_COLOR)
                       for name in ('frame.jpg', 'mask.png'))
        assert 'source: simulated' in file.read('cell.yaml').decode()
    assert frame.shape == mask.shape == (480, 640, 3)
    object_, = positions['objects']
    u, v = object_['pixel']
    # The object moves by some px with each frame: those of another one would not fit.
    rows, columns = np.nonzero(mask[:, :, 0])
    assert [columns.mean(), rows.mean()] == pytest.approx([u, v], abs=1.0)
    assert object_['base']['x'] == pytest.approx(object_['camera']['x'] - 17.8, abs=0.01)


def record(page, ros):
    """Record for a moment; return the path of the video."""
    status, state = page.post('/api/record/start', {'seconds': 1.5})
    assert status == 200 and state['step'] == 'recording'
    ros.spin_until(lambda: page.parts['record']['sentence'])
    return re.search(r'source:=(\S+)', page.parts['record']['sentence'])[1]


def test_recording_is_a_video_beside_the_parameter_file(page, ros, tmp_path):
    path = record(page, ros)
    assert path.startswith(str(tmp_path / 'cell_recording_')) and path.endswith('.avi')
    video = cv2.VideoCapture(path)
    shapes = []
    while (read := video.read())[0]:
        shapes.append(read[1].shape)
    assert len(shapes) >= 2 and set(shapes) == {(480, 640, 3)}
    assert [one.name for one in tmp_path.glob('*.avi')] == [path.rpartition('/')[2]]
    assert not list(tmp_path.glob('.*.avi'))


def test_recording_is_played_as_the_camera_with_the_same_objects_and_tuned(
        ros, dashboard, tmp_path):
    camera = ros.add(CameraPublisher, '-p', 'source:=simulated')
    ros.add(RobotBasePublisher)
    page = dashboard('-p', f'params_file:={tmp_path / "cell.yaml"}')
    page.look()
    ros.spin_until(lambda: page.parts.get('watch', {}).get('objects'))
    # What lies there all the time is found again, as the recording begins with the background.
    page.post('/api/simulated/show', {'shows': 'still_objects', 'placement': 1})

    def places():
        found = [(one['camera']['x'], one['camera']['y'])
                 for one in page.parts['watch']['objects']]
        return sorted(found, key=lambda place: (round(place[0]), place[1]))

    ros.spin_until(lambda: len(places()) == 5)
    before = places()
    path = record(page, ros)
    ros.remove(camera)
    ros.spin_until(lambda: not page.parts['watch']['objects']
                   and not page.parts['parameters']['camera'])
    camera = ros.add(CameraPublisher, '-p', f'source:={path}', '-p', 'repeat:=true')
    ros.spin_until(lambda: len(places()) == 5)
    np.testing.assert_allclose(places(), before, atol=0.03)
    ros.spin_until(lambda: page.parts['parameters']['camera'])
    assert page.post('/api/parameters', {
        'node': 'camera', 'values': {'detector.min_area_cm2': 1000.0}})[0] == 200
    ros.spin_until(lambda: page.parts['watch']['objects'] == [])


@pytest.mark.parametrize('path', POST)
def test_neither_is_done_for_a_page_of_another_site(page, path):
    for origin in (None, 'http://elsewhere'):
        assert page.post(path, POST[path], Origin=origin)[0] == 403
    assert page.parts['record']['step'] == 'off'


def test_the_oldest_recordings_are_removed_and_nothing_else(tmp_path):
    jpeg = cv2.imencode('.jpg', np.full((48, 64, 3), 90, np.uint8))[1].tobytes()
    names = [f'cell_recording_2020010{number}_000000.avi' for number in range(1, 6)]
    others = ['holiday.avi', 'other_recording_20200101_000000.avi', 'cell_recording_x.avi']
    for name in (*names, *others):
        (tmp_path / name).write_bytes(b'old')
    path = write_recording(str(tmp_path), 'cell', [(0.0, jpeg), (0.1, jpeg), (0.2, b'none')])
    left = {one.name for one in tmp_path.iterdir()}
    assert left == {*names[-KEPT + 1:], *others, path.rpartition('/')[2]}


def test_recording_that_cannot_be_written_says_so(tmp_path):
    with pytest.raises(InvalidValueError, match='cannot be written'):
        write_recording(str(tmp_path / 'gone'), 'cell', [(0.0, b''), (0.1, b'')])


def test_recording_needs_pictures_and_is_made_one_at_a_time(tmp_path):
    cell = Cell(tmp_path / 'cell.yaml')
    cell.do('record', 'start')
    with pytest.raises(InvalidValueError, match='a recording is being made'):
        cell.do('record', 'start')
    assert 'nothing was recorded' in cell.do('record', 'stop')['error']
    for seconds in (0, 61, 'long'):
        with pytest.raises(InvalidValueError, match='seconds'):
            cell.do('record', 'start', seconds=seconds)
    assert list(tmp_path.iterdir()) == []
