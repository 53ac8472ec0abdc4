# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""The node `camera_fusion`: heights of what two cameras see, and a reason for each silence."""

import math
import os
import signal

from ament_index_python.packages import get_package_share_directory
from builtin_interfaces.msg import Time
from camera_to_base.nodes.camera_fusion import CameraFusion
from camera_to_base.ros import boxes_of_markers
from fake_camera import BOX, DISC, FakeCamera, OBJECTS, show_until
from geometry_msgs.msg import PoseArray, PoseWithCovarianceStamped
import numpy as np
import pytest
from ros_helpers import Process
from two_cameras import base_of, PAIRS
from visualization_msgs.msg import MarkerArray

CONFIG = os.path.join(get_package_share_directory('camera_to_base'), 'config')


@pytest.fixture
def cell(ros):
    left, right = (FakeCamera(ros, name, place) for name, place in zip(
        ('left', 'right'), PAIRS['tilted 30 degrees, opposite sides']))
    ros.add(CameraFusion)
    assert ros.spin_until(lambda: left.is_heard and right.is_heard)
    # What is sent once arrives once the two have found each other.
    ros.spin_for(0.5)
    return ros, left, right


def test_objects_are_published_with_the_height_that_nobody_told(cell):
    ros, left, right = cell
    poses = ros.listen_to(PoseArray, OBJECTS)
    boxes = ros.listen_to(MarkerArray, f'{OBJECTS}/boxes')
    uncertain = ros.listen_to(PoseWithCovarianceStamped, '/pos_in_robot_base_frame/pose')
    show_until(ros, lambda: poses and boxes and uncertain, (left, (DISC, BOX)),
               (right, (BOX, DISC)))
    first, second = poses[-1].poses
    assert (first.position.x, first.position.y) == pytest.approx((0.06, 0.02), abs=5e-4)
    assert first.position.z == pytest.approx(0.03, abs=1e-3)  # The top of what is 2 cm high.
    assert second.position.z == pytest.approx(0.06, abs=1e-3)
    box, disc = boxes_of_markers(boxes[-1])
    assert box.pose == pytest.approx((6.0, 2.0, 2.0, 0.3), abs=0.1)
    assert box[1:] == pytest.approx((4.0, 3.0, 2.0), abs=0.12)
    assert disc[1:] == pytest.approx((3.0, 3.0, 5.0), abs=0.15)
    assert poses[-1].header.frame_id == 'base_link'
    covariance = np.reshape(uncertain[-1].pose.covariance, (6, 6))
    assert 1e-9 < covariance[2, 2] < 1e-6 and 1e-9 < covariance[0, 0] < 1e-6


def test_camera_that_falls_silent_is_named_and_known_heights_stay(cell):
    ros, left, right = cell
    poses = ros.listen_to(PoseArray, OBJECTS)
    status = ros.listen_to_diagnostics('/camera_fusion')
    show_until(ros, lambda: len(poses) > 2, (left, (BOX,)), (right, (BOX,)))
    show_until(ros, lambda: status and status[-1].values['reason'] == 'ok',
               (left, (BOX,)), (right, (BOX,)))
    del poses[:]
    show_until(ros, lambda: poses and status[-1].values['reason'] == 'camera_silent',
               (left, (BOX,)))
    assert 'right publishes no positions' in status[-1].message
    assert poses[-1].poses[0].position.z == pytest.approx(0.03, abs=1e-3)


def check_unmoved(poses):
    """Check that each object is where BOX or DISC is."""
    for message in poses:
        for pose in message.poses:
            x, y, z = 100 * pose.position.x, 100 * pose.position.y, 100 * pose.position.z
            there = (6.0, 2.0, 3.0) if x > 0 else (-7.0, -1.0, 6.0)
            assert (x, y, z) == pytest.approx(there, abs=0.15)


