# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math
import os
import re
import signal
import subprocess
import sys
import time

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
import cv2
import numpy as np
import pytest
from ros_helpers import assert_in_time, BASE_TOPIC, CAMERA_TOPIC, TRUE_TOPIC
from std_msgs.msg import Float64MultiArray

PARAMETERS = os.path.join(get_package_share_directory('camera_to_base'), 'config')
DEMO = os.path.join(os.path.dirname(__file__), '..', '..', 'scripts', 'demo.py')


def write_video(path, positions, size=(320, 240), fps=30.0):
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*'MJPG'), fps, size)
    for position in positions:
        frame = np.full((size[1], size[0], 3), 200, np.uint8)
        if position is not None:
            cv2.circle(frame, position, 25, (40, 40, 40), -1)
        writer.write(frame)
    writer.release()


def run_calibrate(*arguments):
    path = os.path.join(get_package_prefix('camera_to_base'), 'lib', 'camera_to_base', 'calibrate')
    return subprocess.run([path, *map(str, arguments)], capture_output=True, text=True, timeout=60)


def tutorial_positions(path, cm_per_px):
    """Compute what the tutorial's program would publish for a video, written out plainly."""
    def treat(frame):
        grey = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
        closed = cv2.morphologyEx(grey, cv2.MORPH_CLOSE, np.ones((20, 20), np.uint8))
        return cv2.medianBlur(closed, 5)

    capture, positions, background = cv2.VideoCapture(str(path)), [], None
    while True:
        good, frame = capture.read()
        if not good:
            return positions
        if background is None:
            background = treat(frame)
        difference = cv2.absdiff(treat(frame), background)
        _, mask = cv2.threshold(difference, 95, 255, cv2.THRESH_BINARY)
        contours, _ = cv2.findContours(mask, cv2.RETR_TREE, cv2.CHAIN_APPROX_SIMPLE)
        if contours:
            largest = contours[np.argmax([cv2.contourArea(contour) for contour in contours])]
            x, y, w, h = cv2.boundingRect(largest)
            positions.append([(x + int(w / 2)) * cm_per_px, (y + int(h / 2)) * cm_per_px])


def check_simulated_coin_in_the_base_frame(ros, start, file, *more):
    """Start both nodes with a parameter file, and compare a dozen positions with the truth."""
    base, true = ros.listen_with_time(BASE_TOPIC), ros.listen_with_time(TRUE_TOPIC)
    start('robot_base_publisher', '--params-file', file)
    # Slow enough that a busy machine cannot mistake one frame's truth for the next one's.
    start('camera_publisher', '--params-file', file, '-p', 'source:=simulated',
          '-p', 'simulated.frame_rate:=4.0', *more)
    # What was sent while the nodes still discovered each other is delivered up to 4 s late.
    assert ros.spin_until(
        lambda: true and len([sent for sent, _ in base if sent > true[0][0] + 4.0]) >= 12)
    positions = list(base)
    ros.spin_for(0.2)  # topics do not wait for each other: let the last one's truth arrive
    conversion = CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)
    for sent, position in positions:
        if sent <= true[0][0] + 4.0:
            continue
        _, true_point = max(entry for entry in true if entry[0] <= sent)
        true_base = conversion.convert_surface_points([true_point])[0][:2]
        assert math.dist(position, true_base) < 0.2


@pytest.mark.slow
@pytest.mark.parametrize('tilt_deg, parameters', [
    (0, 'overhead_camera.yaml'), (30, 'simulated_tilted_camera.yaml')])
def test_simulated_coin_arrives_in_the_base_frame_within_2_mm(ros, start, tilt_deg, parameters):
    check_simulated_coin_in_the_base_frame(
        ros, start, os.path.join(PARAMETERS, parameters),
        '-p', f'simulated.tilt_deg:={tilt_deg}')


