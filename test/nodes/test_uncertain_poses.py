# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Poses with a covariance, and ellipses, in both frames."""

import math
import os

from ament_index_python.packages import get_package_share_directory
from builtin_interfaces.msg import Time
from camera_to_base.coordinate_transform import Pose
from camera_to_base.errors import InvalidValueError
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
from camera_to_base.ros import boxes_of_markers
from camera_to_base.ros.messages import (
    ellipse_markers, poses_of_markers, uncertain_pose_from_message, uncertain_pose_message,
    UncertainPose)
from geometry_msgs.msg import PointStamped, PoseWithCovarianceStamped
import numpy as np
import pytest
from rclpy.parameter import Parameter
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

CAMERA_POSE, BASE_POSE = '/pos_in_cam_frame/pose', '/pos_in_robot_base_frame/pose'
CAMERA_ELLIPSES = '/objects_in_cam_frame/ellipses'
BASE_ELLIPSES = '/objects_in_robot_base_frame/ellipses'
SOLIDS = os.path.join(
    get_package_share_directory('camera_to_base'), 'config', 'simulated_solid_objects.yaml')
STAMP = Time(sec=12, nanosec=345678901)
UNKNOWN_ANGLE = math.pi ** 2 / 3
LIMITS_M2 = 1e-12, 1e3


def matrix(message):
    return np.reshape(message.pose.covariance, (6, 6))


def assert_honest(message):
    """Check that no number is a placeholder, and that it is a covariance."""
    covariance = matrix(message)
    variances = covariance.diagonal()
    assert np.isfinite(covariance).all()
    assert (variances[:3] > LIMITS_M2[0]).all() and (variances[:3] < LIMITS_M2[1]).all()
    assert (variances[3:] > 0).all() and (variances[3:] <= 2 * UNKNOWN_ANGLE).all()
    assert covariance == pytest.approx(covariance.T)
    assert np.linalg.eigvalsh(covariance)[0] > 0


def test_a_pose_of_the_largest_object_comes_in_both_frames(ros):
    poses, base_poses = (ros.listen_to(PoseWithCovarianceStamped, topic)
                         for topic in (CAMERA_POSE, BASE_POSE))
    points = ros.listen_to(PointStamped, '/pos_in_cam_frame/point')
    ros.add(RobotBasePublisher)
    ros.add(CameraPublisher, '-p', 'source:=simulated')
    assert ros.spin_until(lambda: len(base_poses) > 3 and len(points) > 3)
    for message in [*poses, *base_poses]:
        assert_honest(message)
    assert poses[0].header.frame_id == 'camera_surface'
    assert base_poses[0].header.frame_id == 'base_link'
    by_stamp = {(point.header.stamp.sec, point.header.stamp.nanosec): point for point in points}
    pairs = [(pose, by_stamp[pose.header.stamp.sec, pose.header.stamp.nanosec]) for pose in poses
             if (pose.header.stamp.sec, pose.header.stamp.nanosec) in by_stamp]
    assert pairs and all(
        (pose.pose.pose.position.x, pose.pose.pose.position.y) == (point.point.x, point.point.y)
        for pose, point in pairs)
    # The simulated coin is round, and the base transform adds to what the camera knows.
    assert matrix(poses[0])[5, 5] == pytest.approx(UNKNOWN_ANGLE)
    assert matrix(base_poses[-1])[0, 0] > matrix(poses[-1])[0, 0]


