# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.sources.kinds import kind_of
import pytest


@pytest.mark.parametrize('name, form', [
    ('http://camera.local/video', 'stream'), ('rtsp://10.0.0.7:554/main', 'stream'),
    ('0', 'device'), ('12', 'device'), ('/dev/video0', 'device'),
    ('/dev/v4l/by-id/usb-camera-index0', 'device'),
    ('road.avi', 'file'), ('/data/dev/video0', 'file'), ('dev/video0', 'file'), ('0.avi', 'file'),
    ('-1', 'file'), ('', 'file'), ('C:/road.avi', 'file'), ('Topic', 'file'),
    ('day.mcap', 'bag'), ('~/day_0.db3', 'bag'),
    ('auto', 'auto'), ('random', 'random'), ('simulated', 'simulated'), ('topic', 'topic'),
    ('compressed_topic', 'compressed_topic')])
def test_name_tells_what_a_source_is(name, form):
    assert kind_of(name).form == form


def test_folder_is_a_bag(tmp_path):
    assert kind_of(str(tmp_path)).form == 'bag'


@pytest.mark.parametrize('names, is_live, ends', [
    (['0', 'rtsp://camera', 'topic', 'compressed_topic', 'auto'], True, False),
    (['road.avi', 'day.mcap'], False, True),
    (['simulated', 'random'], False, False)])
def test_live_sources_have_no_end_and_recordings_have_one(names, is_live, ends):
    assert [(kind_of(name).is_live, kind_of(name).ends) for name in names] == [
        (is_live, ends)] * len(names)


def test_frames_of_a_stream_alone_may_lag():
    names = ['0', 'rtsp://camera', 'topic', 'road.avi', 'simulated']
    assert [name for name in names if kind_of(name).may_lag] == ['rtsp://camera']
