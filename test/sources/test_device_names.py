# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Lasting names of cameras."""

from camera_to_base.sources.kinds import lasting_name
import pytest


@pytest.fixture
def links(tmp_path):
    (tmp_path / 'usb-Cam_A-index0').symlink_to('/dev/video0')
    (tmp_path / 'usb-Cam_B-index0').symlink_to('/dev/video12')
    return tmp_path


@pytest.mark.parametrize('name, link', [
    ('0', 'usb-Cam_A-index0'), ('/dev/video0', 'usb-Cam_A-index0'), ('12', 'usb-Cam_B-index0')])
def test_a_device_is_named_by_its_link(links, name, link):
    assert lasting_name(name, str(links)) == str(links / link)


@pytest.mark.parametrize('name, lasting', [
    ('3', '/dev/video3'), ('/dev/video1', '/dev/video1'), ('simulated', 'simulated'),
    ('/dev/v4l/by-id/usb-C', '/dev/v4l/by-id/usb-C'), ('a.avi', 'a.avi'),
    ('rtsp://me:secret@10.0.0.3/1', 'rtsp://10.0.0.3/1'), ('http://cam/x@y', 'http://cam/x@y')])
def test_others_keep_their_name_without_a_password(links, name, lasting):
    assert lasting_name(name, str(links)) == lasting


def test_no_folder_of_links_is_no_harm():
    assert lasting_name('0', '/nowhere') == '/dev/video0'