@pytest.mark.slow
def test_calibrated_on_the_simulated_camera_the_coin_arrives_within_2_mm(ros, start, tmp_path):
    file = tmp_path / 'cell.yaml'
    # The simulated camera frame's origin, seen from the first corner of the board in its middle.
    calibrate = run_calibrate(
        'board', '--camera', 'simulated', '--simulated-tilt-deg', '30', '--corners', '9x6',
        '--square-mm', '25', '--origin-mm', '-80', '-72.5', '-o', file)
    assert calibrate.returncode == 0, calibrate.stderr
    check_simulated_coin_in_the_base_frame(ros, start, str(file))


def test_calibrate_says_what_is_wrong_in_one_line_and_ends_with_1(tmp_path):
    calibrate = run_calibrate('check', tmp_path / 'missing.yaml', tmp_path / 'points.csv')
    assert calibrate.returncode == 1 and calibrate.stdout == ''
    assert re.fullmatch('calibrate: there is no file .*missing.yaml.*\n', calibrate.stderr)


@pytest.mark.slow
def test_random_pixels_reach_the_base_frame_by_the_tutorials_formula(ros, start):
    camera, base = ros.listen_with_time(CAMERA_TOPIC), ros.listen_with_time(BASE_TOPIC)
    start('robotic_arm_publishing_subscriber')
    start('camera_publisher', '-p', 'source:=random', '-p', 'period:=0.05')

    def base_positions():
        # What was sent while the nodes still discovered each other is delivered up to 4 s late.
        return [position for sent, position in base if camera and sent > camera[0][0] + 4.0]

    assert ros.spin_until(lambda: len(base_positions()) >= 20, 20.0)
    positions = base_positions()
    ros.spin_for(0.2)  # topics do not wait for each other: let the last one's origin arrive
    expected = {(round(x - 17.8, 9), round(24.4 - y, 9)) for _, (x, y) in camera}
    for x, y in positions:
        assert (round(x, 9), round(y, 9)) in expected
        u, v = (x + 17.8) / 0.05625, (24.4 - y) / 0.05625
        assert u == pytest.approx(round(u)) and 250 <= round(u) <= 450
        assert v == pytest.approx(round(v)) and 250 <= round(v) <= 450


@pytest.mark.slow
def test_video_is_published_frame_for_frame_as_by_the_tutorial_and_ends_with_0(
        ros, start, tmp_path):
    video = tmp_path / 'moving disc.avi'
    write_video(video, [None] * 3 + [(40 + 6 * k, 60 + 3 * k) for k in range(40)])
    expected = tutorial_positions(video, 36.0 / 320)
    camera, base = ros.listen(CAMERA_TOPIC), ros.listen(BASE_TOPIC)
    start('robot_base_publisher')
    assert ros.spin_until(lambda: ros.hears(BASE_TOPIC))
    node = start('camera_publisher', '-p', f'source:={video}', '-p', 'wait_for_subscribers:=2',
                 '-p', 'detector.method:=tutorial')
    assert ros.spin_until(lambda: not node.is_running, 20.0)
    assert node.wait() == 0
    assert 'has ended after 43 frames' in node.output
    assert ros.spin_until(lambda: len(base) == len(expected), 5.0)
    assert len(expected) == 40
    assert camera == [pytest.approx(position) for position in expected]
    assert base == [pytest.approx([x - 17.8, 24.4 - y]) for x, y in expected]


@pytest.mark.slow
def test_bad_messages_do_not_stop_the_transform_node(ros, start):
    node = start('robot_base_publisher')
    received, publisher = ros.listen(BASE_TOPIC), ros.talk(CAMERA_TOPIC)
    assert ros.spin_until(
        lambda: publisher.get_subscription_count() == 1 and ros.hears(BASE_TOPIC))
    ros.spin_for(0.3)
    for data in ([], [1.0], [math.nan, 0.0], [0.0, math.inf], [10.0, 10.0]):
        publisher.publish(Float64MultiArray(data=data))
    assert ros.spin_until(lambda: received)
    ros.spin_for(0.2)
    assert received == [pytest.approx([-7.8, 14.4])]
    assert node.end() == 0
    assert 'dropped a position' in node.output
    assert 'Traceback' not in node.output


