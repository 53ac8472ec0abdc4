# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Files are written as a whole, and only files."""

import os
from pathlib import Path
import stat

from camera_to_base.errors import InvalidValueError
from camera_to_base.files import history_of, regular_target, write_files, write_with_history
import pytest


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def names():
    return sorted(path.name for path in Path().iterdir())


def test_all_files_are_written_and_nothing_else_is_left():
    assert write_files({'a': b'1', 'b': b'2'}) == []
    assert (Path('a').read_bytes(), Path('b').read_bytes()) == (b'1', b'2')
    assert names() == ['a', 'b']


def test_none_is_written_where_one_cannot_be():
    Path('a').write_text('old')
    with pytest.raises(InvalidValueError, match="cannot write .*none/b': No such file"):
        write_files({'a': b'1', 'none/b': b'2'}, keep_old=True)
    assert Path('a').read_text() == 'old' and names() == ['a']


def test_old_file_is_kept_with_its_permissions():
    Path('a').write_text('old')
    os.chmod('a', 0o640)
    written = write_files({'a': b'new', 'b': b'2'}, keep_old=True)
    assert [Path(path).name for path in written] == ['a.bak']
    assert Path('a.bak').read_text() == 'old' and Path('a').read_text() == 'new'
    assert {stat.S_IMODE(os.stat(name).st_mode) for name in ('a', 'a.bak')} == {0o640}
    assert names() == ['a', 'a.bak', 'b']


def test_new_file_has_the_permissions_that_any_new_file_has():
    Path('other').write_text('')
    write_files({'a': b'1'})
    assert os.stat('a').st_mode == os.stat('other').st_mode


def test_link_stays_a_link_and_its_target_is_written():
    Path('folder').mkdir()
    Path('folder/target').write_text('old')
    Path('link').symlink_to('folder/target')
    write_files({'link': b'new'}, keep_old=True)
    assert Path('link').is_symlink() and Path('folder/target').read_text() == 'new'
    assert Path('folder/target.bak').read_text() == 'old' and names() == ['folder', 'link']


def test_link_to_a_file_that_is_not_there_yet_makes_it():
    Path('link').symlink_to('target')
    write_files({'link': b'new'})
    assert Path('link').is_symlink() and Path('target').read_text() == 'new'


def test_what_is_no_file_stays_as_it_is():
    os.mkfifo('pipe')
    Path('folder').mkdir()
    Path('circle').symlink_to('circle')
    Path('device').symlink_to('/dev/null')
    for path, kind in (('/dev/null', 'a device or a pipe'), ('device', 'a device or a pipe'),
                       ('/dev/stdout', 'a stream'), ('/proc/self/fd/1', 'a stream'),
                       ('pipe', 'a device or a pipe'), ('folder', 'a folder'),
                       ('circle', 'a link that leads back to itself')):
        for refuse in (regular_target, lambda path: write_files({path: b'1'}, keep_old=True)):
            with pytest.raises(InvalidValueError, match=f"cannot write '{path}': {kind}"):
                refuse(path)
    assert stat.S_ISCHR(os.stat('/dev/null').st_mode) and stat.S_ISFIFO(os.stat('pipe').st_mode)
    assert names() == ['circle', 'device', 'folder', 'pipe']


def test_the_last_five_files_are_kept_the_newest_first():
    for number in range(8):
        kept = write_with_history('a', str(number).encode())
        assert (kept is None) == (number == 0)
    assert Path('a').read_text() == '7'
    assert [Path(path).read_text() for path in history_of('a')] == ['6', '5', '4', '3', '2']
    assert names() == ['a', *(f'a.bak.{number}' for number in range(1, 6))]


def test_a_file_that_is_the_same_pushes_no_former_one_out():
    for content in (b'1', b'2', b'2', b'2'):
        write_with_history('a', content)
    assert [Path(path).read_text() for path in history_of('a')] == ['1']


def test_a_disk_that_is_full_leaves_the_file_and_its_history(monkeypatch):
    for content in (b'1', b'2'):
        write_with_history('a', content)

    def full(descriptor):
        raise OSError(28, os.strerror(28))
    monkeypatch.setattr(os, 'fsync', full)
    with pytest.raises(InvalidValueError, match='No space left on device'):
        write_with_history('a', b'3')
    assert Path('a').read_text() == '2' and Path('a.bak.1').read_text() == '1'
    assert names() == ['a', 'a.bak.1']
