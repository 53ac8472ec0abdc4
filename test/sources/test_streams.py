# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A camera that comes and goes, by real streams, real processes and real signals."""

import contextlib
import importlib.util
import math
import os
import signal
import subprocess
import sys
import time

from camera_to_base.detection import settings as detector_settings
from camera_to_base.detection.precise.detector import PreciseDifferenceDetector
from camera_to_base.nodes.camera_publisher import CameraPublisher
from child_camera import ChildCamera
import damaged_frames
from geometry_msgs.msg import PoseArray
from mjpeg_server import MjpegServer
import pytest
from ros_helpers import assert_in_time, BASE_TOPIC, CAMERA_TOPIC, NotInTime, OBJECTS_TOPIC
from rtsp_server import RtspServer
import scenes

pytestmark = pytest.mark.slow

CM_PER_PX = 36.0 / 640
SCRIPTS = ['mjpeg_server', 'rtsp_server']
SERVERS = [MjpegServer, RtspServer]

# A camera's driver, too, can hang for longer than a node may take to end.
PATIENT_NODE = os.path.join(os.path.dirname(__file__), '..', 'patient_camera_node.py')

# What `ros2 launch camera_to_base camera_to_base.launch.py` does.
LAUNCH = """
import os
import sys

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription

file = os.path.join(
    get_package_share_directory('camera_to_base'), 'launch', 'camera_to_base.launch.py')
service = LaunchService()
service.include_launch_description(LaunchDescription([IncludeLaunchDescription(
    file, launch_arguments=[argument.split(':=', 1) for argument in sys.argv[1:]])]))
sys.exit(service.run())
"""

both_scripts = pytest.mark.parametrize('script', SCRIPTS)
both_servers = pytest.mark.parametrize('server_class', SERVERS)
both_signals = pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
both_moments = pytest.mark.parametrize('moment', ['reading', 'opening'])


def ages(positions):
    """Tell how old each position was when it was sent, by the clock on the picture."""
    return [scenes.clock_age(x / CM_PER_PX, sent) for sent, (x, _) in positions]


def wait_for_background(ros):
    """Wait until the node has taken its background: it then says that nothing lies there."""
    arrays = ros.listen_to(PoseArray, OBJECTS_TOPIC)
    assert ros.spin_until(lambda: arrays)
    assert not arrays[0].poses
    ros.stop_listening(OBJECTS_TOPIC)


def stream_arguments(url, *more):
    # The tutorial's surface to a hundredth of a mm, and yet a calibration.
    return ['-p', f'source:={url}', '-p', 'surface.parallel.width_cm:=36.001', *more]


@both_scripts
@pytest.mark.parametrize('away, back', [('kill', 'start'), ('freeze', 'thaw')])
def test_lost_camera_is_reported_publishes_nothing_and_is_back_within_2_s(
        ros, start, script, away, back):
    positions = ros.listen_with_time(CAMERA_TOPIC)
    lines = ros.listen_to_log('camera_publisher')
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    with ChildCamera(script, 'clock') as camera:
        start('camera_publisher', *stream_arguments(camera.url))
        wait_for_background(ros)
        camera.show_disc()
        assert ros.spin_until(lambda: len(positions) >= 20 and statuses and lines, 15.0)
        getattr(camera, away)()
        left_at = time.monotonic()
        ros.spin_for(0.5)
        count = len(positions)
        ros.spin_for(1.0)
        assert 'nothing is published' in lines[-1].text
        first = next(status for status in statuses
                     if status.received_at > left_at and status.level == 2)
        assert 'nothing is published' in first.message
        assert_in_time(max(lines[-1].received_at, first.received_at) - left_at, 1.5)
        ros.spin_for(left_at + 5.0 - time.monotonic())
        assert len(positions) == count
        assert statuses[-1].level == 2 and 'nothing is published' in statuses[-1].message
        told = [line for line in lines if line.received_at > left_at]
        assert len(told) == 1
        returned_at = time.time()
        getattr(camera, back)()
        if back == 'start':
            returned_at = time.time()  # its interpreter had to start first
        assert ros.spin_until(lambda: len(positions) >= count + 20, 10.0)
        returned = positions[count:]
        assert_in_time(returned[0][0] - returned_at, 2.0)
        assert_in_time(max(ages(positions)), 0.3)
        assert ros.spin_until(lambda: statuses[-1].level == 0, 3.0)
        if statuses[-1].values['reconnects'] != '1':
            raise NotInTime('a busy computer lost the camera that came back once more')


@both_scripts
def test_camera_that_is_not_there_yet_is_waited_for_and_said_once(ros, start, script):
    positions, lines = ros.listen(CAMERA_TOPIC), ros.listen_to_log('camera_publisher')
    with ChildCamera(script, 'clock') as camera:
        camera.kill()
        node = start('camera_publisher', *stream_arguments(camera.url))
        assert ros.spin_until(lambda: lines, 10.0)
        ros.spin_for(2.5)
        assert node.is_running
        assert len([line for line in lines if 'waiting for the camera' in line.text]) == 1
        camera.start()
        wait_for_background(ros)
        camera.show_disc()
        assert ros.spin_until(lambda: positions, 15.0)


