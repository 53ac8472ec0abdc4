# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

import math
import time

from camera_to_base.errors import CameraToBaseError
from camera_to_base.nodes.camera_publisher import CameraPublisher
from camera_to_base.nodes.robot_base_publisher import RobotBasePublisher
import pytest
from rclpy.parameter import Parameter
from rclpy.qos import ReliabilityPolicy
from ros_helpers import BASE_TOPIC, CAMERA_TOPIC
from std_msgs.msg import Float64MultiArray

OBJECTS = '/objects_in_cam_frame'


def connect(ros, *arguments):
    node = ros.add(RobotBasePublisher, *arguments)
    received = ros.listen(BASE_TOPIC)
    publisher = ros.talk(CAMERA_TOPIC)
    assert ros.spin_until(lambda: publisher.get_subscription_count() == 1
                          and node.count_subscribers(BASE_TOPIC) == 1)
    ros.spin_for(0.2)
    return node, publisher, received


def send(publisher, *positions):
    for position in positions:
        publisher.publish(Float64MultiArray(data=position))


def test_position_is_transformed_with_the_tutorials_numbers(ros):
    _, publisher, received = connect(ros)
    send(publisher, [19.5, 13.75])
    assert ros.spin_until(lambda: received)
    assert received == [pytest.approx([19.5 - 17.8, 24.4 - 13.75])]


def test_each_message_gives_one_in_order(ros):
    _, publisher, received = connect(ros)
    for number in range(50):
        send(publisher, [float(number), 0.0])
        assert ros.spin_until(lambda: len(received) == number + 1)
    assert [x for x, _ in received] == pytest.approx([number - 17.8 for number in range(50)])


@pytest.mark.parametrize('data', [
    [], [1.0], [math.nan, 1.0], [1.0, math.inf], [-math.inf, math.nan], [1e308, 1e308],
    [1.0] * 10**6])
def test_bad_message_is_dropped_and_counted_and_the_node_lives(ros, data):
    node, publisher, received = connect(ros)
    send(publisher, data, [1.0, 1.0])
    assert ros.spin_until(lambda: received)
    ros.spin_for(0.1)
    assert len(received) == 1
    assert node.dropped_count == 1


@pytest.mark.slow
def test_bad_messages_are_said_every_5_s_at_most_with_how_many_there_were(ros, start):
    node, publisher = start('robot_base_publisher'), ros.talk(CAMERA_TOPIC)
    received, statuses = ros.listen(BASE_TOPIC), ros.listen_to_diagnostics('/robot_base_publisher')
    # Each side discovers the other by itself: only an answer tells that both have.
    assert ros.spin_until(lambda: send(publisher, [1.0, 1.0]) or received and statuses)
    begin = time.monotonic()
    for count in range(1, 201):
        send(publisher, [math.nan, 1.0])
        ros.spin_for(begin + 0.01 * count - time.monotonic())
    assert ros.spin_until(lambda: statuses[-1].values.get('dropped: no position') == '200')
    ros.spin_for(begin + 5.5 - time.monotonic())
    send(publisher, [math.nan, 1.0])
    assert ros.spin_until(lambda: statuses[-1].values['dropped: no position'] == '201')
    assert node.end() == 0
    warnings = [line for line in node.output.splitlines() if 'dropped a position' in line]
    assert len(warnings) == 2
    assert '(1 dropped so far)' in warnings[0] and '(201 dropped so far)' in warnings[1]


def test_matrix_comes_from_the_parameters(ros):
    _, publisher, received = connect(
        ros, '-p', 'rotation_deg:=[0.0, 0.0, 90.0]', '-p', 'displacement_cm:=[1.0, 2.0, 0.0]')
    send(publisher, [10.0, 0.0])
    assert ros.spin_until(lambda: received)
    assert received[0] == pytest.approx([1.0, 12.0])


def test_whole_numbers_are_accepted_where_doubles_are_declared(ros):
    _, publisher, received = connect(ros, '-p', 'displacement_cm:=[1, 2, 0]')
    send(publisher, [0.0, 0.0])
    assert ros.spin_until(lambda: received)
    assert received[0] == pytest.approx([1.0, 2.0])


def test_good_value_takes_effect_at_once(ros):
    node, publisher, received = connect(ros)
    result = node.set_parameters([Parameter('displacement_cm', value=[0, 0, 0])])[0]
    assert result.successful, result.reason
    assert node.get_parameter('displacement_cm').type_ == Parameter.Type.DOUBLE_ARRAY
    send(publisher, [3.0, 4.0])
    assert ros.spin_until(lambda: received)
    assert received[0] == pytest.approx([3.0, -4.0])


def test_bad_value_at_start_is_refused_and_nothing_of_the_node_stays(ros):
    with pytest.raises(CameraToBaseError, match='rotation_deg'):
        ros.add(RobotBasePublisher, '-p', 'rotation_deg:=.inf')
    assert ros.spin_until(lambda: 'robot_base_publisher' not in ros.node.get_node_names())


@pytest.mark.parametrize('value', [[1.0, 2.0], [math.nan, 0.0, 0.0], 'left', 3.0])
def test_bad_value_is_rejected_with_the_reason_and_changes_nothing(ros, value):
    node, publisher, received = connect(ros)
    result = node.set_parameters([Parameter('displacement_cm', value=value)])[0]
    assert not result.successful
    assert result.reason
    send(publisher, [0.0, 0.0])
    assert ros.spin_until(lambda: received)
    assert received[0] == pytest.approx([-17.8, 24.4])


