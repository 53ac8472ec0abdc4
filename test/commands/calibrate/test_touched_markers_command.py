# Copyright 2026 The camera_to_base authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.
"""`calibrate markers --base`: from four touched markers to positions in the base frame."""

import io
import json
import math

from camera_to_base.commands.calibrate.command import main
from camera_to_base.coordinate_transform import (
    CameraToRobotBaseConversion, TUTORIAL_DISPLACEMENT_CM, TUTORIAL_ROTATION_DEG)
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
from camera_to_base.parameters import read_parameter_file
from camera_to_base.simulation import SimulatedBoard
import cv2
from geometry_msgs.msg import PoseArray, PoseStamped
import numpy as np
import pytest
from rclpy.parameter import Parameter
from rendered_markers import Camera, marker_corners, Table

TRUE = CameraToRobotBaseConversion.from_roll_pitch_yaw(
    TUTORIAL_ROTATION_DEG, TUTORIAL_DISPLACEMENT_CM)
COMMAND = ('markers', '--camera', 'simulated', '--marker-mm', '40', '--base', '-o', 'cell.yaml')


def touches():
    """Return what the robot's display shows at each marker, as a person types it."""
    corners = SimulatedBoard(image_size=(640, 480)).true_markers
    return ['{:.2f} {:.2f}'.format(*TRUE.convert_point(*corners[number].mean(axis=0))[:2])
            for number in range(4)]


def typed(monkeypatch, *lines):
    monkeypatch.setattr('sys.stdin', io.StringIO('\n'.join(lines) + '\n'))


def base_of(values):
    return CameraToRobotBaseConversion.from_roll_pitch_yaw(
        values['rotation_deg'], values['displacement_cm'])


def test_one_command_writes_surface_markers_and_base(run_main, monkeypatch):
    typed(monkeypatch, *touches())
    code, output, error = run_main(main, *COMMAND)
    assert code == 0, error
    assert 'lens: not measured; the shape of the markers alone' in output
    values = read_parameter_file('cell.yaml').values
    corners = SimulatedBoard(image_size=(640, 480)).true_markers
    learned = np.reshape(values['markers.corners_cm'], (4, 4, 2))
    for number, middle in enumerate(learned.mean(axis=1)):
        true = TRUE.convert_point(*corners[number].mean(axis=0))
        assert base_of(values).convert_point(*middle) == pytest.approx(true, abs=0.03)
    _, output, _ = run_main(main, 'status', 'cell.yaml')
    assert 'without a board (lens not measured)' in output
    assert 'next: calibrate check cell.yaml' in output


def test_wrong_touch_is_named_and_touched_again(run_main, monkeypatch):
    right = touches()
    typed(monkeypatch, right[0], right[2], right[1], right[3], '1', right[1], '2', right[2])
    code, output, error = run_main(main, *COMMAND, '--json')
    assert code == 0, error
    assert 'the touches of markers 1 and 2 are swapped' in error
    assert json.loads(output)['max_mm'] < 0.3


def test_pictures_and_a_robot_in_any_place(run_main, monkeypatch):
    camera = Camera(tilt_deg=25.0, lens=(-0.15, 0.04))
    cv2.imwrite('table.png', camera.frame(Table(), np.random.default_rng(0)))
    middles = [corners.mean(axis=0) for corners in marker_corners().values()]
    typed(monkeypatch, *(f'{300 + 10 * y:.1f} {-10 * x:.1f} mm' for x, y in middles))
    code, _, error = run_main(main, 'markers', 'table.png', '--marker-mm', '40', '--base',
                              '-o', 'cell.yaml')
    assert code == 1 and 'mirrored' in error
    typed(monkeypatch, *(f'{30 + y:.2f} {x:.2f}' for x, y in middles))
    code, _, error = run_main(main, 'markers', 'table.png', '--marker-mm', '40', '--base',
                              '-o', 'cell.yaml')
    assert code == 0, error
    assert read_parameter_file('cell.yaml').values['surface.image_size'] == [1280, 720]


