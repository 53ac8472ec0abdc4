# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""`calibrate base --live` with a running camera node, and a robot that publishes its pose."""

from array import array
import re
import threading
import time

from camera_to_base.commands.calibrate.command import main
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.parameters.file import read_parameter_file
from camera_to_base.simulation.board import SimulatedTouchTable
from geometry_msgs.msg import PoseStamped
import numpy as np
import pytest
from rclpy.qos import qos_profile_sensor_data
from ros_helpers import stamp_now
from sensor_msgs.msg import Image

PLACES = {'top left': (0.15, 0.15), 'top right': (0.85, 0.15), 'bottom right': (0.85, 0.85),
          'bottom left': (0.15, 0.85), 'middle': (0.5, 0.5)}


class Cell:
    """A table, a camera driver, a camera node and a robot, alive in a thread."""

    def __init__(self, ros):
        self._ros, self.table = ros, SimulatedTouchTable((640, 480))
        self._random, self.tool, self._ends = np.random.default_rng(1), (0.0, 0.0), False
        self._images = ros.node.create_publisher(Image, 'image', qos_profile_sensor_data)
        self._poses = ros.node.create_publisher(PoseStamped, 'tool', 10)
        self._thread = threading.Thread(target=self._live, daemon=True)

    def start(self, *arguments):
        self._ros.add(CameraPublisher, *arguments, '-p', 'source:=topic')
        self._thread.start()

    def end(self):
        self._ends = True
        if self._thread.is_alive():
            self._thread.join()

    def _live(self):
        while not self._ends:
            frame = self.table.read() + self._random.normal(0, 1.5, (480, 640, 3))
            frame = np.clip(frame, 0, 255).astype(np.uint8)
            message = Image(encoding='bgr8', height=480, width=640, step=1920,
                            data=array('B', frame.tobytes()))
            message.header.stamp = stamp_now()
            self._images.publish(message)
            pose = PoseStamped()
            pose.header.frame_id = 'base_link'
            pose.pose.position.x, pose.pose.position.y = (value / 100 for value in self.tool)
            self._poses.publish(pose)
            until = time.monotonic() + 0.08
            while time.monotonic() < until:
                self._ros.executor.spin_once(timeout_sec=0.01)


class Person:
    """Puts the coin where it is asked for, and touches it with the robot."""

    def __init__(self, capsys, cell, hull):
        self._capsys, self._cell, self.said = capsys, cell, ''
        self._low, self._high = hull.min(axis=0), hull.max(axis=0)

    def readline(self):
        said = self._capsys.readouterr().err
        self.said += said
        place = re.search(r'Put one object near the (.+) of the calibrated', said)
        if place:
            along = np.array(PLACES[place[1]])
            self._cell.table.lay_coin(tuple(self._low + along * (self._high - self._low)))
        elif 'Touch' in said:
            assert 'Put one object near' in self.said, self.said  # else the node was not found
            self._cell.tool = self._cell.table.robot_position()
        else:
            return 'q\n'
        return '\n'


@pytest.fixture
def cell(ros, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(['board', '--camera', 'simulated', '-o', 'cell.yaml']) == 0
    made = Cell(ros)
    yield made
    made.end()


def live(cell, capsys, monkeypatch, *more):
    hull = np.reshape(read_parameter_file('cell.yaml').values['surface.hull'], (-1, 2))
    person = Person(capsys, cell, hull)
    monkeypatch.setattr('sys.stdin', person)
    code = main(['base', '--live', 'cell.yaml', *more])
    output, error = capsys.readouterr()
    return code, output, person.said + error


@pytest.mark.slow
def test_positions_of_the_running_node_and_the_robots_topic_make_the_base_frame(
        cell, capsys, monkeypatch):
    cell.start('--params-file', 'cell.yaml')
    code, output, said = live(cell, capsys, monkeypatch, '--robot-topic', '/tool')
    assert code == 0, said
    assert 'Positions come from the running node, topic /objects_in_cam_frame' in said
    assert re.search(r'error at 5 points: rms 0\.\d', output)
    values = read_parameter_file('cell.yaml').values
    np.testing.assert_allclose(values['displacement_cm'], [-17.8 + 8, 24.4 - 7.25, 0], atol=0.1)


@pytest.mark.slow
def test_a_running_node_with_another_surface_is_refused(cell, capsys, monkeypatch):
    cell.start()
    code, output, said = live(cell, capsys, monkeypatch, '--robot-topic', '/tool')
    assert (code, output) == (1, '')
    assert "the running camera_publisher has another surface than 'cell.yaml'" in said


@pytest.mark.slow
def test_a_robot_that_is_silent_is_named(cell, capsys, monkeypatch):
    cell.start('--params-file', 'cell.yaml')
    code, output, said = live(cell, capsys, monkeypatch, '--robot-topic', '/nobody')
    assert code == 1 and '0 poses came on the topic /nobody within 5 s' in said