def test_two_values_are_set_as_a_whole_or_not_at_all(ros):
    node, _, _ = connect(ros)
    result = node.set_parameters_atomically([
        Parameter('rotation_deg', value=[0.0, 0.0, 0.0]),
        Parameter('displacement_cm', value=[math.inf, 0.0, 0.0])])
    assert not result.successful
    assert node.get_parameter('rotation_deg').value == [180.0, 0.0, 0.0]


def test_topics_are_reliable_with_depth_10(ros):
    node, _, _ = connect(ros)
    for info in (node.get_publishers_info_by_topic(BASE_TOPIC)
                 + node.get_subscriptions_info_by_topic(CAMERA_TOPIC)):
        assert info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
    assert node.get_parameter(f'qos_overrides.{BASE_TOPIC}.publisher.depth').value == 10
    assert node.get_parameter(f'qos_overrides.{CAMERA_TOPIC}.subscription.depth').value == 10


def test_quality_of_service_is_a_parameter(ros):
    node = ros.add(RobotBasePublisher, '-p',
                   f'qos_overrides.{BASE_TOPIC}.publisher.reliability:=best_effort')
    # The nodes of earlier tests take a moment to leave the graph.
    assert ros.spin_until(lambda: node.count_publishers(BASE_TOPIC) == 1)
    info, = node.get_publishers_info_by_topic(BASE_TOPIC)
    assert info.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT


def test_namespace_and_remap_move_the_topics(ros):
    node = ros.add(RobotBasePublisher, '-r', '__ns:=/cell', '-r', 'pos_in_cam_frame:=seen')
    topics = dict(node.get_publisher_names_and_types_by_node('robot_base_publisher', '/cell'))
    assert '/cell/pos_in_robot_base_frame' in topics
    assert ros.spin_until(lambda: node.count_subscribers('/cell/seen') == 1)


@pytest.mark.slow
def test_publisher_of_a_remapped_topic_is_not_missed(ros):
    statuses = ros.listen_to_diagnostics('/robot_base_publisher')
    ros.add(RobotBasePublisher, '-r', 'pos_in_cam_frame:=seen')
    assert ros.spin_until(lambda: statuses and 'nobody publishes' in statuses[-1].message)
    ros.talk('/seen')
    assert ros.spin_until(lambda: statuses[-1].level == 0, 6.0)


@pytest.mark.slow
@pytest.mark.parametrize('topic', [CAMERA_TOPIC, f'{CAMERA_TOPIC}/point', OBJECTS])
def test_publisher_whose_quality_of_service_does_not_match_is_told_once(ros, topic):
    statuses = ros.listen_to_diagnostics('/robot_base_publisher')
    lines = ros.listen_to_log('robot_base_publisher')
    ros.add(CameraPublisher, '-p', 'source:=random', '-p',
            f'qos_overrides.{topic}.publisher.reliability:=best_effort')
    ros.add(RobotBasePublisher)
    sentence = f'cannot receive what camera_publisher publishes on {topic}: '
    assert ros.spin_until(lambda: statuses and statuses[-1].message.startswith(sentence))
    ros.spin_for(2.5)
    assert statuses[-1].level == 1 and 'qos_overrides' in statuses[-1].message
    assert len([line for line in lines if line.text.startswith(sentence)]) == 1


def test_every_parameter_is_described(ros):
    node = ros.add(RobotBasePublisher)
    for name in ('rotation_deg', 'displacement_cm', 'reach_cm'):
        assert node.describe_parameter(name).description


def test_position_beyond_the_reach_is_dropped(ros):
    node, publisher, received = connect(
        ros, '-p', 'reach_cm:=10', '-p', 'displacement_cm:=[0, 0, 0]')
    send(publisher, [6.0, 8.1], [6.0, 8.0])
    assert ros.spin_until(lambda: received)
    assert received == [pytest.approx([6.0, -8.0])]
    assert node.dropped_count == 1


def test_reach_can_be_changed_while_the_node_runs(ros):
    node, publisher, received = connect(ros)
    send(publisher, [400.0, 0.0])
    assert ros.spin_until(lambda: received)
    assert node.set_parameters([Parameter('reach_cm', value=100.0)])[0].successful
    send(publisher, [400.0, 0.0])
    assert ros.spin_until(lambda: node.dropped_count == 1)
    assert len(received) == 1


@pytest.mark.slow
def test_diagnostics_count_what_came_and_what_was_dropped_and_why(ros):
    statuses = ros.listen_to_diagnostics('/robot_base_publisher')
    _, publisher, _ = connect(ros)
    send(publisher, [1.0, 1.0], [math.nan, 1.0], [1e6, 1.0])
    assert ros.spin_until(
        lambda: statuses and statuses[-1].values.get('messages in') == '3', 3.0)
    values = statuses[-1].values
    assert values['messages out'] == values['dropped: no position'] == '1'
    assert values['dropped: out of reach'] == '1'
    assert any('dropped in the last second' in status.message for status in statuses)
    assert ros.spin_until(lambda: statuses[-1].level == 0, 3.0)