@pytest.mark.parametrize('arguments, told', [
    (('markers', '--camera', 'simulated', '--base', '-o', 'new.yaml'), 'needs --marker-mm'),
    (('markers', '--camera', 'simulated', '--base', '--marker-mm', '-3', '-o', 'new.yaml'),
     '--marker-mm'),
    (('markers', 'grey.png', '--base', '--marker-mm', '40', '-o', 'new.yaml'),
     '0 of the markers 0 to 9 are seen'),
    (('markers', '--camera', 'simulated', '--base', '--marker-mm', '40', '-o', 'old.yaml'),
     'exists already with the surface'),
    (('markers', '--camera', 'simulated', '--robot-topic', '/tool', '-o', 'old.yaml'),
     'is for calibrate markers --base')])
def test_wrong_input_is_one_sentence(run_main, arguments, told):
    assert run_main(main, 'board', '--camera', 'simulated', '-o', 'old.yaml')[0] == 0
    cv2.imwrite('grey.png', np.full((480, 640, 3), 120, np.uint8))
    code, _, error = run_main(main, *arguments)
    assert code == 1
    assert told in error and error.count('\n') == 1


def test_wrong_size_is_told_and_no_file_is_written(run_main, monkeypatch, tmp_path):
    typed(monkeypatch, *touches(), 'q')
    code, _, error = run_main(main, 'markers', '--camera', 'simulated', '--marker-mm', '35',
                              '--base', '-o', 'cell.yaml')
    assert code == 1
    assert 'edges are 40' in error and 'not 35 mm' in error
    assert not (tmp_path / 'cell.yaml').exists()


class Person:
    """Lets the simulated robot touch the next marker whenever a touch is asked for."""

    def __init__(self, ros, camera, tool):
        self._ros, self._camera, self._tool, self._marker = ros, camera, tool, -1

    def readline(self):
        self._marker += 1
        self._camera.set_parameters(
            [Parameter('simulated.touched_marker', value=self._marker)])
        count = len(self._tool)
        assert self._ros.spin_until(lambda: len(self._tool) > count + 2)
        pose = self._tool[-1].pose.position
        return f'{100 * pose.x:.3f} {100 * pose.y:.3f}\n'


@pytest.mark.slow
def test_nodes_with_the_file_publish_true_positions(ros, run_main, monkeypatch):
    tool = ros.listen_to(PoseStamped, '/before/simulated_tool')
    camera = ros.add(CameraPublisher, '-r', '__ns:=/before', '-p', 'source:=simulated',
                     '-p', 'simulated.markers:=true', '-p', 'simulated.frame_rate:=30.0')
    monkeypatch.setattr('sys.stdin', Person(ros, camera, tool))
    code, _, error = run_main(main, *COMMAND)
    assert code == 0, error
    found = ros.listen_to(PoseArray, '/objects_in_robot_base_frame')
    true = ros.listen_to(PoseArray, '/true_objects_in_cam_frame')
    log = ros.listen_to_log('camera_publisher')
    ros.add(CameraPublisher, '--params-file', 'cell.yaml', '-p', 'simulated.shows:=still_objects')
    ros.add(RobotBasePublisher, '--params-file', 'cell.yaml')
    assert ros.spin_until(lambda: found and len(found[-1].poses) == 5 and true)
    # True positions are in the camera frame of the calibration that the simulation starts with.
    there = [TRUE.convert_point(100 * pose.position.x, 100 * pose.position.y)
             for pose in true[-1].poses]
    for pose in found[-1].poses:
        here = 100 * pose.position.x, 100 * pose.position.y
        assert min(math.dist(here, point[:2]) for point in there) < 0.12
    assert ros.spin_until(lambda: any('lens not measured' in str(line) for line in log))
