# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import glob

from camera_to_base.errors import FrameSourceError
from camera_to_base.sources import cameras
from camera_to_base.sources.cameras import Camera, device_hint, first_camera
from camera_to_base.sources.files import open_frame_source
from camera_to_base.sources.kinds import STREAM
from captures import Device, LEVELS, read_levels, write_levels
import cv2
import numpy as np
import pytest


@pytest.fixture
def video(tmp_path):
    return write_levels(str(tmp_path / 'levels.avi'))


@pytest.fixture
def devices(monkeypatch):
    monkeypatch.setattr(cv2, 'VideoCapture', Device)
    monkeypatch.setattr(Device, 'opened', [])
    return Device.opened


@pytest.mark.parametrize('name', [
    '97', '/dev/video97', '/dev/v4l/by-id/none', '/dev/null', '99999999999',
    '/dev/video2147483648'])
def test_device_that_does_not_exist_is_refused(name):
    with pytest.raises(FrameSourceError, match=f"cannot open camera '{name}'"):
        open_frame_source(name)


def test_stream_that_does_not_exist_is_refused(tmp_path):
    url = f'file://{tmp_path}/none.avi'
    with pytest.raises(FrameSourceError, match=f"cannot open camera '{url}'"):
        open_frame_source(url)


@pytest.mark.parametrize('level', [2, 4])
def test_failure_leaves_opencvs_log_level_as_it_was(tmp_path, level):
    logging = cv2 if hasattr(cv2, 'setLogLevel') else cv2.utils.logging
    before = logging.setLogLevel(level)
    with pytest.raises(FrameSourceError):
        Camera(f'file://{tmp_path}/none.avi')
    assert logging.setLogLevel(before) == level


def test_stream_that_breaks_off_is_an_error_and_the_next_read_opens_it_anew(video):
    stream = open_frame_source(f'file://{video}')
    assert isinstance(stream, Camera) and stream.kind == STREAM
    assert read_levels(stream, len(LEVELS)) == pytest.approx(LEVELS, abs=3)
    with pytest.raises(FrameSourceError, match='gives no frame'):
        stream.read()
    assert read_levels(stream, 2) == pytest.approx(LEVELS[:2], abs=3)


def test_camera_can_be_released_twice(video):
    stream = open_frame_source(f'file://{video}')
    stream.release()
    stream.release()


def test_device_is_opened_by_its_number(devices):
    open_frame_source('/dev/video12')
    open_frame_source('7')
    assert [device.index for device in devices] == [12, 7]


def test_device_may_be_named_by_a_link_to_it(devices, tmp_path):
    link = tmp_path / 'usb-camera'
    link.symlink_to('/dev/video12')
    Camera(str(link))
    assert devices[0].index == 12


def test_device_is_asked_for_the_picture_size(devices):
    open_frame_source('7', (1280, 720))
    assert devices[0].wishes == {
        cv2.CAP_PROP_FRAME_WIDTH: 1280, cv2.CAP_PROP_FRAME_HEIGHT: 720}


def test_device_that_was_unplugged_is_an_error_and_is_opened_anew(devices):
    camera = open_frame_source('7')
    camera.read(), camera.read()
    with pytest.raises(FrameSourceError, match="camera '7' gives no frame"):
        camera.read()
    assert len(devices) == 1
    camera.read()
    assert len(devices) == 2 and devices[1].index == 7


def test_picture_that_opencv_fails_on_is_an_error_and_the_device_is_opened_anew(
        devices, monkeypatch):
    camera = open_frame_source('7')
    with monkeypatch.context() as broken:
        broken.setattr(Device, 'read', lambda self: cv2.imdecode(np.zeros(0, np.uint8), 1))
        with pytest.raises(FrameSourceError, match="camera '7' gives no frame"):
            camera.read()
    camera.read()
    assert len(devices) == 2


def test_camera_that_cannot_be_opened_is_told_with_those_that_exist(tmp_path, monkeypatch):
    pattern = f'{tmp_path}/video*'
    assert device_hint('0', pattern).endswith('this computer sees no camera.')
    for number in (10, 2):
        (tmp_path / f'video{number}').touch()
    assert device_hint('0', pattern) == f'There are {tmp_path}/video2, {tmp_path}/video10.'
    monkeypatch.setattr(cameras.os, 'access', lambda path, mode: False)
    assert 'sudo usermod -aG video $USER' in device_hint('2', pattern)


@pytest.mark.skipif(bool(glob.glob('/dev/video*')), reason='a camera is attached')
def test_there_is_no_first_camera_where_none_is_attached():
    assert first_camera() is None


def test_first_camera_is_the_lowest_device_that_gives_a_frame(devices, monkeypatch):
    # 0 gives no frame, and neither does 9; 1 cannot be opened.
    monkeypatch.setattr(cameras.glob, 'glob', lambda pattern: [
        '/dev/video10', '/dev/video9', '/dev/video11', '/dev/video1', '/dev/video0'])
    camera = first_camera((320, 240))
    assert camera.name == '/dev/video10'
    assert [device.index for device in devices] == [0, 1, 9, 10]
    assert devices[-1].wishes[cv2.CAP_PROP_FRAME_WIDTH] == 320


def test_there_is_no_first_camera_where_no_device_gives_a_frame(devices, monkeypatch):
    monkeypatch.setattr(cameras.glob, 'glob', lambda pattern: ['/dev/video0', '/dev/video1'])
    assert first_camera() is None
