# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""The simulated cell as a person at a running node has it: scenes, touches, bumps."""

import math

from camera_to_base.coordinate_transform import CameraToRobotBaseConversion
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.ros import boxes_of_markers
from geometry_msgs.msg import PoseArray, PoseStamped
import pytest
from rclpy.parameter import Parameter
from ros_helpers import OBJECTS_TOPIC, SIMULATED_CELL
from visualization_msgs.msg import MarkerArray

TOOL_TOPIC = '/simulated_tool'
TRUE_OBJECTS_TOPIC = '/true_objects_in_cam_frame'


def start(ros, *parameters):
    arguments = [word for parameter in ('source:=simulated', 'simulated.frame_rate:=30.0',
                                        *parameters) for word in ('-p', parameter)]
    return ros.add(CameraPublisher, *SIMULATED_CELL, *arguments)


def change(node, **values):
    result, = {result.successful for result in node.set_parameters(
        [Parameter(f'simulated.{name}', value=value) for name, value in values.items()])}
    assert result


def points(message):
    """Give the points of a PoseArray, in cm."""
    return [(100 * pose.position.x, 100 * pose.position.y) for pose in message.poses]


def next_of(ros, received):
    """Give the message after the next one, which shows what was changed before."""
    count = len(received)
    assert ros.spin_until(lambda: len(received) >= count + 3)
    return received[-1]


def test_five_still_objects_are_published_where_they_are(ros):
    found, true = ros.listen_to(PoseArray, OBJECTS_TOPIC), ros.listen_to(
        PoseArray, TRUE_OBJECTS_TOPIC)
    start(ros, 'simulated.shows:=still_objects')
    assert ros.spin_until(lambda: found and len(found[-1].poses) == 5 and len(true) > 2)
    for point in points(found[-1]):
        assert min(math.dist(point, other) for other in points(true[-1])) < 0.02


@pytest.mark.slow
def test_robot_touches_the_objects_in_the_order_in_which_they_are_published(ros):
    found, tool = ros.listen_to(PoseArray, OBJECTS_TOPIC), ros.listen_to(PoseStamped, TOOL_TOPIC)
    node = start(ros, 'simulated.shows:=still_objects')
    assert ros.spin_until(lambda: found and len(found[-1].poses) == 5)
    assert tool == []
    conversion = CameraToRobotBaseConversion(180.0, -17.8, 24.4, 0.0)
    errors = []
    for number, point in enumerate(points(found[-1]), start=1):
        change(node, touched=number)
        pose = next_of(ros, tool)
        assert pose.header.frame_id == 'base_link'
        assert next_of(ros, tool).pose == pose.pose, 'the tool stands still'
        x, y, _ = conversion.convert_point(*point)
        errors.append(math.dist((x, y), (100 * pose.pose.position.x, 100 * pose.pose.position.y)))
    assert 0.005 < max(errors) < 0.15
    change(node, touched=0)
    ros.spin_for(0.2)
    count = len(tool)
    ros.spin_for(0.3)
    assert len(tool) == count


@pytest.mark.slow
def test_bump_is_told_and_makes_no_wrong_position(ros):
    found, true = ros.listen_to(PoseArray, OBJECTS_TOPIC), ros.listen_to(
        PoseArray, TRUE_OBJECTS_TOPIC)
    status = ros.listen_to_diagnostics('/camera_publisher')
    node = start(ros, 'simulated.table:=wood', 'simulated.shows:=still_objects')
    assert ros.spin_until(lambda: found and len(found[-1].poses) == 5)
    there = points(next_of(ros, true))
    assert ros.spin_until(lambda: status and status[-1].values['reason'] == 'ok')
    response = ros.call('/camera_publisher/bump_camera')
    assert response.success and ' mm on the table' in response.message
    assert node.get_parameter('simulated.camera_shift_px').value != [0.0, 0.0]
    assert points(next_of(ros, true)) == there
    assert ros.spin_until(lambda: status[-1].values['reason'] != 'ok')
    change(node, camera_shift_px=[0.0, 0.0], camera_turn_deg=0.0, camera_tilt_deg=[0.0, 0.0],
           camera_zoom=1.0)
    assert ros.spin_until(lambda: status[-1].values['reason'] == 'ok' and found[-1].poses)
    assert max(min(math.dist(point, other) for other in there)
               for message in found for point in points(message)) < 0.1


def test_true_boxes_are_those_of_the_objects_that_were_not_taken(ros):
    boxes = ros.listen_to(MarkerArray, f'{TRUE_OBJECTS_TOPIC}/boxes')
    node = start(ros, 'simulated.shows:=still_objects', 'simulated.shapes:=[box]',
                 'simulated.heights_cm:=[2.0, 4.0]', 'simulated.elongation:=1.5')
    assert ros.spin_until(lambda: boxes and len(boxes[-1].markers) == 6)
    first, second = boxes_of_markers(boxes[-1])[:2]
    assert first.pose == pytest.approx((18.0, 13.5, -1.0, 0.0), abs=1e-6)
    assert first[1:] == pytest.approx((3.0, 2.0, 2.0))
    assert second.height == pytest.approx(4.0)
    assert second.pose.yaw == pytest.approx(math.radians(50))
    change(node, taken=[1, 5])
    left = boxes_of_markers(next_of(ros, boxes))
    assert [box.length for box in left] == pytest.approx([2.8, 2.6, 2.4])


def test_each_bump_is_another_one(ros):
    start(ros)
    messages = {ros.call('/camera_publisher/bump_camera').message for _ in range(3)}
    assert len(messages) == 3


@pytest.mark.parametrize('shows, count', [('empty', 0), ('board', 0)])
def test_scene_changes_while_the_node_runs(ros, shows, count):
    true = ros.listen_to(PoseArray, TRUE_OBJECTS_TOPIC)
    node = start(ros)
    assert ros.spin_until(lambda: true and len(true[-1].poses) == 1)
    change(node, shows=shows)
    assert len(next_of(ros, true).poses) == count
    change(node, shows='objects')
    assert len(next_of(ros, true).poses) == 1


def test_tilt_that_reaches_the_horizon_is_refused_and_nothing_changes(ros):
    found = ros.listen_to(PoseArray, OBJECTS_TOPIC)
    node = start(ros, 'simulated.tilt_deg:=60.0')
    result, = node.set_parameters([Parameter('simulated.camera_tilt_deg', value=[25.0, 0.0])])
    assert not result.successful and 'horizon' in result.reason
    assert node.get_parameter('simulated.camera_tilt_deg').value == [0.0, 0.0]
    assert next_of(ros, found) is not None
