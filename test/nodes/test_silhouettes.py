# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Silhouettes and the camera's place, in both frames: what several cameras are fused from."""

import math
import os

from ament_index_python.packages import get_package_share_directory
from builtin_interfaces.msg import Time
from camera_to_base.coordinate_transform import CameraPlace, Pose
from camera_to_base.errors import InvalidValueError
from camera_to_base.fusion import KnownHeight, SeenOutline, solve, Viewpoint
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
from camera_to_base.ros import (
    boxes_of_markers, camera_pose, latched, markers_of_bytes, silhouette_markers,
    silhouettes_of_markers, SilhouetteTopics, SurfaceSilhouette, UncertainPose)
from geometry_msgs.msg import PoseWithCovarianceStamped
import numpy as np
import pytest
from rclpy.serialization import serialize_message
from std_msgs.msg import Header
from visualization_msgs.msg import MarkerArray, UVCoordinate

IN_CAMERA, IN_BASE = '/objects_in_cam_frame', '/objects_in_robot_base_frame'
SQUARE = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 3.0, 0.0], [0.0, 3.0, 0.0]])
COVARIANCE = np.diag([0.04, 0.01, 0.0, 0.0, 0.0, 0.0])
ONE = SurfaceSilhouette(SQUARE, UncertainPose(Pose(1.0, 1.5, 0.0, 0.0), COVARIANCE))
SOLIDS = os.path.join(
    get_package_share_directory('camera_to_base'), 'config', 'simulated_solid_objects.yaml')


def test_silhouette_comes_back_as_it_was_sent():
    sent = [ONE, ONE._replace(corners=SQUARE + [5.0, 0.0, 0.1], pixel_cm=0.12)]
    for one, back in zip(sent, silhouettes_of_markers(silhouette_markers(Header(), sent))):
        np.testing.assert_allclose(back.corners, one.corners)
        np.testing.assert_allclose(back.place.covariance, COVARIANCE, atol=1e-6)
        assert back.place.pose == pytest.approx(one.place.pose)
        assert back.pixel_cm == pytest.approx(one.pixel_cm)
    assert silhouettes_of_markers(silhouette_markers(Header(), [])) == []


def test_bytes_are_read_as_the_message_is_and_other_bytes_are_refused():
    header = Header(frame_id='base_link', stamp=Time(sec=7, nanosec=9))
    for sent in ([], [ONE], [ONE, ONE._replace(corners=SQUARE + [5.0, 0.0, 0.1])]):
        message = silhouette_markers(header, sent)
        if sent:  # What silhouettes do not have is passed over.
            message.markers[0].text, message.markers[0].mesh_file.data = 'Grüße', [1, 2, 3]
            message.markers[-1].texture.data = [4, 5]
            message.markers[-1].uv_coordinates = [UVCoordinate(u=0.5, v=0.5)]
        raw = serialize_message(message)
        read = markers_of_bytes(raw)
        assert not isinstance(read, MarkerArray)
        assert read.markers[0].header.frame_id == 'base_link'
        assert read.markers[0].header.stamp.sec == 7 and read.markers[0].header.stamp.nanosec == 9
        wanted = silhouettes_of_markers(message)
        assert len(silhouettes_of_markers(read)) == len(wanted) == len(sent)
        for one, other in zip(silhouettes_of_markers(read), wanted):
            np.testing.assert_array_equal(one.corners, other.corners)
            np.testing.assert_array_equal(one.place.covariance, other.place.covariance)
            assert one.place.pose == other.place.pose and one.pixel_cm == other.pixel_cm


def test_bytes_of_another_shape_are_read_as_a_message_or_refused():
    raw = serialize_message(silhouette_markers(Header(), [ONE]))
    assert isinstance(markers_of_bytes(raw + bytes(40)), MarkerArray)
    with pytest.raises(InvalidValueError, match='expected a MarkerArray, got 100 other bytes'):
        markers_of_bytes(raw[:100])


def test_outline_without_an_ellipse_or_with_a_corner_nowhere_is_refused():
    message = silhouette_markers(Header(), [ONE])
    with pytest.raises(InvalidValueError, match='an ellipse for each outline'):
        silhouettes_of_markers(MarkerArray(markers=[message.markers[0], message.markers[2]]))
    message.markers[2].points[1].x = math.nan
    with pytest.raises(InvalidValueError, match='finite corners'):
        silhouettes_of_markers(message)
    message.markers[2].points = []
    with pytest.raises(InvalidValueError, match='corners of an outline, got 0'):
        silhouettes_of_markers(message)


def test_silhouettes_and_the_camera_are_passed_on_in_the_base_frame(ros):
    talker = SilhouetteTopics(ros.node, IN_CAMERA[1:], 'camera_in_cam_frame')
    header = Header(frame_id='camera_surface')
    talker.publish_camera(header, camera_pose(1.0, 2.0, -60.0, np.diag([1.0, 2.0, 3.0])))
    ros.add(RobotBasePublisher, '-p', 'rotation_deg:=[180.0, 0.0, 0.0]',
            '-p', 'displacement_cm:=[10.0, 20.0, 0.0]', '-p', 'reach_cm:=30.0',
            '-p', f'base_covariance:={[0.0] * 21}')
    received, places = ros.listen_to(MarkerArray, f'{IN_BASE}/silhouettes'), []
    # It comes late, and is told all the same.
    assert ros.spin_until(lambda: talker.is_wanted)
    ros.node.create_subscription(
        PoseWithCovarianceStamped, '/camera_in_robot_base_frame', places.append, latched())
    far = ONE._replace(place=ONE.place._replace(pose=Pose(90.0, 0.0, 0.0, 0.0)))
    assert ros.spin_until(lambda: (talker.publish(header, [far, ONE]), received and places)[1])
    found, = silhouettes_of_markers(received[0])
    assert received[0].markers[0].header.frame_id == 'base_link'
    np.testing.assert_allclose(found.corners, SQUARE * [1, -1, -1] + [10.0, 20.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(found.place.covariance[:2, :2], COVARIANCE[:2, :2], atol=1e-6)
    position = places[0].pose.pose.position
    assert (position.x, position.y, position.z) == pytest.approx((0.11, 0.18, 0.6))


def test_silhouettes_of_the_simulated_camera_stand_on_their_footprints(ros):
    silhouettes = ros.listen_to(MarkerArray, f'{IN_CAMERA}/silhouettes')
    truth = ros.listen_to(MarkerArray, '/true_objects_in_cam_frame/boxes')
    places = []
    ros.node.create_subscription(
        PoseWithCovarianceStamped, '/camera_in_cam_frame', places.append, latched())
    ros.add(CameraPublisher, '--params-file', SOLIDS, '-p', 'source:=simulated')
    assert ros.spin_until(lambda: places and truth and silhouettes and len(
        silhouettes_of_markers(silhouettes[-1])) == len(boxes_of_markers(truth[-1])) == 5)
    position = places[0].pose.pose.position
    assert (position.x, position.y, position.z) == pytest.approx(
        (0.18, 0.435, -0.5196), abs=1e-4)
    camera = CameraPlace((18.0, 43.5), 51.9615)
    found = [solve([SeenOutline(
        one.corners[:, :2], one.place.covariance[:2, :2], Viewpoint(camera, np.zeros((3, 3))))],
        KnownHeight(3.0, 0.01)) for one in silhouettes_of_markers(silhouettes[-1])]
    boxes = boxes_of_markers(truth[-1])
    assert len(found) == len(boxes) == 5
    for one in found:
        assert min(math.dist(one.moments.centre, box.pose[:2]) for box in boxes) < 0.08
