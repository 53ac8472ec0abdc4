# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The command `locate`, on recordings that the tests make themselves."""

import csv
import fcntl
from functools import partial
import os
from pathlib import Path
import pty
import re
import signal
import struct
import subprocess
import sys
import termios

from camera_to_base.commands import locate as locate
from camera_to_base.errors import FrameSourceError
from camera_to_base.sources import DEVICE
import cv2
import numpy as np
import pytest
from recordings import disc_frame, SIZE, write_video
from test_layers import IMPORT_WITHOUT_ROS

# One frame without the disc, then it moves.
PATH = [(60 + 8 * k, 60 + 5 * k) for k in range(20)]
CM_PER_PX = 36.0 / SIZE[0]
COMMAND = [sys.executable, '-m', 'camera_to_base.commands.locate']


@pytest.fixture(autouse=True)
def with_a_recording(in_a_folder_of_its_own, monkeypatch):
    monkeypatch.setenv('PYTHONPATH', os.pathsep.join(filter(None, sys.path)))
    write_video('disc.avi', [None, *PATH])


@pytest.fixture
def run(run_main):
    """Run the command; give exit code, standard output and standard error."""
    return partial(run_main, locate.main)


def parameters(text, name='cell.yaml'):
    Path(name).write_text(f'/**:\n  ros__parameters: {{{text}}}\n')
    return name


def rows(name='out.csv'):
    with open(name, newline='') as file:
        return [{key: float(value) if value else None for key, value in row.items()}
                for row in csv.DictReader(file)]


class FakeCamera:
    """Gives the disc's frames; then somebody presses Ctrl-C, or the camera is unplugged."""

    kind = DEVICE

    def __init__(self, interrupts=True):
        self._frames = [disc_frame(None), *map(disc_frame, PATH)]
        self._interrupts = interrupts
        self._random = np.random.default_rng(1)
        self.released = False

    def read(self):
        frame = self._frames.pop(0) if self._frames else disc_frame(None)
        if not self._frames and not self._interrupts:
            raise FrameSourceError("camera '0' gives no frame")
        if not self._frames:
            os.kill(os.getpid(), signal.SIGINT)
        # A camera's picture has noise: one without it counts as damaged.
        noise = self._random.normal(0, 1.5, frame.shape)
        return (frame + noise).round().clip(0, 255).astype(np.uint8)

    def release(self):
        self.released = True


def test_every_object_is_in_the_table_and_in_the_csv_with_time_pixel_and_both_frames(run):
    code, output, error = run('disc.avi', '--csv', 'out.csv')
    assert code == 0 and error.startswith(
        '21 frames: 20 with an object (20 with one, 0 with more)\nfile: out.csv\nnext: ')
    header, *lines = output.splitlines()
    names, found = header.split(), rows()
    assert len(found) == len(lines) == len(PATH) and {len(line) for line in lines} == {len(header)}
    for number, (row, line, (u, v)) in enumerate(zip(found, lines, PATH), start=1):
        assert row['frame'] == number and row['object'] == 1
        assert row['time_s'] == pytest.approx(number / 30, abs=1e-9)
        assert (row['u_px'], row['v_px']) == pytest.approx((u, v), abs=0.3)
        x, y = row['x_cam_cm'], row['y_cam_cm']
        assert (x, y) == pytest.approx((u * CM_PER_PX, v * CM_PER_PX), abs=0.04)
        assert (row['x_base_cm'], row['y_base_cm'], row['z_base_cm']) == pytest.approx(
            (x - 17.8, 24.4 - y, 0.0), abs=2e-4)
        for name, text in zip(names, line.split()):
            assert text == '-' if row[name] is None else float(text) == pytest.approx(
                row[name], abs=0.06)


@pytest.mark.slow
@pytest.mark.parametrize('method', ['tutorial', 'precise'])
def test_positions_are_those_that_the_nodes_publish(run, ros, start, method):
    from ros_helpers import BASE_TOPIC, CAMERA_TOPIC
    file = parameters(
        f'detector: {{method: {method}}}, rotation_deg: [180, 0, 30], reach_cm: 23.5')
    code, _, error = run('disc.avi', '--params-file', file, '--csv', 'out.csv')
    assert code == 0 and 'objects beyond reach_cm' in error
    largest = [row for row in rows() if row['object'] == 1]
    camera, base = ros.listen(CAMERA_TOPIC), ros.listen(BASE_TOPIC)
    start('robot_base_publisher', '--params-file', file)
    assert ros.spin_until(lambda: ros.hears(BASE_TOPIC))
    node = start('camera_publisher', '--params-file', file, '-p', 'source:=disc.avi',
                 '-p', 'wait_for_subscribers:=2')
    assert ros.spin_until(lambda: not node.is_running, 20.0)
    expected = [(row['x_base_cm'], row['y_base_cm']) for row in largest
                if row['x_base_cm'] is not None]
    assert ros.spin_until(lambda: len(base) == len(expected), 5.0)
    assert 0 < len(expected) < len(largest) == 20
    np.testing.assert_allclose(
        camera, [(row['x_cam_cm'], row['y_cam_cm']) for row in largest], atol=1e-4)
    np.testing.assert_allclose(base, expected, atol=1e-4)


