# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A camera node that is started again goes on with its background, by real streams."""

import math
import signal
import time

from camera_to_base.drawing.files import BackgroundFile
from camera_to_base.nodes.camera_publisher import CameraPublisher
from child_camera import ChildCamera
import cv2
from geometry_msgs.msg import PoseArray
from mjpeg_server import MjpegServer
import numpy as np
import pytest
from ros_helpers import assert_in_time, CAMERA_TOPIC
import scenes

TRUE = 400 * 36.0 / 640, 300 * 36.0 / 640


@pytest.fixture
def file(tmp_path):
    return tmp_path / 'background.png'


def arguments(url, file):
    return '-p', f'source:={url}', '-p', f'background_file:={file}'


def keep_empty_table(file, change=lambda table: table):
    BackgroundFile(str(file)).keep(change(scenes.still_coin(empty_s=60.0)()))


@pytest.mark.slow
def test_coin_at_rest_is_published_again_within_5_s_of_a_kill(ros, start, file, tell):
    positions = ros.listen_with_time(CAMERA_TOPIC)
    objects = ros.listen_to(PoseArray, '/objects_in_cam_frame')
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    with ChildCamera('mjpeg_server', 'still_coin') as camera:
        node = start('camera_publisher', *arguments(camera.url, file))
        assert ros.spin_until(lambda: len(positions) > 5 and statuses, 15.0)
        assert 'from the file' not in statuses[-1].values['background']
        node.kill()
        ros.spin_for(0.5)  # what was on its way arrives
        positions.clear()
        objects.clear()
        started_at = time.time()
        node = start('camera_publisher', *arguments(camera.url, file))
        assert ros.spin_until(lambda: len(positions) > 5, 10.0)
        tell(f'started again: the next position came {positions[0][0] - started_at:.2f} s later')
        assert_in_time(positions[0][0] - started_at, 5.0)
        assert ros.spin_until(lambda: 'px, from the file' in statuses[-1].values['background'])
    assert max(math.dist(position, TRUE) for _, position in positions) < 0.05
    assert all(message.poses for message in objects)  # never: 'the surface is empty'
    assert node.end(signal.SIGTERM) == 0
    assert f"the background is that of '{file}', taken" in node.output


def test_camera_that_was_nudged_meanwhile_publishes_nothing(ros, file):
    keep_empty_table(file, lambda table: np.roll(table, 9, axis=1))
    positions, statuses = ros.listen(CAMERA_TOPIC), ros.listen_to_diagnostics('/camera_publisher')
    with MjpegServer(scenes.still_coin(empty_s=0.0)) as camera:
        ros.add(CameraPublisher, *arguments(camera.url, file),
                '-p', 'view.correct_up_to_px:=0.0')
        assert ros.spin_until(lambda: statuses and 'has moved by' in statuses[-1].message, 8.0)
    assert positions == []


@pytest.mark.slow
def test_file_of_another_picture_size_publishes_nothing_until_it_is_taken_anew(ros, file):
    keep_empty_table(file, lambda table: cv2.resize(table, (320, 240)))
    positions, statuses = ros.listen(CAMERA_TOPIC), ros.listen_to_diagnostics('/camera_publisher')
    with MjpegServer(scenes.still_coin(empty_s=5.0)) as camera:
        ros.add(CameraPublisher, *arguments(camera.url, file))
        assert ros.spin_until(lambda: statuses and statuses[-1].level == 2, 5.0)
        assert 'background is 320 x 240 px' in statuses[-1].message
        assert positions == []
        assert ros.call('/camera_publisher/capture_background').success
        assert cv2.imread(str(file)).shape == (480, 640, 3)
        assert ros.spin_until(lambda: positions, 8.0)
    assert positions[0] == pytest.approx(TRUE, abs=0.05)


@pytest.mark.slow
def test_file_that_holds_no_picture_is_said_and_replaced(ros, start, file):
    file.write_bytes(b'half of a picture')
    positions = ros.listen(CAMERA_TOPIC)
    with ChildCamera('mjpeg_server', 'still_coin') as camera:
        node = start('camera_publisher', *arguments(camera.url, file))
        assert ros.spin_until(lambda: positions, 15.0)
    assert node.end(signal.SIGTERM) == 0
    assert f"'{file}': it holds no whole picture: the background is taken anew" in node.output
    assert cv2.imread(str(file)).shape == (480, 640, 3)


@pytest.mark.slow
def test_file_that_cannot_be_written_is_said_once_and_positions_come(ros, start, file):
    file.mkdir()
    positions, statuses = ros.listen(CAMERA_TOPIC), ros.listen_to_diagnostics('/camera_publisher')
    with ChildCamera('mjpeg_server', 'still_coin') as camera:
        node = start('camera_publisher', *arguments(camera.url, file))
        assert ros.spin_until(lambda: len(positions) > 5, 15.0)
        assert ros.spin_until(lambda: any(
            'is not kept for the next start' in status.message for status in statuses))
    assert node.end(signal.SIGTERM) == 0
    assert node.output.count('the background is not kept') == 1


@pytest.mark.slow
def test_source_that_is_no_camera_keeps_nothing_and_says_so(ros, start, file):
    positions = ros.listen(CAMERA_TOPIC)
    node = start('camera_publisher', *arguments('simulated', file))
    assert ros.spin_until(lambda: positions)
    assert node.end() == 0
    assert "background_file has no effect with source 'simulated'" in node.output
    assert not file.exists()
