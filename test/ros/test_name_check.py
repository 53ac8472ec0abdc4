# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

from camera_to_base.ros.diagnostics import NameCheck
import pytest
import rclpy


class RecordedHeartbeat:
    """Keeps the task instead of calling it."""

    def every(self, period_s, task):
        self.task = task


@pytest.fixture
def twin(ros):
    """Give a node, and a function that makes another one of the same name."""
    nodes = []

    def make():
        nodes.append(rclpy.create_node('twin', context=ros.context))
        return nodes[-1]

    yield make
    for node in nodes:
        node.destroy_node()


def warnings_of(ros):
    lines = ros.listen_to_log('twin')
    return lambda: [line.text for line in lines if 'another /twin is running' in line.text]


def test_second_node_of_the_same_name_is_told_once(ros, twin):
    node, heartbeat, warnings = twin(), RecordedHeartbeat(), warnings_of(ros)
    NameCheck(node, heartbeat)
    twin()
    own = node.get_name(), node.get_namespace()
    assert ros.spin_until(lambda: node.get_node_names_and_namespaces().count(own) == 2)
    heartbeat.task()
    assert ros.spin_until(warnings)
    heartbeat.task()
    ros.spin_for(0.2)
    assert len(warnings()) == 1 and '__ns:=' in warnings()[0]


def test_node_whose_name_is_its_own_is_told_nothing(ros, twin):
    node, heartbeat, warnings = twin(), RecordedHeartbeat(), warnings_of(ros)
    NameCheck(node, heartbeat)
    heartbeat.task()
    node.get_logger().warning('another /twin is running, says the test')
    assert ros.spin_until(warnings)
    assert warnings() == ['another /twin is running, says the test']
