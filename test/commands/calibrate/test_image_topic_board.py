# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""`calibrate board --image-topic`: a driver's pictures, and the lens of its camera_info."""

from array import array
import json
import threading
import time

from camera_to_base.commands.calibrate.command import main
from camera_to_base.parameters import read_parameter_file
from camera_to_base.simulation import SimulatedChessboard
import pytest
from rclpy.qos import qos_profile_sensor_data
from ros_helpers import stamp_now
from sensor_msgs.msg import CameraInfo, Image

FOCAL_PX = 60 / 36 * 640
MATRIX = [FOCAL_PX, 0.0, 320.0, 0.0, FOCAL_PX, 240.0, 0.0, 0.0, 1.0]


class Driver:
    """Publishes pictures of a board on the simulated table, from a thread."""

    def __init__(self, ros, topic, info):
        self._ros, self._info, self.board = ros, info, SimulatedChessboard(9, 6, 2.5)
        self._laid, self._ends = 0, threading.Event()
        self._images = ros.node.create_publisher(Image, topic, qos_profile_sensor_data)
        self._infos = ros.node.create_publisher(
            CameraInfo, '/camera/camera_info', qos_profile_sensor_data)
        self._thread = threading.Thread(target=self._live, daemon=True)
        self._thread.start()

    def readline(self):
        """Lay the board elsewhere, and press Enter."""
        self._laid += 1
        self.board.lay(*self.board.free_place(self._laid))
        time.sleep(0.3)
        return '\n'

    def end(self):
        self._ends.set()
        self._thread.join()

    def _live(self):
        while not self._ends.wait(0.02):
            frame = self.board.read()
            message = Image(encoding='bgr8', height=480, width=640, step=1920,
                            data=array('B', frame.tobytes()))
            message.header.stamp = stamp_now()
            self._images.publish(message)
            if self._info is not None:
                self._info.header.stamp = message.header.stamp
                self._infos.publish(self._info)


@pytest.fixture
def drive(ros, monkeypatch):
    """Start a driver whose board is laid by what reads the terminal."""
    drivers = []

    def start(info, topic='/camera/image_raw'):
        drivers.append(Driver(ros, topic, info))
        monkeypatch.setattr('sys.stdin', drivers[-1])
    yield start
    for driver in drivers:
        driver.end()


def info_of(k=MATRIX, d=(0.0, 0.0, 0.0, 0.0, 0.0), p=None, **fields):
    return CameraInfo(width=640, height=480, distortion_model='plumb_bob', d=list(d), k=list(k),
                      p=list(p or 12 * [0.0]), **fields)


def calibrated(capsys, topic='/camera/image_raw', *more):
    code = main(['board', '--image-topic', topic, *more, '-o', 'cell.yaml', '--json'])
    output, error = capsys.readouterr()
    return code, json.loads(output) if code == 0 else None, error


@pytest.mark.slow
def test_lens_of_the_driver_makes_flat_placements_enough(drive, capsys):
    drive(info_of())
    code, report, error = calibrated(capsys)
    assert code == 0, error
    assert 'The lens is that of /camera/camera_info: flat placements are enough' in error
    assert report['lens']['is_known'] and report['warnings'] == []
    assert report['camera']['height_cm'] == pytest.approx(60.0, rel=0.005)
    assert report['camera']['foot_cm'] == pytest.approx([10.0, 6.25], abs=0.2)
    values = read_parameter_file('cell.yaml').values
    assert values['surface.pinhole.camera_matrix'] == MATRIX and 'source' not in values


@pytest.mark.slow
def test_rectified_pictures_have_the_rectified_lens(drive, capsys):
    # K and D are those of the pictures before.
    rectified = [*MATRIX[:3], 0.0, *MATRIX[3:6], 0.0, *MATRIX[6:], 0.0]
    drive(info_of([900.0, 0.0, 300.0, 0.0, 900.0, 250.0, 0.0, 0.0, 1.0],
                  (-0.3, 0.1, 0.0, 0.0, 0.0), rectified), '/camera/image_rect_color')
    code, report, error = calibrated(capsys, '/camera/image_rect_color', '--placements', '2')
    assert code == 0 and 'of rectified pictures' in error
    assert report['lens']['focal_px'] == pytest.approx([FOCAL_PX, FOCAL_PX])
    assert report['lens']['coefficients'] == [] and report['warnings'] == []


@pytest.mark.slow
def test_lens_that_contradicts_the_board_is_named_with_numbers(drive, capsys):
    drive(info_of([1.2 * FOCAL_PX, *MATRIX[1:4], 1.2 * FOCAL_PX, *MATRIX[5:]],
                  (-0.3, 0.1, 0.0, 0.0, 0.0)))
    code, report, error = calibrated(capsys)
    assert code == 0
    named = [text for text in report['warnings'] if 'intrinsics contradict the board' in text]
    assert named and '% of the focal length' in named[0]


@pytest.mark.slow
def test_part_of_the_sensor_is_refused(drive, capsys):
    drive(info_of(binning_x=2, binning_y=2))
    code, _, error = calibrated(capsys)
    assert code == 1 and 'binning' in error


@pytest.mark.slow
def test_driver_that_is_not_there_is_named_with_the_topics_that_are(drive, capsys, monkeypatch):
    monkeypatch.setattr('camera_to_base.ros.driver._LONGEST_WAIT_S', 4.0)
    drive(None)
    code, _, error = calibrated(capsys, '/camera/image_row')
    assert code == 1 and 'nobody publishes /camera/image_row' in error
    assert '/camera/image_raw' in error


def test_name_that_is_no_topic_is_named(capsys):
    code, _, error = calibrated(capsys, '/camera/image raw')
    assert code == 1 and "'/camera/image raw' is no topic" in error