def test_covariance_turns_with_the_frame(ros):
    received = ros.listen_to(PoseWithCovarianceStamped, BASE_POSE)
    talker = ros.node.create_publisher(PoseWithCovarianceStamped, CAMERA_POSE, 10)
    sure = [1e-12 if row == column else 0.0 for row in range(6) for column in range(row, 6)]
    ros.add(RobotBasePublisher, '-p', 'rotation_deg:=[0.0, 0.0, 90.0]',
            '-p', 'displacement_cm:=[0.0, 0.0, 0.0]', '-p', f'base_covariance:={sure}')
    covariance = np.diag([4.0, 1.0, 0.01, UNKNOWN_ANGLE, UNKNOWN_ANGLE, 0.01])
    covariance[0, 1] = covariance[1, 0] = 0.5
    message = uncertain_pose_message(
        Header(stamp=STAMP, frame_id='camera_surface'),
        UncertainPose(Pose(3.0, 4.0, 0.0, 0.0), covariance))
    assert ros.spin_until(lambda: talker.get_subscription_count() and ros.hears(BASE_POSE))
    assert ros.spin_until(lambda: (talker.publish(message), received)[1])
    turned = matrix(received[0])
    assert received[0].header.stamp == STAMP
    assert turned[0, 0] == pytest.approx(1e-4) and turned[1, 1] == pytest.approx(4e-4)
    assert turned[0, 1] == pytest.approx(-0.5e-4)
    assert turned[5, 5] == pytest.approx(0.01)


def test_a_rotation_that_is_not_known_well_counts_more_far_away(ros):
    received = ros.listen_to(PoseWithCovarianceStamped, BASE_POSE)
    talker = ros.node.create_publisher(PoseWithCovarianceStamped, CAMERA_POSE, 10)
    numbers = np.zeros((6, 6))
    numbers[5, 5] = 0.01 ** 2
    triangle = numbers[np.triu_indices(6)].tolist()
    ros.add(RobotBasePublisher, '-p', 'rotation_deg:=[0.0, 0.0, 0.0]',
            '-p', 'displacement_cm:=[0.0, 0.0, 0.0]', '-p', f'base_covariance:={triangle}')
    message = uncertain_pose_message(
        Header(frame_id='camera_surface'),
        UncertainPose(Pose(30.0, 0.0, 0.0, 0.0), 1e-6 * np.eye(6)))
    assert ros.spin_until(lambda: talker.get_subscription_count() and ros.hears(BASE_POSE))
    assert ros.spin_until(lambda: (talker.publish(message), received)[1])
    # 30 cm from the origin, 0.01 rad are 3 mm, across the line to it.
    assert math.sqrt(matrix(received[0])[1, 1]) == pytest.approx(0.003, rel=1e-3)
    assert math.sqrt(matrix(received[0])[0, 0]) < 1e-4


@pytest.mark.parametrize('place, value', [(0, -1.0), (0, math.nan), (7, math.inf), (35, 1e308)])
def test_a_covariance_that_is_none_is_dropped(ros, place, value):
    node = ros.add(RobotBasePublisher)
    received = ros.listen_to(PoseWithCovarianceStamped, BASE_POSE)
    talker = ros.node.create_publisher(PoseWithCovarianceStamped, CAMERA_POSE, 10)
    message = uncertain_pose_message(Header(), UncertainPose(Pose(1, 2, 0, 0), np.eye(6)))
    message.pose.covariance[place] = value
    assert ros.spin_until(lambda: talker.get_subscription_count() and ros.hears(BASE_POSE))
    assert ros.spin_until(lambda: (talker.publish(message), node.dropped_count or received)[1])
    if value != 1e308:
        assert not received
    assert all(np.isfinite(matrix(one)).all() for one in received)


@pytest.mark.slow
def test_every_object_has_an_ellipse_in_both_frames(ros):
    markers, base_markers = (ros.listen_to(MarkerArray, topic)
                             for topic in (CAMERA_ELLIPSES, BASE_ELLIPSES))
    ros.add(RobotBasePublisher)
    ros.add(CameraPublisher, '-p', 'source:=simulated',
            '-p', 'simulated.diameters_cm:=[2.4, 1.8]')
    assert ros.spin_until(lambda: any(len(one.markers) == 3 for one in base_markers))
    for message, frame in ((markers[-1], 'camera_surface'), (base_markers[-1], 'base_link')):
        first, *others = message.markers
        assert first.action == Marker.DELETEALL
        assert len({marker.id for marker in others}) == len(others)
        for marker in others:
            assert marker.header.frame_id == frame and marker.type == Marker.CYLINDER
            assert 0 < marker.scale.y <= marker.scale.x < 1 and marker.color.a > 0


