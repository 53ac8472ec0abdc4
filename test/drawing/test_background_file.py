# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import os
import time

from camera_to_base.drawing.files import BackgroundFile
from camera_to_base.errors import InvalidValueError
from camera_to_base.files import check_background_path
import numpy as np
import pytest


def picture(seed=0):
    return np.random.default_rng(seed).integers(0, 256, (48, 64, 3), np.uint8)


def test_background_is_read_as_it_was_written_with_its_age(tmp_path):
    path = str(tmp_path / 'background.png')
    BackgroundFile(path).keep(picture())
    os.utime(path, (time.time() - 60, time.time() - 60))
    kept = BackgroundFile(path).read()
    assert (kept.picture == picture()).all()
    assert kept.age_s == pytest.approx(60, abs=5)


def test_what_a_background_does_not_show_is_kept_with_it(tmp_path):
    path, unknown = str(tmp_path / 'background.png'), np.zeros((48, 64), np.uint8)
    unknown[:, :9] = 255
    BackgroundFile(path).keep(picture(), unknown)
    kept = BackgroundFile(path).read()
    assert (kept.picture == picture()).all() and (kept.unknown == unknown).all()
    BackgroundFile(path).keep(picture())
    assert BackgroundFile(path).read().unknown is None


def test_new_background_replaces_the_old_one_and_none_replaces_nothing(tmp_path):
    file = BackgroundFile(str(tmp_path / 'background.png'))
    for background in (picture(1), None, picture(2), None):
        file.keep(background)
    assert (file.read().picture == picture(2)).all()
    assert os.listdir(tmp_path) == ['background.png']


def test_background_is_written_once(tmp_path):
    path, background = tmp_path / 'background.png', picture()
    file = BackgroundFile(str(path))
    file.keep(background)
    path.unlink()
    file.keep(background)
    assert not path.exists()


def test_without_a_path_or_a_file_there_is_no_background(tmp_path):
    BackgroundFile('').keep(picture())
    assert BackgroundFile('').read() is None
    assert BackgroundFile(str(tmp_path / 'background.png')).read() is None


@pytest.mark.parametrize('share', [0.0, 0.1, 0.5, 0.99])
def test_half_written_file_is_refused(tmp_path, share):
    path = tmp_path / 'background.png'
    BackgroundFile(str(path)).keep(picture())
    content = path.read_bytes()
    path.write_bytes(content[:int(share * len(content))])
    with pytest.raises(InvalidValueError, match=f"'{path}': it holds no whole picture"):
        BackgroundFile(str(path)).read()


def test_folder_in_the_files_place_is_named(tmp_path):
    path = tmp_path / 'background.png'
    path.mkdir()
    with pytest.raises(InvalidValueError, match=f"'{path}': Is a directory"):
        BackgroundFile(str(path)).read()
    with pytest.raises(InvalidValueError, match=f"'{path}': a folder is there"):
        BackgroundFile(str(path)).keep(picture())


@pytest.mark.parametrize('path, complaint', [
    ('background.jpg', 'must end in .png'), ('background', 'must end in .png'),
    ('/does/not/exist/background.png', "no folder '/does/not/exist'")])
def test_path_that_can_keep_no_background_is_refused(path, complaint):
    with pytest.raises(InvalidValueError, match=complaint):
        check_background_path(path)


def test_home_folder_is_meant_by_its_sign(tmp_path, monkeypatch):
    monkeypatch.setenv('HOME', str(tmp_path))
    path = check_background_path('~/background.png')
    assert path == str(tmp_path / 'background.png')
    BackgroundFile('~/background.png').keep(picture())
    assert (BackgroundFile(path).read().picture == picture()).all()


def test_pipe_or_device_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / 'pipe.png')
    (tmp_path / 'full.png').symlink_to('/dev/full')
    for name in ('pipe.png', 'full.png'):
        with pytest.raises(InvalidValueError, match='is no ordinary file'):
            check_background_path(str(tmp_path / name))
        with pytest.raises(InvalidValueError, match='is no ordinary file'):
            BackgroundFile(str(tmp_path / name)).read()
