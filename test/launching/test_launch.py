# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""What the launch file starts; stand-ins take the place of executables, and of other packages."""

import importlib.util
import logging
import os
from pathlib import Path
import re
import subprocess
import sys

from camera_to_base.errors import InvalidValueError
from camera_to_base.parameters import read_node_parameters
import pytest

pytest.importorskip('launch_ros', reason='ros2 launch is not installed')
launch = pytest.importorskip('launch')
actions = pytest.importorskip('launch.actions')
event_handlers = pytest.importorskip('launch.event_handlers')
sources = pytest.importorskip('launch.launch_description_sources')
Node = pytest.importorskip('launch_ros.actions').Node

ROOT = Path(__file__).parents[2]
LAUNCH_FILE = str(ROOT / 'launch/camera_to_base.launch.py')
OURS = {'camera_publisher', 'robot_base_publisher'}
OWN = 'kept_by_the_user.png'
OTHERS = {'tf2_ros': 'static_transform_publisher', 'rviz2': 'rviz2',
          'usb_cam': 'usb_cam_node_exe', 'v4l2_camera': 'v4l2_camera_node'}


class Prefix:
    """An install space of stand-ins."""

    def __init__(self, path):
        self.path = path

    def add(self, package, *executables, script='exec sleep 60'):
        """Install a package whose executables do nothing, or what the script says."""
        marker = self.path / 'share/ament_index/resource_index/packages' / package
        libexec = self.path / 'lib' / package
        for directory in (marker.parent, libexec):
            directory.mkdir(parents=True, exist_ok=True)
        marker.touch()
        for executable in executables:
            (libexec / executable).write_text(f'#!/bin/sh\n{script}\n')
            (libexec / executable).chmod(0o755)


@pytest.fixture
def prefix(tmp_path, monkeypatch):
    prefix = Prefix(tmp_path / 'install')
    prefix.add('camera_to_base', *OURS, 'dashboard')
    share = prefix.path / 'share/camera_to_base'
    share.mkdir()
    for directory in ('config', 'launch'):
        (share / directory).symlink_to(ROOT / directory)
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(prefix.path))
    return prefix


@pytest.fixture
def log(caplog, monkeypatch):
    """Record what is logged: launch's loggers keep it to themselves."""
    for name in ('launch', 'camera_to_base'):
        monkeypatch.setattr(logging.getLogger(name), 'propagate', True)
    return caplog