def test_it_works_where_there_is_no_ros():
    child = subprocess.run(
        [sys.executable, '-c', f'{IMPORT_WITHOUT_ROS}\n'
         'from camera_to_base.commands.locate import main\n'
         "sys.exit(main(['disc.avi']))", 'camera_to_base.commands.locate'],
        capture_output=True, text=True, timeout=60)
    assert child.returncode == 0 and len(child.stdout.splitlines()) == 1 + len(PATH)
    assert 'with an object' in child.stderr


def test_every_nth_frame_is_used_from_the_first_on(run):
    assert run('disc.avi', '--every', '5', '--csv', 'out.csv')[0] == 0
    assert [row['frame'] for row in rows()] == [5, 10, 15, 20]


def test_annotated_video_shows_each_used_frame_with_its_objects(run):
    assert run('disc.avi', '--annotated', 'seen.mp4', '--every', '2')[0] == 0
    capture, pictures = cv2.VideoCapture('seen.mp4'), []
    assert capture.get(cv2.CAP_PROP_FPS) == pytest.approx(15.0)
    while True:
        good, picture = capture.read()
        if not good:
            break
        pictures.append(picture.astype(int))
    assert len(pictures) == 11
    for picture, (u, v) in zip(pictures[1:], PATH[1::2]):
        around = picture[v - 30:v + 31, u - 30:u + 31]
        assert (around[..., 1] - around[..., 2]).max() > 60  # the green box
    # The note in the corner is all that is drawn on the background.
    assert np.ptp(pictures[0][40:]) < 30 < np.ptp(pictures[0][:40])


@pytest.mark.slow
def test_simulated_source_is_a_minute_of_the_board(run):
    file = parameters('simulated: {frame_rate: 0.5}')
    code, output, error = run('simulated', '--params-file', file)
    assert code == 0 and '30 frames: 2' in error


def test_first_frames_are_the_background_as_in_the_node(run):
    write_video('disc.avi', [None, (60, 60), None, *PATH])
    code, _, error = run('disc.avi', '--csv', 'out.csv', '--params-file',
                         parameters('background_frames: 3'))
    assert code == 0 and 'frames held back: 2 (background_missing,' in error
    assert [row['frame'] for row in rows()] == list(range(3, 23))


def test_what_is_wrong_in_the_parameter_file_is_said(run):
    code, output, error = run('disc.avi', '--params-file', parameters(
        'detector.treshold: 50, framerate: 3, use_sim_time: true'))
    assert code == 0 and len(output.splitlines()) == 21
    for unknown, meant in [('detector.treshold', 'detector.threshold'),
                           ('framerate', 'simulated.frame_rate')]:
        assert f"no parameter '{unknown}', it is left out: did you mean '{meant}'?" in error
    assert 'use_sim_time' not in error
    code, output, error = run('disc.avi', '--params-file', parameters('detector.threshold: 300'))
    assert (code, output) == (1, '')
    assert error == 'locate: parameter detector.threshold must be 0 to 255 grey levels, got 300\n'


def test_recording_of_another_size_than_the_calibration_is_refused_in_one_sentence(run):
    code, _, error = run('disc.avi', '--params-file', parameters('surface.model: homography'))
    assert code == 1
    assert re.fullmatch(r'locate: no frame could be used: .*320.*640.*\n', error)


@pytest.mark.parametrize('arguments, said', [
    (['missing.avi'], "cannot open video 'missing.avi'"),
    (['disc.avi', '--every', '0'], '--every must be 1 or more, got 0'),
    (['disc.avi', '--csv', 'disc.avi'], 'different files'),
    (['disc.avi', '--csv', 'no/where.csv'], "cannot write 'no/where.csv'"),
    (['disc.avi', '--annotated', 'seen.avi'], "must end in .mp4, got 'seen.avi'"),
    (['disc.avi', '--annotated', 'no/seen.mp4'], "there is no folder 'no'"),
    (['disc.avi', '--topic', '/image'], '--topic is for a bag'),
    (['disc.avi', '--params-file', 'missing.yaml'], "'missing.yaml'"),
    (['disc.avi', '--no-such-option'], '--no-such-option')])