@pytest.mark.slow
@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('executable, arguments', [
    ('robot_base_publisher', []),
    ('camera_publisher', ['-p', 'source:=random']),
    ('camera_publisher', ['-p', 'source:=simulated'])])
def test_signal_ends_a_node_with_0_and_no_traceback(ros, start, executable, arguments, number):
    node = start(executable, *arguments)
    assert ros.spin_until(lambda: executable in ros.node.get_node_names())
    ros.spin_for(0.3)
    assert node.end(number) == 0
    assert 'Traceback' not in node.output


@pytest.mark.slow
@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('executable', ['robot_base_publisher', 'camera_publisher'])
def test_signal_ends_a_node_that_waits_for_a_simulated_clock(ros, start, executable, number):
    node = start(executable, '-p', 'use_sim_time:=true')
    assert ros.spin_until(lambda: executable in ros.node.get_node_names())
    ros.spin_for(0.3)
    assert node.end(number) == 0


@pytest.mark.slow
def test_interrupt_ends_a_node_that_a_shell_has_started_in_its_background(ros):
    path = os.path.join(
        get_package_prefix('camera_to_base'), 'lib', 'camera_to_base', 'robot_base_publisher')
    node = subprocess.Popen(
        [path], preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN))
    assert ros.spin_until(lambda: 'robot_base_publisher' in ros.node.get_node_names())
    ros.spin_for(0.3)
    node.send_signal(signal.SIGINT)
    assert node.wait(2.0) == 0


def test_misspelt_parameter_is_named_with_what_was_meant(ros, start):
    lines = ros.listen_to_log('camera_publisher')
    start('camera_publisher', '-p', 'source:=random', '-p', 'detector.treshold:=50')
    assert ros.spin_until(lambda: any(
        "no parameter 'detector.treshold'" in line.text and "'detector.threshold'" in line.text
        for line in lines))


@pytest.mark.slow
def test_two_interrupts_in_a_row_leave_no_traceback(ros, start):
    node = start('camera_publisher', '-p', 'source:=random')
    assert ros.spin_until(lambda: 'camera_publisher' in ros.node.get_node_names())
    ros.spin_for(0.3)
    node.send_signal(signal.SIGINT)
    time.sleep(0.02)
    assert node.end(signal.SIGINT) == 0
    assert 'Traceback' not in node.output


@pytest.mark.slow
def test_picture_ends_with_the_parameter_that_shows_it_again(start, tmp_path):
    picture = tmp_path / 'table.png'
    cv2.imwrite(str(picture), np.full((480, 640, 3), 200, np.uint8))
    node = start('camera_publisher', '-p', f'source:={picture}', '-p', 'wait_for_subscribers:=0')
    assert node.wait() == 0
    assert 'has ended after 1 frame, which' in node.output and 'repeat:=true' in node.output


@pytest.mark.slow
@pytest.mark.parametrize('arguments, said', [
    (['-p', 'source:=/does/not/exist.avi'], "cannot open video '/does/not/exist.avi'"),
    (['-p', 'source:=99', '-p', 'wait_for_camera:=false'], "cannot open camera '99'"),
    (['-p', 'detector.threshold:=300'], 'detector.threshold'),
    (['-p', 'detector.threshold:=high'], 'detector.threshold'),
    (['-p', 'rotation_deg:=[1, 2.5]'], 'rotation_deg'),
    (['--params-file', '/does/not/exist.yaml'], '/does/not/exist.yaml'),
    (['--no-such-argument'], '--no-such-argument')])
def test_bad_start_is_one_clear_line_and_exit_code_1(start, arguments, said):
    node = start('camera_publisher', *arguments)
    assert node.wait() == 1
    fatal = [line for line in node.output.splitlines() if 'FATAL' in line]
    assert len(fatal) == 1 and said in fatal[0]
    assert 'Traceback' not in node.output


