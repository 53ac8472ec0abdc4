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
import time

from ament_index_python.packages import get_package_share_directory
from builtin_interfaces.msg import Time
from camera_to_base.coordinate_transform import Pose
from camera_to_base.errors import InvalidValueError
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.outputs import image_message, jpeg_message
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
from camera_to_base.ros.messages import poses_from_message, poses_message
import cv2
from geometry_msgs.msg import Point, PointStamped, PoseArray
import numpy as np
import pytest
from rclpy.qos import qos_profile_sensor_data
from ros_helpers import assert_in_time, CAMERA_TOPIC, stamp_now
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Header

CAMERA_OBJECTS, BASE_OBJECTS = '/objects_in_cam_frame', '/objects_in_robot_base_frame'
CAMERA_POINT, BASE_POINT = '/pos_in_cam_frame/point', '/pos_in_robot_base_frame/point'
TILTED = os.path.join(
    get_package_share_directory('camera_to_base'), 'config', 'simulated_tilted_camera.yaml')
STAMP = Time(sec=12, nanosec=345678901)


def seconds(stamp):
    return stamp.sec + stamp.nanosec / 1e9


def connect(ros, *arguments):
    """Start the transform node; give it, two publishers and what comes out of it."""
    node = ros.add(RobotBasePublisher, *arguments)
    points, objects = ros.listen_to(PointStamped, BASE_POINT), ros.listen_to(
        PoseArray, BASE_OBJECTS)
    talkers = (ros.node.create_publisher(PointStamped, CAMERA_POINT, 10),
               ros.node.create_publisher(PoseArray, CAMERA_OBJECTS, 10))
    assert ros.spin_until(lambda: all(t.get_subscription_count() for t in talkers)
                          and ros.hears(BASE_POINT) and ros.hears(BASE_OBJECTS))
    ros.spin_for(0.2)
    return node, *talkers, points, objects


def test_point_is_that_of_the_tutorials_topic_in_metres(ros):
    positions = ros.listen(CAMERA_TOPIC)
    points = ros.listen_to(PointStamped, CAMERA_POINT)
    ros.add(CameraPublisher, '-p', 'source:=random', '-p', 'period:=0.05')
    assert ros.spin_until(lambda: len(points) >= 5 and len(positions) >= 5)
    assert {point.header.frame_id for point in points} == {'camera_surface'}
    in_cm = [[100 * point.point.x, 100 * point.point.y] for point in points]
    assert any(position == pytest.approx(in_cm[-1]) for position in positions)
    assert all(point.point.z == 0.0 for point in points)


def test_stamp_is_the_time_at_which_the_frame_was_taken(ros):
    points = ros.listen_to(PointStamped, CAMERA_POINT)
    ros.add(CameraPublisher, '-p', 'source:=simulated')
    assert ros.spin_until(lambda: len(points) >= 3)
    points.clear()
    assert ros.spin_until(lambda: points)
    age = time.time() - seconds(points[0].header.stamp)
    assert age >= 0
    assert_in_time(age, 0.5)


def test_stamp_passes_through_the_transform_unchanged(ros):
    _, point_talker, object_talker, points, objects = connect(ros)
    header = Header(stamp=STAMP, frame_id='camera_surface')
    point_talker.publish(PointStamped(header=header, point=Point(x=0.195, y=0.1375)))
    object_talker.publish(poses_message(header, [Pose(19.5, 13.75, 0.0, 0.5)]))
    assert ros.spin_until(lambda: points and objects)
    assert points[0].header == objects[0].header == Header(stamp=STAMP, frame_id='base_link')
    point = points[0].point
    assert (point.x, point.y, point.z) == pytest.approx((0.017, 0.1065, 0.0))
    assert poses_from_message(objects[0]) == [pytest.approx((1.7, 10.65, 0.0, -0.5))]