def description():
    spec = importlib.util.spec_from_file_location('launch_file', LAUNCH_FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.generate_launch_description()


def described(**arguments):
    """Return the executables that the launch file would start."""
    context = launch.LaunchContext()
    context.launch_configurations.update(arguments)
    entities = [action for entity in description().entities
                for action in entity.visit(context) or []]
    return sorted(entity.node_executable for entity in entities if isinstance(entity, Node))


def run_until(count, **arguments):
    """Launch for real until so many processes were started; return exit code and command lines."""
    commands = []
    end = actions.EmitEvent(event=launch.events.Shutdown())

    def on_start(event, context):
        commands.append(' '.join(event.cmd))
        return end if len(commands) == count else None

    def on_time_out(context):
        raise AssertionError(f'still running after 20 s: {commands}')

    service = launch.LaunchService(noninteractive=True)
    service.include_launch_description(launch.LaunchDescription([
        actions.RegisterEventHandler(event_handlers.OnProcessStart(on_start=on_start)),
        actions.TimerAction(period=20.0, actions=[actions.OpaqueFunction(function=on_time_out)]),
        actions.IncludeLaunchDescription(
            sources.PythonLaunchDescriptionSource(LAUNCH_FILE),
            launch_arguments=arguments.items())]))
    return service.run(), commands


def started(count, **arguments):
    """Launch for real until so many processes were started; return their command lines."""
    code, commands = run_until(count, **arguments)
    assert code == 0
    return commands


def command_of(executable, commands):
    command, = (command for command in commands if f'/{executable} ' in command)
    return command


def test_both_nodes_are_started_and_nothing_else(prefix):
    assert described() == sorted(OURS)


def test_every_argument_has_a_default_and_a_description(prefix):
    arguments = {argument.name: argument for argument in description().get_launch_arguments()}
    assert list(arguments) == ['params_file', 'source', 'namespace', 'image_topic',
                               'camera_driver', 'cameras', 'publish_tf', 'rviz', 'dashboard']
    for argument in arguments.values():
        assert argument.default_value is not None and argument.description.endswith('.')


@pytest.mark.parametrize('argument, value, package', [
    ('publish_tf', 'true', 'tf2_ros'), ('rviz', 'true', 'rviz2'),
    ('camera_driver', 'usb_cam', 'usb_cam'), ('camera_driver', 'v4l2_camera', 'v4l2_camera')])
def test_what_was_asked_for_is_started_or_named_where_it_is_missing(
        argument, value, package, prefix):
    sentence = f'{argument}:={value} needs the package {package}, which is not installed: sudo apt'
    with pytest.raises(InvalidValueError, match=sentence):
        described(**{argument: value})
    prefix.add(package, OTHERS[package])
    assert described(**{argument: value}) == sorted({*OURS, OTHERS[package]})


def test_the_dashboard_is_started_once_and_saves_to_the_file_that_was_given(prefix, tmp_path):
    assert described(dashboard='true') == sorted([*OURS, 'dashboard'])
    assert described(dashboard='true', cameras=str(ROOT / 'config/two_cameras.yaml')) == sorted(
        [*OURS, *OURS, 'dashboard'])
    cell = tmp_path / 'cell.yaml'
    cell.write_text('/**: {ros__parameters: {reach_cm: 30.0}}')
    command = command_of('dashboard', started(3, dashboard='true', params_file=str(cell)))
    written = ''.join(Path(path).read_text()
                      for path in re.findall(r'--params-file (\S*launch_params\S*)', command))
    assert f'params_file: {cell}' in written


def test_the_dashboard_does_not_save_to_the_installed_file(prefix):
    command = command_of('dashboard', started(3, dashboard='true'))
    assert 'overhead_camera' not in command


def test_with_the_dashboard_a_params_file_that_does_not_exist_is_made(prefix, tmp_path, log):
    cell = tmp_path / 'cell.yaml'
    assert described(dashboard='true', params_file=str(cell), source='2') == sorted(
        [*OURS, 'dashboard'])
    assert read_node_parameters(str(cell), '/camera_publisher') == {'source': '2'}
    assert f"params_file '{cell}' is new: the dashboard saves the calibration to it" in log.text
    with pytest.raises(InvalidValueError, match="there is no folder '.*nowhere'"):
        described(dashboard='true', params_file=str(tmp_path / 'nowhere' / 'cell.yaml'))


def test_two_cameras_have_two_nodes_and_a_transform_each(prefix):
    prefix.add('tf2_ros', 'static_transform_publisher')
    assert described(cameras=str(ROOT / 'config/two_cameras.yaml'), publish_tf='true') == sorted(
        [*OURS, 'static_transform_publisher'] * 2)


def test_two_parameter_files_start_two_cameras_and_the_node_that_fuses_them(prefix):
    files = ','.join(str(ROOT / f'config/simulated_{name}.yaml') for name in ('left', 'right'))
    assert described(cameras=files) == sorted([*OURS, *OURS, 'camera_fusion'])


def test_two_cameras_whose_frames_clash_are_refused_with_publish_tf_only(prefix, tmp_path):
    prefix.add('tf2_ros', 'static_transform_publisher')
    (tmp_path / 'table.yaml').write_text('/**: {ros__parameters: {camera_frame_id: table}}')
    (tmp_path / 'cells.yaml').write_text(''.join(
        f'- {{namespace: {side}, params_file: table.yaml, source: simulated}}\n'
        for side in ('left', 'right')))
    assert described(cameras=str(tmp_path / 'cells.yaml')) == sorted([*OURS] * 2)
    with pytest.raises(InvalidValueError, match="both have the camera_frame_id 'table'"):
        described(cameras=str(tmp_path / 'cells.yaml'), publish_tf='true')


def test_missing_params_file_is_one_error(prefix):
    with pytest.raises(InvalidValueError, match="params_file: there is no file 'nowhere.yaml'"):
        described(params_file='nowhere.yaml')


@pytest.mark.slow
def test_camera_node_gets_the_file_the_source_and_the_frame(prefix):
    commands = started(2, source='0', namespace='cell_1')
    command = command_of('camera_publisher', commands)
    assert '-r __ns:=/cell_1 --params-file' in command
    assert 'config/overhead_camera.yaml' in command
    text = Path(command.split()[-1]).read_text()
    assert "source: '0'" in text and 'camera_frame_id: cell_1/camera_surface' in text
    transform = Path(command_of('robot_base_publisher', commands).split()[-1]).read_text()
    assert 'camera_frame_id: cell_1/camera_surface' in transform


def background_files(commands):
    texts = [Path(command.split()[-1]).read_text() for command in commands
             if '/camera_publisher ' in command]
    return re.findall(r'background_file: (.*)', '\n'.join(texts))


@pytest.mark.slow
def test_each_camera_keeps_its_background_in_a_file_of_this_launch(prefix, tmp_path):
    (tmp_path / 'cell.yaml').write_text('/**: {ros__parameters: {}}')
    (tmp_path / 'own.yaml').write_text(f'/**: {{ros__parameters: {{background_file: {OWN}}}}}')
    (tmp_path / 'cells.yaml').write_text(''.join(
        f'- {{namespace: {name}, params_file: {file}.yaml, source: {source}}}\n'
        for name, file, source in (('left', 'cell', '0'), ('right', 'cell', '1'),
                                   ('own', 'own', '2'), ('played', 'cell', 'day.avi'))))
    first, second = (background_files(started(8, cameras=str(tmp_path / 'cells.yaml')))
                     for _ in range(2))
    assert len({*first, *second}) == len(first) + len(second) == 4
    assert all(Path(file).parent.is_dir() for file in (*first, *second))


@pytest.mark.slow
def test_folder_of_the_backgrounds_goes_with_the_launch(prefix, tmp_path):
    (tmp_path / 'temporary').mkdir()
    code = (f'import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})\n'
            'import os, test_launch\n'
            "test_launch.described(source='0')\n"
            'print(len(os.listdir(os.environ["TMPDIR"])))')
    child = subprocess.run(
        [sys.executable, '-c', code], capture_output=True, text=True, timeout=60,
        env={**os.environ, 'TMPDIR': str(tmp_path / 'temporary')})
    assert child.stdout.strip() == '1', child.stderr
    assert list((tmp_path / 'temporary').iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize('topic, remapping', [
    ('/left/image_raw', '-r image:=/left/image_raw'),
    ('image/compressed', '-r image/compressed:=image/compressed')])
def test_image_topic_is_remapped(topic, remapping, prefix):
    assert remapping in command_of('camera_publisher', started(2, image_topic=topic))


@pytest.mark.slow
def test_driver_is_started_where_its_topic_is_listened_to(prefix):
    prefix.add('usb_cam', 'usb_cam_node_exe')
    commands = started(3, camera_driver='usb_cam', source='2', namespace='cell_1')
    assert '__ns:=/cell_1' in command_of('usb_cam_node_exe', commands)
    assert '-r image:=image_raw' in command_of('camera_publisher', commands)


@pytest.mark.slow
@pytest.mark.parametrize('chosen', [None, '/etc/own_profiles.xml'])
def test_driver_has_shared_memory_for_raw_pictures(chosen, prefix, monkeypatch, tmp_path):
    variable, seen = 'FASTRTPS_DEFAULT_PROFILES_FILE', tmp_path / 'seen'
    monkeypatch.delenv(variable, raising=False)
    if chosen:
        monkeypatch.setenv(variable, chosen)
    # The node starts once more when the driver has written what it sees, and that ends the launch.
    prefix.add('usb_cam', 'usb_cam_node_exe', script=f'echo "${variable}" > {seen}; exec sleep 60')
    prefix.add('camera_to_base', 'camera_publisher',
               script=f'while [ ! -s {seen} ]; do sleep 0.1; done; exit 70')
    started(4, camera_driver='usb_cam')
    profiles = str(prefix.path / 'share/camera_to_base/config/fastdds/large_pictures.xml')
    assert seen.read_text().strip() == (chosen or profiles)
    assert Path(profiles).is_file()


@pytest.mark.slow
def test_transform_is_that_of_the_parameter_file(prefix):
    prefix.add('tf2_ros', 'static_transform_publisher')
    command = command_of('static_transform_publisher', started(3, publish_tf='true'))
    assert (' --x -0.178 --y 0.244 --z 0 --roll 3.14159265359 --pitch 0 --yaw 0 '
            '--frame-id base_link --child-frame-id camera_surface ') in command


@pytest.mark.slow
def test_rviz_opens_the_installed_configuration_in_the_namespace(prefix):
    prefix.add('rviz2', 'rviz2')
    command = command_of('rviz2', started(3, rviz='true', namespace='cell_1'))
    assert f'-d {prefix.path}/share/camera_to_base/config/camera_to_base.rviz' in command
    assert '-f base_link' in command and '__ns:=/cell_1' in command


def two_recordings(directory):
    (directory / 'cell.yaml').write_text('/**: {ros__parameters: {}}')
    (directory / 'cells.yaml').write_text(''.join(
        f'- {{namespace: {side}, params_file: cell.yaml, source: {side}.avi}}\n'
        for side in ('left', 'right')))
    return str(directory / 'cells.yaml')


@pytest.mark.slow
@pytest.mark.parametrize('death', ['kill -KILL $$', 'kill -SEGV $$', 'exit 70'])
def test_node_that_dies_is_started_again(death, prefix):
    prefix.add('camera_to_base', 'camera_publisher', script=death)
    assert sum('/camera_publisher ' in command for command in started(3)) == 2


@pytest.mark.slow
@pytest.mark.parametrize('package, executable, arguments', [
    ('camera_to_base', 'camera_publisher', {}), ('camera_to_base', 'robot_base_publisher', {}),
    ('tf2_ros', 'static_transform_publisher', {'publish_tf': 'true'})])
def test_node_that_cannot_start_ends_the_launch_and_is_named(
        package, executable, arguments, prefix, log):
    prefix.add(package, executable, script='exit 1')
    code, commands = run_until(4, namespace='cell_1', **arguments)
    assert code == 1 and len(commands) == 2 + len(arguments)
    assert f'/cell_1/{executable} cannot start, as it says itself' in log.text


@pytest.mark.slow
def test_node_that_cannot_start_any_more_ends_the_launch(prefix, tmp_path):
    prefix.add('camera_to_base', 'camera_publisher', script=(
        f'test -e {tmp_path}/ran && exit 1\ntouch {tmp_path}/ran\nkill -KILL $$'))
    code, commands = run_until(4)
    assert code == 1 and len(commands) == 3


@pytest.mark.slow
def test_driver_is_started_again_whatever_its_exit_code(prefix):
    prefix.add('usb_cam', 'usb_cam_node_exe', script='exit 1')
    assert sum('/usb_cam_node_exe ' in command
               for command in started(4, camera_driver='usb_cam')) == 2


@pytest.mark.slow
def test_end_of_a_recording_ends_the_launch(prefix):
    prefix.add('camera_to_base', 'camera_publisher', script='exit 0')
    assert len(started(3, source='day.avi')) == 2


@pytest.mark.slow
@pytest.mark.parametrize('source', ['auto', '0', 'rtsp://cell/1', 'simulated'])
def test_node_of_a_source_without_an_end_that_was_terminated_is_started_again(prefix, source):
    prefix.add('camera_to_base', 'camera_publisher', script='exit 0')
    assert sum('/camera_publisher ' in command for command in started(3, source=source)) == 2


@pytest.mark.slow
def test_node_that_its_recording_kills_ends_the_launch_with_an_error(prefix, log):
    prefix.add('camera_to_base', 'camera_publisher', script='kill -ABRT $$')
    code, commands = run_until(4, source='day.avi')
    assert code == 1 and len(commands) == 2
    assert "camera_publisher has died (signal 6) while it played 'day.avi'" in log.text


@pytest.mark.slow
def test_end_of_one_recording_leaves_the_other_camera_alone(prefix, tmp_path):
    # The other one is restarted long after the first one would have been.
    prefix.add('camera_to_base', 'camera_publisher', script=(
        'case "$*" in *__ns:=/left*) exit 0;; esac\nsleep 2\nkill -KILL $$'))
    commands = [command for command in started(5, cameras=two_recordings(tmp_path))
                if '/camera_publisher ' in command]
    assert ['__ns:=/left' in command for command in commands].count(True) == 1
    assert len(commands) == 3


@pytest.mark.slow
def test_end_of_all_recordings_ends_the_launch(prefix, tmp_path):
    prefix.add('camera_to_base', 'camera_publisher', script='exit 0')
    assert len(started(5, cameras=two_recordings(tmp_path))) == 4


def test_misspelt_argument_is_told_with_what_was_meant(prefix, log):
    described(sorce='0', device='0')
    assert log.messages == [
        "there is no launch argument 'sorce', it is left out: did you mean 'source'?"]


def test_misspelt_argument_reaches_the_camera_node_which_then_draws_no_random_positions(prefix):
    command = command_of('camera_publisher', started(2, sorce='simulated', device='0'))
    written = ''.join(Path(path).read_text()
                      for path in re.findall(r'--params-file (\S*launch_params\S*)', command))
    assert 'sorce: simulated' in written and 'device' not in written


def test_unknown_argument_is_told_where_nobody_includes_the_launch_file(
        prefix, log, monkeypatch):
    monkeypatch.setattr(
        'sys.argv', ['ros2', 'launch', 'camera_to_base', 'camera_to_base.launch.py', 'device:=0'])
    described(device='0')
    assert "no launch argument 'device', it is left out" in log.text
