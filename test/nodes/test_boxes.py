# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.
"""Boxes around objects, in both frames."""

import math
import types

from camera_to_base.coordinate_transform import Pose
from camera_to_base.errors import InvalidValueError
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
from camera_to_base.ros import boxes, boxes_of_markers, SolidBox
from geometry_msgs.msg import PoseArray
import pytest
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

CAMERA_BOXES = '/objects_in_cam_frame/boxes'
BASE_BOXES = '/objects_in_robot_base_frame/boxes'
BOX = SolidBox(Pose(3.0, 4.0, -1.0, 0.3), 5.0, 3.0, 2.0)


def test_box_comes_back_as_it_was_sent():
    message = boxes.box_markers(Header(frame_id='a'), [BOX, BOX._replace(height=0.0)])
    assert message.markers[0].action == Marker.DELETEALL
    assert [(one.id, one.text, one.type) for one in message.markers[1:]] == [
        (1, '1', Marker.CUBE), (2, '2', Marker.CUBE)]
    first, flat = boxes_of_markers(message)
    assert first.pose == pytest.approx(BOX.pose) and first[1:] == pytest.approx(BOX[1:])
    assert flat.height == pytest.approx(0.1)  # RViz refuses a cube without an extent.


@pytest.mark.parametrize('side', [math.nan, math.inf, -1.0])
def test_box_without_a_size_is_refused(side):
    message = boxes.box_markers(Header(), [BOX])
    message.markers[1].scale.x = side
    with pytest.raises(InvalidValueError, match='finite sides'):
        boxes_of_markers(message)


def test_box_stands_on_the_surface_in_the_base_frame(ros):
    received = ros.listen_to(MarkerArray, BASE_BOXES)
    talker = ros.node.create_publisher(MarkerArray, CAMERA_BOXES, 10)
    node = ros.add(RobotBasePublisher, '-p', 'rotation_deg:=[180.0, 0.0, 0.0]',
                   '-p', 'displacement_cm:=[10.0, 20.0, 0.0]', '-p', 'reach_cm:=30.0')
    far = BOX._replace(pose=BOX.pose._replace(x=90.0))
    message = boxes.box_markers(Header(frame_id='camera_surface'), [far, BOX])
    assert ros.spin_until(lambda: talker.get_subscription_count() and ros.hears(BASE_BOXES))
    assert ros.spin_until(lambda: (talker.publish(message), received)[1])
    found, = boxes_of_markers(received[0])
    assert received[0].markers[0].header.frame_id == 'base_link'
    assert found.pose == pytest.approx((13.0, 16.0, 1.0, -0.3))
    assert found[1:] == pytest.approx((5.0, 3.0, 2.0))
    assert node.dropped_count > 0


def test_boxes_of_a_frame_are_in_the_order_of_its_objects(ros):
    arrays, markers = (ros.listen_to(PoseArray, '/objects_in_robot_base_frame'),
                       ros.listen_to(MarkerArray, BASE_BOXES))
    ros.add(RobotBasePublisher)
    ros.add(CameraPublisher, '-p', 'source:=simulated', '-p', 'simulated.diameters_cm:=[2.4, 1.8]')
    by_stamp = {}

    def pair():
        for one in arrays:
            by_stamp[one.header.stamp.sec, one.header.stamp.nanosec] = one
        for one in markers:
            stamp = one.markers[0].header.stamp
            if len(one.markers) == 3 and (stamp.sec, stamp.nanosec) in by_stamp:
                return by_stamp[stamp.sec, stamp.nanosec], boxes_of_markers(one)
        return None

    assert ros.spin_until(lambda: pair() is not None)
    array, found = pair()
    for pose, box in zip(array.poses, found):
        assert (box.pose.x, box.pose.y) == pytest.approx(
            (100 * pose.position.x, 100 * pose.position.y), abs=1e-6)
    assert [box.length for box in found] == pytest.approx([2.4, 1.8], abs=0.1)


def test_the_same_boxes_are_detections_where_vision_msgs_is_installed(monkeypatch):
    def record(name):
        return type(name, (), {'__init__': lambda self, **fields: self.__dict__.update(fields)})

    monkeypatch.setattr(boxes, 'vision_msgs', types.SimpleNamespace(**{
        name: record(name) for name in ('Detection3DArray', 'Detection3D', 'BoundingBox3D')}))
    assert boxes.detection_type() is boxes.vision_msgs.Detection3DArray
    found, = boxes.detections_message(Header(frame_id='a'), [BOX]).detections
    assert found.id == '1' and found.header.frame_id == 'a'
    assert found.bbox.center.position.x == pytest.approx(0.03)
    assert (found.bbox.size.x, found.bbox.size.z) == pytest.approx((0.05, 0.02))
