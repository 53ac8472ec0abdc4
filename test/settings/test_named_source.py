# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.errors import FrameSourceError, InvalidValueError
from camera_to_base.settings import camera_settings, CAMERA_SPECS, open_named_source
from camera_to_base.simulation.board import SimulatedBoard
from camera_to_base.sources.cameras import Camera
from camera_to_base.sources.files import VideoFile
from camera_to_base.sources.kinds import DEVICE, RANDOM, SIMULATED
from captures import Device, write_levels
import cv2
import numpy as np
import pytest


def open_source(name, may_be_random=True, **others):
    values = {spec.name: spec.default for spec in CAMERA_SPECS}
    return open_named_source(
        camera_settings({**values, **others, 'source': name}), may_be_random)


@pytest.mark.parametrize('name', ['random', 'topic', 'compressed_topic'])
def test_no_frame_is_read_for_random_pixels_and_topics(name):
    source = open_source(name)
    assert source.frames is None and source.kind.form == name


def test_simulated_is_the_simulated_board():
    source = open_source('simulated')
    assert isinstance(source.frames, SimulatedBoard)
    assert source.kind == SIMULATED._replace(frame_rate=10.0)


def test_file_is_opened_at_once(tmp_path):
    source = open_source(write_levels(str(tmp_path / 'levels.avi')))
    assert isinstance(source.frames, VideoFile) and source.kind.ends
    assert source.kind.frame_rate == pytest.approx(12.5)


def test_folder_is_refused_with_what_reads_a_bag(tmp_path):
    with pytest.raises(FrameSourceError, match=f'camera_to_base locate {tmp_path}` reads it'):
        open_source(str(tmp_path))


def test_repeated_file_starts_again_when_it_has_ended(tmp_path):
    path = write_levels(str(tmp_path / 'levels.avi'))
    once, repeated = open_source(path).frames, open_source(path, repeat=True).frames
    means = [once.read().mean() for _ in range(once.frame_count)]
    assert once.read() is None
    assert [repeated.read().mean() for _ in range(2 * len(means))] == 2 * means


def test_repeated_picture_is_shown_again_and_again(tmp_path):
    picture = np.random.default_rng(3).integers(0, 256, (40, 60, 3), np.uint8)
    for name in ('left01.png', 'left02.png'):
        cv2.imwrite(str(tmp_path / name), picture if name == 'left01.png' else 255 - picture)
    source = open_source(str(tmp_path / 'left01.png'), repeat=True)
    assert source.kind.frame_rate == 10.0
    assert all(np.array_equal(source.frames.read(), picture) for _ in range(5))


def test_repeated_picture_that_is_none_is_refused(tmp_path):
    (tmp_path / 'table.png').write_text('no picture')
    with pytest.raises(InvalidValueError, match='no picture that OpenCV knows'):
        open_source(str(tmp_path / 'table.png'), repeat=True)


@pytest.mark.parametrize('others', [{}, {'repeat': True}])
def test_file_that_does_not_exist_is_refused(others):
    with pytest.raises(FrameSourceError, match='no such file'):
        open_source('/does/not/exist.avi', **others)


@pytest.mark.parametrize('name', ['7', '/dev/video7'])
def test_camera_is_opened_by_its_first_read(monkeypatch, name):
    monkeypatch.setattr(cv2, 'VideoCapture', Device)
    monkeypatch.setattr(Device, 'opened', [])
    source = open_source(name)
    camera = source.frames
    assert isinstance(camera, Camera) and not Device.opened and source.kind == DEVICE
    camera.read()
    assert len(Device.opened) == 1


def test_auto_is_random_pixels_where_no_camera_is_attached(monkeypatch):
    monkeypatch.setattr('glob.glob', lambda pattern: [])
    assert open_source('auto').kind == RANDOM


def test_auto_waits_for_a_camera_where_pixels_may_not_be_random(monkeypatch):
    monkeypatch.setattr('glob.glob', lambda pattern: [])
    source = open_source('auto', may_be_random=False)
    assert source.kind == DEVICE and source.name == 'auto'
    for _ in range(2):
        with pytest.raises(FrameSourceError, match='no camera is attached: plug one in'):
            source.frames.read()
    monkeypatch.setattr('glob.glob', lambda pattern: ['/dev/video7'])
    monkeypatch.setattr(cv2, 'VideoCapture', Device)
    assert source.frames.read() is not None
    source.frames.release()
