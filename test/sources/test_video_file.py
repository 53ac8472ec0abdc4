# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import subprocess
import sys

from camera_to_base.errors import FrameSourceError
from camera_to_base.sources.files import open_frame_source, VideoFile
from captures import Device, LEVELS, read_levels, write_levels
import cv2
import numpy as np
import pytest
from uncompressed_avi import write_uncompressed


@pytest.fixture
def video(tmp_path):
    return write_levels(str(tmp_path / 'levels.avi'))


def test_video_is_read_once_to_its_end(video):
    source = VideoFile(video)
    assert read_levels(source, len(LEVELS)) == pytest.approx(LEVELS, abs=3)
    assert source.read() is None
    assert source.read() is None


def test_frames_of_a_video_are_colour_pictures(video):
    frame = VideoFile(video).read()
    assert frame.shape == (48, 64, 3) and frame.dtype == np.uint8


def test_video_plays_at_its_own_rate(video):
    assert VideoFile(video).kind.frame_rate == pytest.approx(12.5)


@pytest.mark.parametrize('rate', [0.0, -1.0, 90000.0, float('nan')])
def test_video_without_a_likely_rate_plays_at_30_hz(video, monkeypatch, rate):
    monkeypatch.setattr(cv2, 'VideoCapture', Device)
    monkeypatch.setattr(Device, 'rate', rate)
    assert VideoFile(video).kind.frame_rate == 30.0


@pytest.mark.parametrize('rate', [0.1, 1000.0])
def test_slowest_and_fastest_likely_rate_are_played(video, monkeypatch, rate):
    monkeypatch.setattr(cv2, 'VideoCapture', Device)
    monkeypatch.setattr(Device, 'rate', rate)
    assert VideoFile(video).kind.frame_rate == rate


def test_length_of_a_video_is_told_or_unknown(video, monkeypatch):
    assert VideoFile(video).frame_count == len(LEVELS)
    monkeypatch.setattr(cv2, 'VideoCapture', Device)
    assert VideoFile(video).frame_count is None


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


def test_misspelt_word_for_a_source_is_told_with_the_word_that_was_meant():
    with pytest.raises(FrameSourceError, match="no such file; did you mean 'simulated'?"):
        open_frame_source('simulatd')


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


def test_uncompressed_file_is_read_or_refused_with_what_to_do(tmp_path):
    path = write_uncompressed(
        str(tmp_path / 'plain.avi'), [np.full((48, 64, 3), (10, 20, 30), np.uint8)] * 3)
    code = ('import sys\nfrom camera_to_base.errors import FrameSourceError\n'
            'from camera_to_base.sources import VideoFile\n'
            'try:\n    print(VideoFile(sys.argv[1]).read()[0, 0].tolist())\n'
            'except FrameSourceError as error:\n    print(error)\n')
    # In a process of its own: OpenCV 5.0.0 ends it.
    child = subprocess.run([sys.executable, '-c', code, path], capture_output=True, text=True,
                           timeout=60)
    assert child.returncode == 0
    said = child.stdout.strip()
    assert said == '[10, 20, 30]' or 'crashes on its uncompressed pictures: convert it' in said