@pytest.mark.slow
def test_device_that_is_not_there_is_waited_for_until_a_signal(ros, start):
    lines = ros.listen_to_log('camera_publisher')
    node = start('camera_publisher', '-p', 'source:=99')
    assert ros.spin_until(lambda: any("cannot open camera '99'" in line.text for line in lines))
    ros.spin_for(2.0)
    assert node.is_running
    assert node.end() == 0
    assert node.output.count('waiting for the camera') == 1


def test_file_that_is_no_video_is_refused(start, tmp_path):
    no_video = tmp_path / 'notes.avi'
    no_video.write_text('these are notes, not pictures')
    node = start('camera_publisher', '-p', f'source:={no_video}')
    assert node.wait() == 1
    assert 'no video that OpenCV can read' in node.output


@pytest.mark.skipif(os.path.exists('/dev/video0'), reason='a camera is attached')
def test_without_a_camera_the_positions_are_said_to_be_random(ros, start):
    received = ros.listen('/cell/pos_in_cam_frame')
    node = start('camera_publisher', '-r', '__ns:=/cell', '-p', 'period:=0.1')
    assert ros.spin_until(lambda: received)
    node.end()
    assert re.search(r'WARN.*/cell/pos_in_cam_frame are RANDOM', node.output)


@pytest.mark.slow
@pytest.mark.flaky(reruns=2, only_rerun=['NotInTime'])
def test_demo_prints_each_position_saves_a_picture_and_leaves_nothing_behind(tmp_path):
    demo = subprocess.Popen(
        [sys.executable, DEMO, 'simulated'], cwd=tmp_path, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    lines = []
    while sum('error' in line for line in lines) < 10:
        line = demo.stdout.readline()
        assert line, lines
        lines.append(line)
    begin = time.monotonic()
    demo.send_signal(signal.SIGINT)
    rest, _ = demo.communicate(timeout=10.0)
    assert_in_time(time.monotonic() - begin, 2.0)
    assert demo.returncode == 0
    output = ''.join(lines) + rest
    assert 'Traceback' not in output
    errors = [float(error) for error in re.findall(r'error ([\d.]+) mm', output)]
    assert len(errors) >= 10 and max(errors) < 2.0
    assert f'annotated picture: {tmp_path}/demo.png' in output
    assert 'the dashboard is at http://localhost:' in output
    assert cv2.imread(str(tmp_path / 'demo.png')).shape == (480, 640, 3)
    assert subprocess.run(['pgrep', '-f', str(tmp_path)]).returncode == 1


@pytest.mark.slow
def test_demo_ends_with_an_error_where_its_camera_is_not_there(tmp_path):
    demo = subprocess.run(
        [sys.executable, DEMO, '99'], cwd=tmp_path, text=True, capture_output=True, timeout=30.0)
    assert demo.returncode == 1
    assert "cannot open camera '99'" in demo.stdout + demo.stderr


@pytest.mark.slow
def test_demo_ends_with_an_error_where_a_node_dies(tmp_path):
    share = tmp_path / 'share/ament_index/resource_index/packages'
    share.mkdir(parents=True)
    (share / 'camera_to_base').touch()
    (tmp_path / 'lib/camera_to_base').mkdir(parents=True)
    for name, script in (('camera_publisher', 'kill -ABRT $$'),
                         ('robot_base_publisher', 'exec sleep 60'),
                         ('dashboard', 'exec sleep 60')):
        executable = tmp_path / 'lib/camera_to_base' / name
        executable.write_text(f'#!/bin/sh\n{script}\n')
        executable.chmod(0o755)
    demo = subprocess.run(
        [sys.executable, DEMO], cwd=tmp_path, text=True, capture_output=True, timeout=60.0,
        env={**os.environ,
             'AMENT_PREFIX_PATH': f'{tmp_path}:{os.environ["AMENT_PREFIX_PATH"]}'})
    assert demo.returncode == 128 + signal.SIGABRT
    assert 'error: camera_publisher has died: Aborted (signal 6)' in demo.stderr