def test_names_of_the_frames_are_parameters(ros):
    objects = ros.listen_to(PoseArray, BASE_OBJECTS)
    seen = ros.listen_to(PoseArray, CAMERA_OBJECTS)
    ros.add(RobotBasePublisher, '-p', 'base_frame_id:=cell_2/base_link',
            '-p', 'camera_frame_id:=table')
    ros.add(CameraPublisher, '-p', 'source:=simulated', '-p', 'camera_frame_id:=table')
    assert ros.spin_until(lambda: objects and seen)
    assert objects[0].header.frame_id == 'cell_2/base_link'
    assert seen[0].header.frame_id == 'table'


@pytest.mark.slow
def test_messages_in_another_frame_are_dropped_and_counted(ros):
    node, point_talker, object_talker, points, objects = connect(ros)
    statuses = ros.listen_to_diagnostics('/robot_base_publisher')
    for name in ('base_link', 'camera_surface', ''):
        header = Header(stamp=STAMP, frame_id=name)
        point_talker.publish(PointStamped(header=header, point=Point(x=len(name) / 100)))
        object_talker.publish(poses_message(header, [Pose(len(name), 0.0, 0.0, 0.0)]))
    assert ros.spin_until(lambda: len(points) == len(objects) == 2)
    assert [point.point.x for point in points] == pytest.approx([-0.038, -0.178])
    assert node.dropped_count == 2
    assert ros.spin_until(lambda: statuses and statuses[-1].values.get(
        'dropped: in another frame') == '2')


@pytest.mark.parametrize('section', ['/**', 'camera_publisher'])
def test_camera_frame_that_a_file_names_is_the_one_that_is_converted(ros, tmp_path, section):
    path = tmp_path / 'cell.yaml'
    path.write_text(f'{section}: {{ros__parameters: {{camera_frame_id: table}}}}')
    node, point_talker, _, points, _ = connect(ros, '--params-file', str(path))
    point_talker.publish(PointStamped(header=Header(frame_id='table')))
    assert ros.spin_until(lambda: points)
    assert node.dropped_count == 0
    assert node.get_parameter('camera_frame_id').value == 'table'


@pytest.mark.parametrize('name', ['/base_link', "''"])
def test_name_of_a_frame_that_tf2_would_refuse_is_refused(ros, name):
    with pytest.raises(InvalidValueError, match='base_frame_id must be'):
        ros.add(RobotBasePublisher, '-p', f'base_frame_id:={name}')


def test_empty_surface_is_an_empty_array_on_both_topics(ros):
    _, _, object_talker, points, objects = connect(ros)
    object_talker.publish(PoseArray(header=Header(stamp=STAMP)))
    assert ros.spin_until(lambda: objects)
    assert list(objects[0].poses) == [] and objects[0].header.stamp == STAMP
    assert points == []


def test_array_keeps_its_order_and_leaves_out_what_is_beyond_the_reach(ros):
    node, _, object_talker, _, objects = connect(
        ros, '-p', 'reach_cm:=50', '-p', 'displacement_cm:=[0, 0, 0]')
    object_talker.publish(poses_message(Header(stamp=STAMP), [
        Pose(30.0, 0.0, 0.0, 0.0), Pose(50.1, 0.0, 0.0, 0.0), Pose(10.0, 0.0, 0.0, 0.0)]))
    assert ros.spin_until(lambda: objects)
    assert [pose.x for pose in poses_from_message(objects[0])] == pytest.approx([30.0, 10.0])
    assert node.dropped_count == 1


def test_array_of_objects_that_are_all_beyond_the_reach_is_not_told_as_an_empty_surface(ros):
    node, _, object_talker, _, objects = connect(
        ros, '-p', 'reach_cm:=50', '-p', 'displacement_cm:=[0, 0, 0]')
    object_talker.publish(poses_message(Header(), [Pose(50.1, 0.0, 0.0, 0.0)]))
    object_talker.publish(poses_message(Header(), [Pose(10.0, 0.0, 0.0, 0.0)]))
    assert ros.spin_until(lambda: objects)
    assert node.dropped_count == 1
    assert [len(array.poses) for array in objects] == [1]


