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

import glob

from camera_to_base import frame_sources
from camera_to_base.errors import FrameSourceError
from camera_to_base.frame_sources import (
    Camera, first_camera, is_camera, is_stream, open_frame_source, VideoFile)
import cv2
import numpy as np
import pytest

LEVELS = [20, 60, 100, 140, 180, 220, 240]


@pytest.fixture
def video(tmp_path):
    path = str(tmp_path / 'levels.avi')
    writer = cv2.VideoWriter(path, cv2.VideoWriter_fourcc(*'MJPG'), 12.5, (64, 48))
    for level in LEVELS:
        writer.write(np.full((48, 64, 3), level, np.uint8))
    writer.release()
    return path


class Device:
    """Stands in for cv2.VideoCapture on a machine without a camera."""

    opened = []
    rate = 0.0

    def __init__(self, index, backend, frames=2):
        Device.opened.append(self)
        self.index = index
        self.backend = backend
        self.wishes = {}
        self.frames = 0 if index in (0, 9) else frames

    def isOpened(self):
        return self.index != 1

    def get(self, prop):
        return self.rate if prop == cv2.CAP_PROP_FPS else 0.0

    def set(self, prop, value):  # noqa: A003
        self.wishes[prop] = value

    def read(self):
        self.frames -= 1
        return self.frames >= 0, np.zeros((48, 64, 3), np.uint8) + self.index

    def release(self):
        self.frames = 0


@pytest.fixture
def devices(monkeypatch):
    monkeypatch.setattr(cv2, 'VideoCapture', Device)
    monkeypatch.setattr(Device, 'opened', [])
    return Device.opened


def read_levels(source, count):
    return [round(float(source.read().mean())) for _ in range(count)]


def test_video_is_read_once_to_its_end(video):
    source = VideoFile(video)
    assert read_levels(source, len(LEVELS)) == pytest.approx(LEVELS, abs=3)
    assert source.read() is None
    assert source.read() is None


def test_frames_of_a_video_are_colour_pictures(video):
    frame = VideoFile(video).read()
    assert frame.shape == (48, 64, 3) and frame.dtype == np.uint8


def test_video_plays_at_its_own_rate(video):
    assert VideoFile(video).frame_rate == pytest.approx(12.5)


@pytest.mark.parametrize('rate', [0.0, -1.0, 90000.0, float('nan')])
def test_video_without_a_likely_rate_plays_at_30_hz(video, devices, monkeypatch, rate):
    monkeypatch.setattr(Device, 'rate', rate)
    assert VideoFile(video).frame_rate == 30.0


def test_released_video_gives_no_more_frames(video):
    source = VideoFile(video)
    source.read()
    source.release()
    assert source.read() is None


def test_same_video_can_be_opened_twice(video):
    first, second = VideoFile(video), VideoFile(video)
    read_levels(first, 3)
    assert read_levels(second, 1) == pytest.approx(LEVELS[:1], abs=3)
    assert read_levels(first, 1) == pytest.approx(LEVELS[3:4], abs=3)


def test_video_is_opened_by_its_name(video):
    assert isinstance(open_frame_source(video), VideoFile)


def test_tilde_is_the_home_folder(video, tmp_path, monkeypatch):
    monkeypatch.setenv('HOME', str(tmp_path))
    assert open_frame_source('~/levels.avi').read() is not None


def test_video_that_does_not_exist_is_refused(tmp_path):
    path = str(tmp_path / 'none.avi')
    with pytest.raises(FrameSourceError, match=f'{path}.*no such file'):
        open_frame_source(path)


@pytest.mark.parametrize(
    'content', [b'', b'hello\n', bytes(range(256)) * 20], ids=['empty', 'text', 'bytes'])
@pytest.mark.parametrize('name', ['text.txt', 'video.avi', 'video'])
def test_file_that_is_no_video_is_refused(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(FrameSourceError, match=f'{path}.*no video'):
        open_frame_source(str(path))


def test_folder_is_refused(tmp_path):
    with pytest.raises(FrameSourceError, match=f"cannot open video '{tmp_path}'"):
        open_frame_source(str(tmp_path))


@pytest.mark.parametrize('name', ['', '-1', 'simulate'])
def test_name_of_nothing_is_refused(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(FrameSourceError, match=f"cannot open video '{name}'"):
        open_frame_source(name)


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
    assert isinstance(stream, Camera) and stream.frame_rate == 0
    assert read_levels(stream, len(LEVELS)) == pytest.approx(LEVELS, abs=3)
    with pytest.raises(FrameSourceError, match='gives no frame'):
        stream.read()
    assert read_levels(stream, 2) == pytest.approx(LEVELS[:2], abs=3)


def test_camera_can_be_released_twice(video):
    stream = open_frame_source(f'file://{video}')
    stream.release()
    stream.release()


@pytest.mark.parametrize('name', ['http://camera.local/video', 'rtsp://10.0.0.7:554/main'])
def test_url_is_a_stream_and_a_camera(name):
    assert is_stream(name) and is_camera(name)


@pytest.mark.parametrize('name', ['0', '12', '/dev/video0', '/dev/v4l/by-id/usb-camera-index0'])
def test_index_and_device_path_are_cameras_but_no_streams(name):
    assert is_camera(name) and not is_stream(name)


@pytest.mark.parametrize('name', ['road.avi', '/data/dev/video0', 'dev/video0', '0.avi', '-1',
                                  '', 'C:/road.avi'])
def test_other_names_are_no_cameras(name):
    assert not is_camera(name) and not is_stream(name)


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


@pytest.mark.skipif(bool(glob.glob('/dev/video*')), reason='a camera is attached')
def test_there_is_no_first_camera_where_none_is_attached():
    assert first_camera() is None


def test_first_camera_is_the_lowest_device_that_gives_a_frame(devices, monkeypatch):
    # 0 gives no frame, and neither does 9; 1 cannot be opened.
    monkeypatch.setattr(frame_sources.glob, 'glob', lambda pattern: [
        '/dev/video10', '/dev/video9', '/dev/video11', '/dev/video1', '/dev/video0'])
    camera = first_camera((320, 240))
    assert camera.name == '/dev/video10'
    assert [device.index for device in devices] == [0, 1, 9, 10]
    assert devices[-1].wishes[cv2.CAP_PROP_FRAME_WIDTH] == 320


def test_there_is_no_first_camera_where_no_device_gives_a_frame(devices, monkeypatch):
    monkeypatch.setattr(frame_sources.glob, 'glob', lambda pattern: ['/dev/video0', '/dev/video1'])
    assert first_camera() is None
