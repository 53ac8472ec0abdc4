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

"""Publishes a node's health on /diagnostics: once a second, and at once when it changes."""

from typing import Callable

from camera_to_base.ros.health import Health
from camera_to_base.ros.heartbeat import Heartbeat
from camera_to_base.ros.position_topics import NO_EVENTS
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

_PERIOD_S = 1.0


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
        heartbeat.every(_PERIOD_S, self.publish)

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
