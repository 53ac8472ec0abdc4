# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math

from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.errors import InvalidValueError
from camera_to_base.launching import (
    argument_warnings, check_frames, driver_parameters, Frames, frames, image_input, is_wanted,
    kept_background, LaunchedCamera, not_installed, plays_recording, recording_failure,
    transform_arguments)
import numpy as np
import pytest


@pytest.fixture
def camera(tmp_path):
    """Make a camera of the values in its file."""
    def make(text='{}', section='/**', **fields):
        path = tmp_path / f'{len(list(tmp_path.iterdir()))}.yaml'
        path.write_text(f'{section}: {{ros__parameters: {text}}}')
        return LaunchedCamera(str(path), **fields)
    return make


def options_of(arguments):
    return dict(zip(arguments[::2], arguments[1::2]))


def turned(angle, axis):
    """Turn about one axis, by the textbook."""
    matrix = np.eye(3)
    i, j = [number for number in range(3) if number != axis]
    matrix[i, i] = matrix[j, j] = math.cos(angle)
    sign = -1 if axis == 1 else 1
    matrix[i, j], matrix[j, i] = -sign * math.sin(angle), sign * math.sin(angle)
    return matrix


def test_transform_is_the_tutorials_in_m_and_rad_where_the_file_is_silent(camera):
    assert transform_arguments(camera()) == [
        '--x', '-0.178', '--y', '0.244', '--z', '0', '--roll', '3.14159265359', '--pitch', '0',
        '--yaw', '0', '--frame-id', 'base_link', '--child-frame-id', 'camera_surface']


def test_transform_is_the_one_that_the_transform_node_applies(camera):
    rotation, displacement = [170.0, -20.0, 35.0], [12.5, -3.0, 1.5]
    options = options_of(transform_arguments(
        camera(f'{{rotation_deg: {rotation}, displacement_cm: {displacement}}}')))
    roll, pitch, yaw = (float(options[f'--{name}']) for name in ('roll', 'pitch', 'yaw'))
    # What static_transform_publisher makes of them: tf2's setRPY.
    published = turned(yaw, 2) @ turned(pitch, 1) @ turned(roll, 0)
    applied = CameraToRobotBaseConversion.from_roll_pitch_yaw(rotation, displacement)
    assert published == pytest.approx(applied.base_from_camera[:3, :3], abs=1e-10)
    assert [100 * float(options[f'--{name}']) for name in 'xyz'] == pytest.approx(displacement)


@pytest.mark.parametrize('section, yaw', [
    ('/cell_1/robot_base_publisher', 90), ('/**/robot_base_publisher', 90),
    ('/cell_1/camera_publisher', 0), ('/cell_2/robot_base_publisher', 0)])
def test_transform_comes_from_the_sections_of_the_transform_node(section, yaw, camera):
    options = options_of(transform_arguments(
        camera('{rotation_deg: [0, 0, 90]}', section, namespace='cell_1')))
    assert math.degrees(float(options['--yaw'])) == pytest.approx(yaw)


def test_transform_that_is_no_numbers_is_named(camera):
    with pytest.raises(InvalidValueError, match='rotation_deg must be 3 numbers'):
        transform_arguments(camera('{rotation_deg: [0.0, 0.0]}'))


@pytest.mark.parametrize('text, namespace, expected', [
    ('{}', '', Frames('base_link', 'camera_surface')),
    ('{}', 'cell_1', Frames('base_link', 'cell_1/camera_surface')),
    ('{base_frame_id: base, camera_frame_id: table}', 'cell_1', Frames('base', 'table'))])
def test_frames_are_those_of_the_file_or_follow_the_namespace(text, namespace, expected, camera):
    assert frames(camera(text, namespace=namespace)) == expected


def test_two_silent_files_have_frames_that_do_not_clash(camera):
    check_frames([camera(namespace='left'), camera(namespace='right')])


def test_two_cameras_with_one_frame_are_refused(camera):
    table = '{camera_frame_id: table}'
    with pytest.raises(InvalidValueError, match="in 'left' and 'right' both have .* 'table'"):
        check_frames([camera(table, namespace='left'), camera(table, namespace='right')])


def test_frame_that_would_be_its_own_parent_is_refused(camera):
    with pytest.raises(InvalidValueError, match="are both 'base_link'"):
        check_frames([camera('{camera_frame_id: base_link}')])