@pytest.mark.slow
def test_ellipses_stop_where_nobody_looks(ros):
    node = ros.add(RobotBasePublisher)
    talker = ros.node.create_publisher(MarkerArray, CAMERA_ELLIPSES, 10)
    ros.spin_for(1.5)
    assert talker.get_subscription_count() == 0
    ros.listen_to(MarkerArray, BASE_ELLIPSES)
    assert ros.spin_until(lambda: talker.get_subscription_count() == 1)
    assert node.dropped_count == 0


def test_ellipse_comes_back_as_the_covariance_that_it_was_made_of():
    covariance = np.diag([0.5, 0.2, 1.0, 1.0, 1.0, 1.0])
    covariance[0, 1] = covariance[1, 0] = -0.2
    pose = UncertainPose(Pose(1.0, 2.0, 0.0, 0.3), covariance)
    back, = poses_of_markers(ellipse_markers(Header(), [pose]))
    assert back.pose[:3] == pytest.approx((1, 2, 0))
    assert back.covariance[:2, :2] == pytest.approx(covariance[:2, :2])


def test_message_comes_back_as_it_was():
    covariance = np.diag([0.5, 0.2, 1.0, 1.0, 1.0, 1.0])
    pose = UncertainPose(Pose(1.0, 2.0, 0.5, 0.3), covariance)
    back = uncertain_pose_from_message(uncertain_pose_message(Header(), pose))
    assert back.pose == pytest.approx(pose.pose)
    assert back.covariance == pytest.approx(covariance)


def test_pose_that_is_not_flat_is_refused():
    message = uncertain_pose_message(Header(), UncertainPose(Pose(1, 2, 0, 0), np.eye(6)))
    message.pose.pose.orientation.x = 0.5
    with pytest.raises(InvalidValueError, match='yaw about z'):
        uncertain_pose_from_message(message)


def test_solid_objects_without_a_height_are_in_doubt_until_it_is_told(ros):
    ellipses = ros.listen_to(MarkerArray, CAMERA_ELLIPSES)
    truth = ros.listen_to(MarkerArray, '/true_objects_in_cam_frame/boxes')
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    log = ros.listen_to_log('camera_publisher')
    node = ros.add(CameraPublisher, '--params-file', SOLIDS, '-p', 'source:=simulated',
                   '-p', 'object_height_cm:=0.0')
    assert ros.spin_until(lambda: statuses and statuses[-1].values['reason'] == 'looks_solid')
    assert ros.spin_until(lambda: any('5 of 5 objects look solid' in line.text for line in log))
    discs = [one for one in ellipses[-1].markers if one.action == Marker.ADD]
    places = [box.pose[:2] for box in boxes_of_markers(truth[-1])]
    assert len(discs) == len(places) == 5
    for one in discs:
        seen = 100 * one.pose.position.x, 100 * one.pose.position.y
        off = min(math.dist(seen, place) for place in places)
        assert 0.4 < off < 100 * min(one.scale.x, one.scale.y) / 2 < 3 * off
    # Where heights are measured by two cameras, nobody tells them.
    ros.listen_to(MarkerArray, '/objects_in_robot_base_frame/silhouettes')
    assert ros.spin_until(lambda: statuses[-1].values['reason'] != 'looks_solid')
    ros.stop_listening('/objects_in_robot_base_frame/silhouettes')
    assert ros.spin_until(lambda: statuses[-1].values['reason'] == 'looks_solid')
    assert node.set_parameters([Parameter('object_height_cm', value=3.0)])[0].successful
    assert ros.spin_until(lambda: statuses[-1].values['reason'] != 'looks_solid')
    assert sum('look solid' in line.text for line in log) == 1