def test_stamped_message_that_is_no_position_is_dropped_and_the_node_lives(ros):
    node, point_talker, object_talker, points, objects = connect(ros)
    bad = poses_message(Header(), [Pose(1.0, 1.0, 0.0, 0.0)])
    bad.poses[0].position.x = math.nan
    object_talker.publish(bad)
    point_talker.publish(PointStamped(point=Point(x=math.inf)))
    assert ros.spin_until(lambda: node.dropped_count == 2)
    object_talker.publish(PoseArray())
    assert ros.spin_until(lambda: objects)
    assert points == [] and len(objects) == 1


def drive(ros, topic, make_message, *arguments, noise=3, speed=1,
          heard=(CAMERA_POINT, CAMERA_OBJECTS)):
    """Send pictures of a coin as a camera driver does; give what a node says of them."""
    points, objects = (ros.listen_to(message_type, name)
                       for message_type, name in zip((PointStamped, PoseArray), heard))
    node = ros.add(CameraPublisher, *arguments)
    message = make_message(Header(), table())
    driver = ros.node.create_publisher(type(message), topic, qos_profile_sensor_data)
    clock = ros.node.create_publisher(Clock, '/clock', 10)
    assert ros.spin_until(driver.get_subscription_count)
    for number in range(1, 200):
        picture = cv2.add(
            table() if number <= 10 else table(320 + speed * number),
            np.random.default_rng(number).integers(0, noise, (480, 640, 3), np.uint8))
        stamp = numbered_stamp(number)
        clock.publish(Clock(clock=stamp))  # of a simulation; others do not listen
        driver.publish(make_message(Header(stamp=stamp), picture))
        ros.spin_for(0.03)
        if points:
            break
    return node, points, objects