def test_what_cannot_be_done_is_one_sentence_and_exit_code_1(run, arguments, said):
    code, output, error = run(*arguments)
    assert (code, output) == (1, '')
    assert re.fullmatch(r'locate: .*\n', error) and said in error
    assert sorted(os.listdir()) == ['disc.avi']


def test_full_disk_is_one_sentence(run):
    code, _, error = run('disc.avi', '--csv', '/dev/full', '--force')
    assert code == 1 and re.fullmatch(r'locate: cannot write any further: .*No space.*\n', error)


def test_full_disk_for_the_output_is_one_sentence(run):
    with open('/dev/full', 'w') as full:
        child = subprocess.run([*COMMAND, 'disc.avi'], stdout=full, stderr=subprocess.PIPE,
                               text=True, timeout=60)
    assert child.returncode == 1
    assert child.stderr == 'locate: cannot write any further: No space left on device\n'


def test_files_are_overwritten_only_if_asked_for(run):
    Path('out.csv').write_text('precious')
    code, _, error = run('disc.avi', '--csv', 'out.csv')
    assert code == 1 and "'out.csv' exists already" in error
    assert Path('out.csv').read_text() == 'precious'
    assert run('disc.avi', '--csv', 'out.csv', '--force')[0] == 0
    assert len(rows()) == 20


def test_ctrl_c_ends_a_camera_with_0_and_all_that_was_found(run, monkeypatch):
    camera, before = FakeCamera(), signal.getsignal(signal.SIGINT)
    monkeypatch.setattr(locate, 'open_frame_source', lambda *_: camera)
    code, output, error = run('0', '--csv', 'out.csv', '--annotated', 'seen.mp4')
    assert code == 0 and camera.released
    # As the node publishes it: what a second frame has not confirmed is held back.
    assert [row['frame'] for row in rows()] == list(range(3, 20))
    assert 'frames held back: 1 (background_missing,' in error
    assert 'frames held back: 2 (unconfirmed,' in error
    assert len(output.splitlines()) == 1 + len(rows())
    assert cv2.VideoCapture('seen.mp4').get(cv2.CAP_PROP_FRAME_COUNT) >= 20
    assert 'with an object' in error
    assert signal.getsignal(signal.SIGINT) is before


def test_ctrl_c_between_two_used_frames_counts_at_once(run, monkeypatch):
    # The camera sends a Ctrl-C with each further frame, and a second one would end it with 130.
    monkeypatch.setattr(locate, 'open_frame_source', lambda *_: FakeCamera())
    assert run('0', '--every', '1000')[0] == 0


def test_camera_that_is_unplugged_ends_it_with_1_and_all_that_was_found(run, monkeypatch):
    monkeypatch.setattr(locate, 'open_frame_source', lambda *_: FakeCamera(interrupts=False))
    code, _, error = run('0', '--csv', 'out.csv')
    assert code == 1 and error == "locate: camera '0' gives no frame\n"
    assert len(rows()) >= 17


def test_ctrl_c_ends_a_recording_with_130_and_whole_lines():
    child = subprocess.Popen([*COMMAND, 'simulated', '--csv', 'out.csv'], text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    for _ in range(5):
        assert child.stdout.readline()
    child.send_signal(signal.SIGINT)
    _, error = child.communicate(timeout=20.0)
    assert child.returncode == 130 and 'Traceback' not in error and 'with an object' in error
    assert 4 <= len(rows()) < 599


def test_reader_that_has_seen_enough_ends_it_quietly():
    child = subprocess.run(f'{" ".join(COMMAND)} simulated | head -n 2', shell=True, text=True,
                           capture_output=True, timeout=60)
    assert len(child.stdout.splitlines()) == 2 and child.stderr == ''


def test_help_says_that_an_arm_needs_the_nodes(run):
    code, output, error = run('--help')
    assert (code, error) == (0, '') and 'Do not control an arm with this command' in output


def test_progress_is_shown_on_a_terminal_only():
    leader, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack('4H', 30, 100, 0, 0))
    # The terminal takes 4 kB before somebody reads: five frames stay below.
    child = subprocess.Popen([*COMMAND, 'disc.avi', '--every', '5'], stdout=subprocess.PIPE,
                             stderr=terminal)
    os.close(terminal)
    table, _ = child.communicate(timeout=60)
    shown = os.read(leader, 10000).decode(errors='replace')
    os.close(leader)
    assert '0/5 [' in shown and len(table.splitlines()) == 5
