# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""A node's health on /diagnostics, its timer, and warnings of equal names and of QoS."""

import time
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from camera_to_base.errors import Reason
from camera_to_base.ros.position_topics import NO_EVENTS
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility
from rclpy.subscription import Subscription
from rclpy.timer import Timer

_HEARTBEAT_S = 0.2

_REPORT_PERIOD_S = 1.0

# Of two nodes with one name, the younger one warns: it finds the name taken within this time.
_LONGEST_S, _NAME_CHECK_PERIOD_S = 5.0, 1.0


class Health(NamedTuple):
    """The state of a node: why it publishes nothing or that all is well, and numbers as text."""

    reason: Reason
    values: Dict[str, str]


def real_time_timer(node: Node, period_s: float, callback: Callable[[], None]) -> Timer:
    """Make a timer that runs on the steady clock, also where `use_sim_time` is true."""
    return node.create_timer(period_s, callback, clock=Clock(clock_type=ClockType.STEADY_TIME))


class Heartbeat:
    """
    Calls periodic tasks on the steady clock, from one timer.

    The executor checks every timer for every message, so each further timer slows all messages.
    The heartbeat also wakes the executor; without it, a signal takes effect with the next message
    only.
    """

    def __init__(self, node: Node) -> None:
        self._tasks: List[Tuple[int, Callable[[], None]]] = []
        self._count = 0
        real_time_timer(node, _HEARTBEAT_S, self._beat)

    def every(self, period_s: float, task: Callable[[], None]) -> None:
        """Call a task with a period that is rounded to a multiple of 0.2 s."""
        self._tasks.append((max(1, round(period_s / _HEARTBEAT_S)), task))

    def _beat(self) -> None:
        self._count += 1
        for beats, task in self._tasks:
            if self._count % beats == 0:
                task()


class Diagnostics:
    """
    Publishes the health that a function returns, with its reason's kind as the value `reason`.

    :param node: The node; the status has its full name.
    :param heartbeat: The node's timer.
    :param collect: Called for each message.
    """

    def __init__(
        self, node: Node, heartbeat: Heartbeat, collect: Callable[[], Health]
    ) -> None:
        self._node = node
        self._collect = collect
        self._publisher = node.create_publisher(
            DiagnosticArray, '/diagnostics', 10, event_callbacks=NO_EVENTS)
        heartbeat.every(_REPORT_PERIOD_S, self.publish)

    def publish(self) -> None:
        """Publish at once."""
        health = self._collect()
        values = {'reason': health.reason.kind, **health.values}
        message = DiagnosticArray(status=[DiagnosticStatus(
            level=bytes([health.reason.level]),
            name=self._node.get_fully_qualified_name(),
            message=health.reason.sentence,
            hardware_id=health.values.get('source', ''),
            values=[KeyValue(key=key, value=value) for key, value in values.items()])])
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)


class NameCheck:
    """
    Warns once, in the first seconds of a node, that another node has its name.

    :param node: The node that warns.
    :param heartbeat: Its heartbeat.
    """

    def __init__(self, node: Node, heartbeat: Heartbeat) -> None:
        self._node = node
        self._until = time.monotonic() + _LONGEST_S
        heartbeat.every(_NAME_CHECK_PERIOD_S, self._check)

    def _check(self) -> None:
        if time.monotonic() <= self._until and self._is_name_taken():
            self._until = 0.0
            self._node.get_logger().warning(
                f'another {self._node.get_fully_qualified_name()} is running: every position is '
                'published twice; end one, or give one a namespace (-r __ns:=/cell_2)')

    def _is_name_taken(self) -> bool:
        own = self._node.get_name(), self._node.get_namespace()
        return self._node.get_node_names_and_namespaces().count(own) > 1


def qos_mismatch(node: Node, subscriptions: Sequence[Subscription]) -> Optional[str]:
    """
    Find a publisher whose quality of service does not match a subscription.

    rclpy's own event for this slows every message of the subscription; a look at the graph does
    not.

    :returns: A sentence about the first mismatch, or None.
    """
    for subscription in subscriptions:
        topic = subscription.topic_name
        for publisher in node.get_publishers_info_by_topic(topic):
            found, _ = qos_check_compatible(publisher.qos_profile, subscription.qos_profile)
            if found == QoSCompatibility.ERROR:
                return (f'cannot receive what {publisher.node_name} publishes on {topic}: set '
                        f'the parameters qos_overrides.{topic}.subscription as the publisher has '
                        f"it, see 'ros2 topic info -v {topic}'")
    return None