def test_camera_that_was_bumped_by_5_mm_is_named_and_moves_nothing(cell):
    ros, left, right = cell
    poses = ros.listen_to(PoseArray, OBJECTS)
    status = ros.listen_to_diagnostics('/camera_fusion')
    show_until(ros, lambda: poses and len(poses[-1].poses) == 2 and status
               and status[-1].values['reason'] == 'ok', (left, (BOX, DISC)), (right, (BOX, DISC)))
    right.moved = (0.3, -0.4)
    show_until(ros, lambda: status[-1].values['reason'] == 'cameras_disagree',
               (left, (BOX, DISC)), (right, (BOX, DISC)))
    assert status[-1].message.startswith('right sees objects elsewhere')
    assert len(poses[-1].poses) == 2
    check_unmoved(poses)


def test_arm_over_half_of_one_picture_moves_nothing(cell):
    ros, left, right = cell
    arm = base_of('box', 30.0, 14.0, (9.0, 5.0), 0.5), 0.0
    poses = ros.listen_to(PoseArray, OBJECTS)
    status = ros.listen_to_diagnostics('/camera_fusion')
    show_until(ros, lambda: status and poses and len(poses[-1].poses) == 2,
               (left, (BOX, DISC)), (right, (BOX, DISC)))
    # Both objects rest: the one below the arm is known from the other camera.
    show_until(ros, lambda: status[-1].values['reason'] == 'cameras_disagree',
               (left, (BOX, DISC)), (right, (arm, DISC)))
    assert 'right' in status[-1].message and len(poses[-1].poses) == 2
    check_unmoved(poses)
    show_until(ros, lambda: status[-1].values['reason'] == 'ok',
               (left, (BOX, DISC)), (right, (BOX, DISC)))


HIDDEN = base_of('box', 3.0, 2.0, (6.0, 6.5), 0.0), 1.5


@pytest.mark.parametrize('known', [True, False])
def test_objects_that_one_camera_sees_as_one_are_published_where_they_rest_or_not_at_all(
        cell, known):
    ros, left, right = cell
    poses = ros.listen_to(PoseArray, OBJECTS)
    status = ros.listen_to_diagnostics('/camera_fusion')
    if known:
        show_until(ros, lambda: status and poses and len(poses[-1].poses) == 3,
                   (left, (BOX, DISC, HIDDEN)), (right, (BOX, DISC, HIDDEN)))
    # The box hides what lies behind it.
    as_one = np.vstack([BOX[0], HIDDEN[0]]), 1.8
    show_until(ros, lambda: poses and status and status[-1].values['reason'] == 'cameras_disagree',
               (left, (BOX, DISC, HIDDEN)), (right, (as_one, DISC)))
    assert len(poses[-1].poses) == (3 if known else 1)
    for message in poses:
        for pose in message.poses:
            x, y = 100 * pose.position.x, 100 * pose.position.y
            assert min(math.dist((x, y), base.mean(axis=0)) for base, _ in (
                BOX, DISC, HIDDEN)) < 0.15


def test_nothing_is_published_until_it_is_known_what_is_there(cell):
    ros, left, right = cell
    poses = ros.listen_to(PoseArray, OBJECTS)
    status = ros.listen_to_diagnostics('/camera_fusion')
    # One camera alone, for longer than a camera may be silent: it sees an object, or nothing.
    for seen, reason in (((BOX,), 'camera_silent'), ((), 'camera_silent')):
        del status[:]
        show_until(ros, lambda: len(status) > 1 and status[-1].values['frames fused'] != '0',
                   (left, seen))
        assert status[-1].values['reason'] == reason and poses == []
    # Both, but nothing that fits together.
    show_until(ros, lambda: status[-1].values['reason'] == 'cameras_disagree', (left, (BOX,)),
               (right, ((BOX[0] + [1.5, 0.5], 2.0),)))
    assert poses == []
    show_until(ros, lambda: poses, (left, ()), (right, ()))
    assert poses[0].poses == []