@pytest.mark.parametrize('fields, source, remappings', [
    ({'source': '0'}, '0', []),
    ({'image_topic': '/left/image_raw'}, 'topic', [('image', '/left/image_raw')]),
    ({'image_topic': 'image_raw/compressed'}, 'compressed_topic',
     [('image/compressed', 'image_raw/compressed')]),
    ({'camera_driver': 'usb_cam', 'source': '2'}, 'topic', [('image', 'image_raw')]),
    ({'camera_driver': 'usb_cam', 'image_topic': 'image_rect'}, 'topic',
     [('image', 'image_rect')])])
def test_camera_node_listens_to_the_topic_that_was_asked_for(fields, source, remappings, camera):
    assert image_input(camera(**fields)) == (source, remappings)


@pytest.mark.parametrize('text, named, source', [
    ('{source: /dev/video2}', 'auto', '/dev/video2'), ('{source: 2}', 'auto', '2'),
    ('{source: 2}', 'simulated', 'simulated'), ('{}', 'auto', 'auto')])
def test_source_in_the_file_is_not_replaced_where_the_launch_names_none(
        text, named, source, camera):
    assert image_input(camera(text, source=named)) == (source, [])


@pytest.mark.parametrize('fields, text, is_kept', [
    ({}, '{}', True), ({'source': '0'}, '{}', True), ({'source': 'http://cam/'}, '{}', True),
    ({'image_topic': '/image_raw'}, '{}', True), ({'camera_driver': 'usb_cam'}, '{}', True),
    ({'source': 'simulated'}, '{}', False), ({'source': 'random'}, '{}', False),
    ({'source': 'day.avi'}, '{}', False), ({}, '{source: day.avi}', False),
    ({}, '{background_file: mine.png}', False), ({}, "{background_file: ''}", False)])
def test_background_of_a_camera_is_kept_unless_the_file_says_where(
        fields, text, is_kept, camera):
    expected = {'background_file': 'here.png'} if is_kept else {}
    assert kept_background(camera(text, **fields), 'here.png') == expected


@pytest.mark.parametrize('driver, size', [
    ('usb_cam', {'image_width': 1280, 'image_height': 720}),
    ('v4l2_camera', {'image_size': [1280, 720]})])
def test_driver_is_asked_for_the_pictures_that_were_calibrated(driver, size, camera):
    described = camera('{surface: {image_size: [1280, 720]}}', source='2', camera_driver=driver)
    assert driver_parameters(described) == {'video_device': '/dev/video2', **size}


def test_driver_is_asked_for_the_default_size_where_the_file_is_silent(camera):
    parameters = driver_parameters(camera(camera_driver='v4l2_camera'))
    assert parameters['image_size'] == [640, 480]


def test_missing_package_is_named_with_the_cure():
    assert not_installed('tf2_ros', 'publish_tf:=true', 'jazzy') == (
        'publish_tf:=true needs the package tf2_ros, which is not installed: '
        'sudo apt install ros-jazzy-tf2-ros')


def test_switch_is_true_or_false():
    assert is_wanted('rviz', 'True') and not is_wanted('rviz', 'false')
    with pytest.raises(InvalidValueError, match="rviz must be true or false, got 'yes'"):
        is_wanted('rviz', 'yes')


@pytest.mark.parametrize('given, ours_alone, told', [
    ('sorce', False, ["there is no launch argument 'sorce', it is left out: did you mean "
                      "'source'?"]),
    ('device', True, ["there is no launch argument 'device', it is left out"]),
    ('device', False, []), ('source', True, []), ('ros_namespace', False, []),
    ('launch-prefix', True, [])])
def test_argument_that_launch_would_ignore_is_told(given, ours_alone, told):
    assert argument_warnings([given], ['source', 'namespace'], ours_alone) == told


@pytest.mark.parametrize('source, is_recording', [
    ('day.avi', True), ('day.mcap', True), ('auto', False), ('0', False), ('random', False),
    ('/dev/video0', False), ('rtsp://cell/1', False), ('simulated', False)])
def test_only_recordings_end_a_camera_node(camera, source, is_recording):
    assert plays_recording(camera('{}', source=source)) is is_recording
    in_file = camera(f"{{source: '{source}'}}")
    assert plays_recording(in_file) is is_recording
    assert not plays_recording(camera('{}', image_topic='day.avi'))


@pytest.mark.parametrize('exit_code, is_final', [
    (-6, True), (-11, True), (70, True), (-9, False), (-15, False), (0, False), (1, False)])
def test_node_that_a_recording_kills_is_not_started_again(camera, exit_code, is_final):
    assert bool(recording_failure(camera('{}', source='day.avi'), exit_code)) is is_final
    assert not recording_failure(camera('{}', source='0'), exit_code)
