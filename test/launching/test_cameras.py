# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from pathlib import Path

from camera_to_base.errors import InvalidValueError
from camera_to_base.launching import (
    choose_cameras, fusion_parameters, is_fused, LaunchedCamera, read_cameras)
import pytest

CONFIG = Path(__file__).parents[2] / 'config'


@pytest.fixture
def write(tmp_path):
    (tmp_path / 'left.yaml').write_text('/**: {ros__parameters: {}}')

    def write_text(text):
        path = tmp_path / 'cells.yaml'
        path.write_text(text)
        return str(path)
    return write_text


@pytest.fixture
def camera(tmp_path):
    path = tmp_path / 'cell.yaml'
    path.write_text('/**: {ros__parameters: {}}')
    return LaunchedCamera(str(path))


def choose(camera, list_file='', **changes):
    return choose_cameras(list_file, camera._replace(**changes), camera)


def test_without_a_list_the_arguments_describe_the_one_camera(camera):
    assert choose(camera, source='0', namespace='/cell_1/') == [
        camera._replace(source='0', namespace='cell_1')]


def test_parameter_files_with_a_comma_are_fused_cameras_named_after_them(camera):
    files = [str(CONFIG / f'simulated_{name}.yaml') for name in ('left', 'right')]
    cameras = choose(camera, ', '.join(files), source='simulated')
    assert cameras == [LaunchedCamera(path, 'simulated', f'simulated_{name}')
                       for path, name in zip(files, ('left', 'right'))]
    assert fusion_parameters(cameras) == {'cameras': ['/simulated_left', '/simulated_right']}
    assert is_fused(','.join(files)) and not is_fused(files[0])


def test_fused_cameras_that_cannot_be_told_apart_are_refused(camera, tmp_path):
    left = str(CONFIG / 'simulated_left.yaml')
    with pytest.raises(InvalidValueError, match="the namespace 'simulated_left': give each"):
        choose(camera, f'{left},{left}')
    with pytest.raises(InvalidValueError, match='name two parameter files'):
        choose(camera, f'{left},')
    with pytest.raises(InvalidValueError, match='leave out namespace:=cell'):
        choose(camera, f'{left},{camera.params_file}', namespace='cell')
    with pytest.raises(InvalidValueError, match="cell.yaml' does not name its source"):
        fusion_parameters(choose(camera, f'{left},{camera.params_file}'))


def test_sample_list_has_two_cameras_with_their_files():
    cameras = read_cameras(str(CONFIG / 'two_cameras.yaml'))
    assert [camera.namespace for camera in cameras] == ['cell_1', 'cell_2']
    assert all(Path(camera.params_file).is_file() for camera in cameras)


def test_params_file_is_looked_for_beside_the_list(write, tmp_path):
    left, = read_cameras(write('- {namespace: left, params_file: left.yaml, source: 2}'))
    assert left == LaunchedCamera(str(tmp_path / 'left.yaml'), '2', 'left')


@pytest.mark.parametrize('source, device', [
    ('auto', '/dev/video0'), ('2', '/dev/video2'), ('/dev/v4l/by-id/left', '/dev/v4l/by-id/left')])
def test_source_names_the_drivers_device(source, device):
    assert LaunchedCamera('cell.yaml', source, camera_driver='usb_cam').device == device


@pytest.mark.parametrize('changes, sentence', [
    ({'params_file': 'nowhere.yaml'}, "params_file: there is no file 'nowhere.yaml'"),
    ({'camera_driver': 'webcam'}, "must be usb_cam, v4l2_camera or none, got 'webcam'"),
    ({'camera_driver': 'usb_cam', 'source': 'simulated'},
     "usb_cam opens a device, and the source 'simulated' is none: use a number"),
    ({'source': '0', 'image_topic': '/image'}, "image_topic '/image' or from the source '0'"),
    ({'namespace': '1st'}, "may start with a digit, got '1st'"),
    ({'image_topic': '/my image'}, "image_topic must be made of .*, got '/my image'"),
])
def test_camera_that_cannot_be_started_is_refused(changes, sentence, camera):
    with pytest.raises(InvalidValueError, match=sentence):
        choose(camera, **changes)


def test_argument_beside_a_list_is_refused(camera, write):
    with pytest.raises(InvalidValueError, match='for each camera: leave out source:=0'):
        choose(camera, write('[]'), source='0')


@pytest.mark.parametrize('text, sentence', [
    ('', "cells.yaml' is no list of cameras"),
    ('namespace: left', "cells.yaml' is no list of cameras"),
    ('- [', "cells.yaml' is no YAML: while parsing"),
    ('- left', "camera 1 in '.*cells.yaml': expected 'namespace: ...' and so on, got 'left'"),
    ('- {params_file: left.yaml, source: 0}', 'camera 1 .*: namespace is missing'),
    ('- {namespace: left, source: 0}', 'camera 1 .*: params_file is missing'),
    ('- {namespace: left, params_file: left.yaml}', 'a source or an image_topic of its own'),
    ('- {namespace: left, params_file: left.yaml, sorce: 0}', "there is no 'sorce', only params_"),
    ('- {namespace: left, params_file: left.yaml, source: }', 'source must be a text, got None'),
    ('- {namespace: "", params_file: left.yaml, source: 0}', "namespace must be a text, got ''"),
    ('- {namespace: left, params_file: right.yaml, source: 0}', "there is no file '.*right.yaml'"),
    ('- {namespace: left, params_file: left.yaml, source: 0}\n' * 2,
     "two cameras in '.*cells.yaml' have the namespace 'left': give each its own"),
])
def test_bad_list_is_one_clear_sentence(text, sentence, write):
    with pytest.raises(InvalidValueError, match=sentence) as error:
        read_cameras(write(text))
    assert '\n' not in str(error.value)


def test_list_that_there_is_not_is_named():
    with pytest.raises(InvalidValueError, match="cannot read the list of cameras 'nowhere.yaml'"):
        read_cameras('nowhere.yaml')