def numbered_stamp(number):
    """Make a stamp of now whose last three digits are a picture's number."""
    stamp = stamp_now()
    return Time(sec=stamp.sec, nanosec=stamp.nanosec // 1000 * 1000 + number)


def number_of(stamp):
    return stamp.nanosec % 1000


def table(coin_u=None):
    frame = np.full((480, 640, 3), 200, np.uint8)
    return frame if coin_u is None else cv2.circle(frame, (coin_u, 240), 21, (50, 50, 50), -1)


def coin_at(stamp):
    """Give where the coin lies on the picture with that stamp: x and y, in m."""
    return 0.0005625 * (320 + number_of(stamp)), 0.135


every_kind_of_picture = pytest.mark.parametrize('source, topic, make_message', [
    ('topic', '/image', image_message),
    ('compressed_topic', '/image/compressed', jpeg_message)])


@every_kind_of_picture
def test_pictures_of_a_camera_driver_become_points_with_the_drivers_stamp(
        ros, source, topic, make_message):
    _, points, objects = drive(ros, topic, make_message, '-p', f'source:={source}')
    assert points, 'no point was published'
    point, stamp = points[0].point, points[0].header.stamp
    assert number_of(stamp) in range(11, 200)
    assert (point.x, point.y) == pytest.approx(coin_at(stamp), abs=0.0002)
    assert number_of(objects[-1].header.stamp) <= number_of(stamp) + 1


@every_kind_of_picture
def test_stamp_of_a_camera_driver_comes_out_of_the_transform_in_the_base_frame(
        ros, source, topic, make_message):
    ros.add(RobotBasePublisher)
    _, points, objects = drive(ros, topic, make_message, '-p', f'source:={source}',
                               heard=(BASE_POINT, BASE_OBJECTS))
    assert points, 'no point was published'
    assert ros.spin_until(lambda: any(message.poses for message in objects))
    assert {message.header.frame_id for message in points + objects} == {'base_link'}
    stamped = [(message.header.stamp, message.point) for message in points] + [
        (message.header.stamp, pose.position) for message in objects for pose in message.poses]
    for stamp, point in stamped:
        x, y = coin_at(stamp)
        assert (point.x, point.y) == pytest.approx((x - 0.178, 0.244 - y), abs=0.0002)


def test_topic_of_the_pictures_can_be_remapped(ros):
    _, points, _ = drive(ros, '/usb_cam/image_raw', image_message, '-p', 'source:=topic',
                         '-r', 'image:=/usb_cam/image_raw')
    assert points


@pytest.mark.slow
@pytest.mark.parametrize('is_simulation', [True, False])
def test_pictures_without_any_noise_are_taken_for_repeated_but_in_a_simulation(
        ros, is_simulation):
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    _, points, _ = drive(ros, '/image', image_message, '-p', 'source:=topic',
                         '-p', f'use_sim_time:={is_simulation}', noise=1, speed=0)
    assert bool(points) == is_simulation
    told = [status for status in statuses if 'use_sim_time' in status.message]
    assert bool(told) != is_simulation


@pytest.mark.slow
def test_camera_driver_that_is_not_there_is_said_in_the_diagnostics(ros):
    statuses = ros.listen_to_diagnostics('/camera_publisher')
    ros.add(CameraPublisher, '-p', 'source:=topic')
    assert ros.spin_until(lambda: any(
        'is the camera driver running?' in status.message for status in statuses))
    assert statuses[-1].values['source'] == '/image'


@pytest.mark.slow
@pytest.mark.parametrize('yaw_deg', [15.0, -60.0, 85.0])
@pytest.mark.parametrize('arguments', [
    (), ('-p', 'simulated.tilt_deg:=30.0', '--params-file', TILTED)])
def test_objects_are_within_1_mm_and_1_degree_of_the_simulated_boards_truth_in_both_frames(
        ros, arguments, yaw_deg):
    seen, based, true = (ros.listen_to(PoseArray, topic) for topic in (
        CAMERA_OBJECTS, BASE_OBJECTS, '/true_objects_in_cam_frame'))
    ros.add(RobotBasePublisher)
    ros.add(CameraPublisher, '-p', 'source:=simulated', '-p', 'simulated.frame_rate:=20.0',
            '-p', 'simulated.diameters_cm:=[3.4, 3.0, 2.6]', '-p', 'simulated.elongation:=1.5',
            '-p', f'simulated.yaw_deg:={yaw_deg}', *arguments)
    assert ros.spin_until(lambda: min(len(pairs(seen, true)), len(pairs(based, true))) >= 20)
    for published, truth in pairs(seen, true):
        check_objects(published, truth)
    for published, truth in pairs(based, true):
        check_objects(published, [Pose(x - 17.8, 24.4 - y, z, -yaw) for x, y, z, yaw in truth])


def check_objects(published, truth):
    assert len(published) == len(truth) == 3
    for pose in published:
        nearest = min(truth, key=lambda other: math.dist(pose[:2], other[:2]))
        assert math.dist(pose[:2], nearest[:2]) < 0.1
        assert abs(math.remainder(pose.yaw - nearest.yaw, math.pi)) < math.radians(1)


def pairs(seen, true):
    """Give what was published of a frame beside the truth, where there are objects on it."""
    truths = {seconds(message.header.stamp): poses_from_message(message) for message in true}
    return [(poses_from_message(message), truths[seconds(message.header.stamp)])
            for message in seen if truths.get(seconds(message.header.stamp))]


def test_all_objects_come_with_the_largest_first(ros):
    seen = ros.listen_to(PoseArray, CAMERA_OBJECTS)
    points = ros.listen_to(PointStamped, CAMERA_POINT)
    ros.add(CameraPublisher, '-p', 'source:=simulated',
            '-p', 'simulated.diameters_cm:=[2.0, 3.4, 2.6]')
    assert ros.spin_until(lambda: any(message.poses for message in seen) and points)
    first = next(message for message in seen if message.header.stamp == points[0].header.stamp)
    assert first.poses[0].position == points[0].point
    third = 0.36 / 3  # each object keeps to a third of the board, the largest to the middle one
    assert [int(pose.position.x / third) for pose in first.poses] == [1, 2, 0]
    assert all(pose.orientation.w == 1.0 for pose in first.poses)


def test_surface_without_an_object_is_an_empty_array(ros):
    _, points, objects = drive(ros, '/image', image_message, '-p', 'source:=topic')
    assert points
    assert list(objects[0].poses) == []  # of the background, or of the frame after it