@both_scripts
def test_camera_that_is_not_there_ends_the_node_where_it_shall_not_wait(start, script):
    with ChildCamera(script) as camera:
        camera.kill()
        node = start('camera_publisher', *stream_arguments(
            camera.url, '-p', 'wait_for_camera:=false'))
        assert node.wait() == 1
    assert f"cannot open camera '{camera.url}'" in node.output
    assert 'Traceback' not in node.output


def start_node_whose_camera_hangs(ros, start, camera, executable, moment='reading'):
    """Start a node, and freeze its camera while the node opens it or reads."""
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    if moment == 'opening':
        camera.freeze()
    node = start(executable, *stream_arguments(camera.url))
    assert ros.spin_until(lambda: statuses and (
        moment == 'opening' or int(statuses[-1].values['frames read']) > 3), 10.0)
    camera.freeze()
    ros.spin_for(0.3)
    return node


@both_servers
@both_signals
@both_moments
def test_signal_ends_a_node_whose_camera_hangs_within_2_5_s(
        ros, start, server_class, number, moment):
    with server_class(scenes.coin()) as camera:
        node = start_node_whose_camera_hangs(ros, start, camera, 'camera_publisher', moment)
        assert node.end(number, 2.5) == 0
    assert_ended_quietly(node)


@both_servers
@both_signals
@both_moments
def test_signal_ends_a_node_whose_camera_hangs_for_longer_than_it_may_take(
        ros, start, monkeypatch, server_class, number, moment):
    monkeypatch.setenv('STREAM_TIMEOUT_MS', '30000')
    with server_class(scenes.coin()) as camera:
        node = start_node_whose_camera_hangs(ros, start, camera, PATIENT_NODE, moment)
        begin = time.monotonic()
        assert node.end(number, 2.5) == 0
        assert time.monotonic() - begin > 1.5  # the reader was waited for, in vain
    assert_ended_quietly(node)


def test_read_that_returns_while_the_node_exits_does_no_harm(ros, start, monkeypatch):
    # Frozen 0.3 s before the signal, and the reader is waited for 1.9 s from then on.
    monkeypatch.setenv('STREAM_TIMEOUT_MS', '2450')
    with MjpegServer(scenes.coin()) as camera:
        node = start_node_whose_camera_hangs(ros, start, camera, PATIENT_NODE)
        assert node.end(signal.SIGINT, 2.5) == 0
    assert_ended_quietly(node)


def assert_ended_quietly(node):
    assert 'Traceback' not in node.output and 'terminate' not in node.output


@both_servers
def test_frame_is_never_old_where_detection_is_slower_than_the_camera(
        ros, monkeypatch, server_class):
    class SlowDetector(PreciseDifferenceDetector):
        def detect(self, frame):
            time.sleep(0.16)
            return super().detect(frame)

    monkeypatch.setattr(detector_settings, 'PreciseDifferenceDetector', SlowDetector)
    positions = ros.listen_with_time(CAMERA_TOPIC)
    scene = scenes.Clock()
    with server_class(scene, 20.0) as camera:
        ros.add(CameraPublisher, *stream_arguments(
            camera.url, '-p', 'view.max_shift_px:=0.0'))
        wait_for_background(ros)
        scene.has_disc = True
        # More than one round of the clock: its disc is confirmed again where it starts anew.
        assert ros.spin_until(lambda: len(positions) >= 20, 20.0)
    assert_in_time(max(ages(positions)), 0.3)


@contextlib.contextmanager
def node_that_sees_a_coin(ros, server_class):
    """Run a node on a stream, and put a coin there when the background was taken."""
    scene, positions = scenes.StillCoin(), ros.listen(CAMERA_TOPIC)
    with server_class(scene, 40.0) as camera:
        ros.add(CameraPublisher, *stream_arguments(camera.url))
        wait_for_background(ros)
        scene.has_disc = True
        assert ros.spin_until(lambda: len(positions) > 5)
        yield camera, positions


def largest_error_cm(positions):
    """Tell how far any position is from the coin of :class:`scenes.StillCoin`."""
    return max(math.dist(position, (400 * CM_PER_PX, 300 * CM_PER_PX)) for position in positions)


@both_servers
@pytest.mark.parametrize('name', damaged_frames.DAMAGES)
def test_no_position_is_published_from_a_damaged_frame(ros, server_class, name):
    with node_that_sees_a_coin(ros, server_class) as (camera, positions):
        camera.set_damage(damaged_frames.DAMAGES[name], 0.3)
        ros.spin_for(1.2)
        camera.set_damage(None)
        count = len(positions)
        assert ros.spin_until(lambda: len(positions) > count, 3.0)
    assert camera.damaged_count >= 3
    # One frame of a thousand with flipped bits moves its position by less than confirm_jump_px in
    # x and y, which looks like an object that moves: see docs/how_it_works/damaged_pictures.md.
    assert largest_error_cm(positions) < (0.64 if name.startswith('flip') else 0.2)