def test_cameras_with_different_base_frames_are_refused(ros):
    places = PAIRS['tilted 30 degrees, opposite sides']
    cameras = [FakeCamera(ros, name, place, frame_id) for name, place, frame_id in zip(
        ('left', 'right'), places, ('base_link', 'other_base'))]
    ros.add(CameraFusion)
    poses, status = ros.listen_to(PoseArray, OBJECTS), ros.listen_to_diagnostics('/camera_fusion')
    assert ros.spin_until(lambda: all(camera.is_heard for camera in cameras))
    show_until(ros, lambda: status and status[-1].values['reason'] == 'other_frame',
               *[(camera, (BOX,)) for camera in cameras])
    del poses[:]
    show_until(ros, lambda: True, *[(camera, (BOX,)) for camera in cameras])
    assert poses == []


def test_a_message_without_sense_is_dropped_and_the_next_is_not(cell):
    ros, left, right = cell
    poses = ros.listen_to(PoseArray, OBJECTS)
    status = ros.listen_to_diagnostics('/camera_fusion')
    nonsense = ros.node.create_publisher(MarkerArray, f'/left{OBJECTS}/silhouettes', 10)
    assert ros.spin_until(nonsense.get_subscription_count)
    nonsense.publish(MarkerArray())
    assert ros.spin_until(lambda: status and status[-1].values['messages dropped'] == '1')
    show_until(ros, lambda: poses and poses[-1].poses, (left, (BOX,)), (right, (BOX,)))


def test_stamps_of_the_later_picture_are_kept(cell):
    ros, left, right = cell
    poses = ros.listen_to(PoseArray, OBJECTS)

    def step():
        left.show(Time(sec=100, nanosec=0), BOX)
        right.show(Time(sec=100, nanosec=5_000_000), BOX)
        ros.spin_for(0.05)
        return poses and poses[-1].poses
    assert ros.spin_until(step)
    assert poses[-1].header.stamp == Time(sec=100, nanosec=5_000_000)


@pytest.mark.slow
def test_two_simulated_cameras_and_one_of_them_is_killed_and_started_again(ros):
    boxes = ros.listen_to(MarkerArray, f'{OBJECTS}/boxes')
    truth = ros.listen_to(MarkerArray, '/right/true_objects_in_cam_frame/boxes')
    status = ros.listen_to_diagnostics('/camera_fusion')
    processes = []
    try:
        for name in ('left', 'right'):
            for executable in ('camera_publisher', 'robot_base_publisher'):
                processes.append(simulated_camera(name, executable))
        processes.append(Process('camera_fusion', '-p', 'cameras:=[left, right]'))
        assert ros.spin_until(
            lambda: status and truth and boxes and len(boxes_of_markers(boxes[-1])) == 5)
        check_boxes(boxes[-1], truth[-1])
        processes[0].send_signal(signal.SIGKILL)
        assert ros.spin_until(lambda: status[-1].values['reason'] == 'camera_silent')
        del boxes[:]
        assert ros.spin_until(lambda: len(boxes) > 5)
        processes.append(simulated_camera('left', 'camera_publisher'))
        assert ros.spin_until(lambda: status[-1].values['reason'] == 'ok')
        assert ros.spin_until(lambda: len(boxes_of_markers(boxes[-1])) == 5)
        for message in boxes:
            check_boxes(message, truth[-1])
    finally:
        for process in processes:
            process.kill()


def simulated_camera(name, executable):
    return Process(executable, '-r', f'__ns:=/{name}', '--params-file',
                   os.path.join(CONFIG, f'simulated_{name}.yaml'))


def check_boxes(message, truth):
    """Compare boxes in the base frame with the true ones in the simulated camera frame."""
    true = [(one.pose.x - 17.8, 24.4 - one.pose.y, *one[1:]) for one in boxes_of_markers(truth)]
    for found in boxes_of_markers(message):
        nearest = min(true, key=lambda one: math.dist(one[:2], found.pose[:2]))
        assert math.dist(nearest[:2], found.pose[:2]) < 0.1
        assert found.height == pytest.approx(nearest[4], abs=0.2)