def test_garbage_between_frames_does_no_harm(ros):
    with node_that_sees_a_coin(ros, MjpegServer) as (camera, positions):
        camera.garbage = os.urandom(3000) + b'\r\n'
        ros.spin_for(1.5)
        camera.garbage = b''
        count = len(positions)
        assert ros.spin_until(lambda: len(positions) > count, 3.0)
    assert largest_error_cm(positions) < 0.2


def test_frame_that_repeats_the_last_one_gives_no_position(ros):
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    with node_that_sees_a_coin(ros, MjpegServer) as (camera, positions):
        jpeg = camera.next_jpeg()
        camera.set_damage(lambda other: jpeg)
        ros.spin_for(0.3)
        count = len(positions)
        ros.spin_for(1.2)
        assert len(positions) == count
        assert ros.spin_until(lambda: statuses and statuses[-1].level == 2)
        assert 'repeats the last one' in statuses[-1].message


def test_pictures_of_another_size_are_refused_until_the_background_is_taken_anew(ros):
    positions, statuses = ros.listen(CAMERA_TOPIC), ros.listen_to_diagnostics('/camera_publisher')
    with RtspServer(scenes.coin(), 20.0) as camera:
        ros.add(CameraPublisher, *stream_arguments(camera.url))
        assert ros.spin_until(lambda: len(positions) > 5)
        camera.set_damage(damaged_frames.other_size)
        ros.spin_for(0.5)
        count = len(positions)
        assert ros.spin_until(lambda: statuses and '320 x 240' in statuses[-1].message, 3.0)
        assert len(positions) == count
        camera.set_damage(None)
        assert ros.spin_until(lambda: len(positions) > count + 3, 3.0)
        camera.set_damage(damaged_frames.other_size)
        ros.spin_for(0.5)
        response = ros.call('/camera_publisher/capture_background')
        assert response.success and '320 x 240' in response.message
        assert ros.spin_until(lambda: statuses[-1].level == 0, 3.0)


def process_of(launch, executable):
    pids = subprocess.run(['pgrep', '-g', str(launch.pid), '-f', f'/{executable} '],
                          capture_output=True, text=True).stdout.split()
    assert len(pids) == 1
    return int(pids[0])


needs_launch = pytest.mark.skipif(
    importlib.util.find_spec('launch_ros') is None,
    reason='launch and launch_ros are not installed')


@contextlib.contextmanager
def launched(camera):
    """Run the launch file on a camera's stream."""
    launch = subprocess.Popen([sys.executable, '-c', LAUNCH, f'source:={camera.url}'],
                              stdout=subprocess.DEVNULL, start_new_session=True)
    try:
        yield launch
    finally:
        os.killpg(launch.pid, signal.SIGINT)  # as Ctrl-C in a terminal does
        launch.wait(timeout=10.0)


@needs_launch
def test_node_that_was_killed_is_back_under_the_launch_file_within_5_s(ros, tell):
    positions = ros.listen_with_time(BASE_TOPIC)
    with ChildCamera('mjpeg_server', 'clock') as camera:
        with launched(camera) as launch:
            wait_for_background(ros)
            camera.show_disc()
            assert ros.spin_until(lambda: len(positions) > 10, 20.0)
            for executable in ('camera_publisher', 'robot_base_publisher'):
                killed_at = time.time()
                os.kill(process_of(launch, executable), signal.SIGKILL)
                ros.spin_for(0.5)  # what was on its way arrives
                count = len(positions)
                assert ros.spin_until(lambda: len(positions) > count + 20, 10.0)
                tell(f'{executable} killed: the next position came '
                     f'{positions[count][0] - killed_at:.2f} s later')
                assert_in_time(positions[count][0] - killed_at, 5.0)
    oldest = max(ages([(sent, (x + 17.8, y)) for sent, (x, y) in positions]))
    tell(f'{len(positions)} positions, the oldest of a frame {oldest:.2f} s old')
    assert_in_time(oldest, 0.3)


@needs_launch
def test_coin_at_rest_is_published_within_5_s_of_a_kill_under_the_launch_file(ros, tell):
    positions = ros.listen_with_time(CAMERA_TOPIC)
    with ChildCamera('mjpeg_server', 'still_coin') as camera, launched(camera) as launch:
        assert ros.spin_until(lambda: len(positions) > 10, 20.0)
        killed_at = time.time()
        os.kill(process_of(launch, 'camera_publisher'), signal.SIGKILL)
        ros.spin_for(0.5)  # what was on its way arrives
        positions.clear()
        assert ros.spin_until(lambda: len(positions) > 10, 10.0)
    back_after = positions[0][0] - killed_at
    tell(f'camera_publisher killed: the coin at rest came {back_after:.2f} s later')
    assert_in_time(back_after, 5.0)
    assert all(math.dist(position, (400 * CM_PER_PX, 300 * CM_PER_PX)) < 0.2
               for _, position in positions)
