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

"""Node: applies the homogeneous matrix to each position that the camera node publishes."""

from collections import Counter
import math
from typing import List, Optional

from camera_to_base.diagnostics import Diagnostics
from camera_to_base.errors import CameraToBaseError
from camera_to_base.health import Health, Level
from camera_to_base.lifetime import run
from camera_to_base.messages import position_from_message, position_message
from camera_to_base.parameters import NodeParameters
from camera_to_base.transform_parameters import transform_node_settings, TRANSFORM_SPECS
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import Float64MultiArray

# A node that finds its name taken within this time is the second one; later, it is the first.
_NAME_CHECKS, _NAME_CHECK_PERIOD_S = 5, 1.0


class RobotBasePublisher(Node):
    """Subscribes to positions in the camera frame, publishes them in the base frame."""

    def __init__(self, **node_options) -> None:
        super().__init__('robot_base_publisher', **node_options)
        self._node_parameters = NodeParameters(self, TRANSFORM_SPECS, transform_node_settings)
        self._published_count = 0
        self._dropped: Counter = Counter()
        self._dropped_before = 0
        self._publisher = self.create_publisher(
            Float64MultiArray, 'pos_in_robot_base_frame', 10,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        subscription = self.create_subscription(
            Float64MultiArray, 'pos_in_cam_frame', self._on_position, 10,
            qos_overriding_options=QoSOverridingOptions.with_default_policies())
        self.get_logger().info(
            f'publishing on {self._publisher.topic_name} what comes on {subscription.topic_name}')
        Diagnostics(self, self._health)
        self._name_checks = 0
        self._name_timer = self.create_timer(
            _NAME_CHECK_PERIOD_S, self._on_name_timer,
            clock=Clock(clock_type=ClockType.STEADY_TIME))

    @property
    def dropped_count(self) -> int:
        """How many messages were no position, or one out of reach, and were dropped."""
        return sum(self._dropped.values())

    def _on_position(self, message: Float64MultiArray) -> None:
        settings = self._node_parameters.current
        try:
            x, y = position_from_message(message)
            base_x, base_y, _ = settings.conversion.convert_surface_point(x, y)
        except CameraToBaseError as error:
            self._drop('no position', error)
            return
        if math.hypot(base_x, base_y) > settings.reach_cm:
            self._drop('out of reach', f'({base_x:g}, {base_y:g}) cm in the base frame is beyond '
                       f'reach_cm, {settings.reach_cm:g} cm')
            return
        self._publisher.publish(position_message(base_x, base_y))
        self._published_count += 1

    def _drop(self, reason: str, why: object) -> None:
        self._dropped[reason] += 1
        self.get_logger().warning(
            f'dropped a message on the topic pos_in_cam_frame: {why} '
            f'({self.dropped_count} dropped so far)', throttle_duration_sec=5.0)

    def _on_name_timer(self) -> None:
        self._name_checks += 1
        taken = self._is_name_taken()
        if taken:
            self.get_logger().warning(
                f'another {self.get_fully_qualified_name()} is running: every position is '
                'published twice; end one, or give one a namespace (-r __ns:=/cell_2)')
        if taken or self._name_checks == _NAME_CHECKS:
            self.destroy_timer(self._name_timer)

    def _is_name_taken(self) -> bool:
        own = self.get_name(), self.get_namespace()
        return self.get_node_names_and_namespaces().count(own) > 1

    def _health(self) -> Health:
        values = {'source': self.resolve_topic_name('pos_in_cam_frame'),
                  'messages in': str(self._published_count + self.dropped_count),
                  'messages out': str(self._published_count)}
        values.update((f'dropped: {reason}', str(count))
                      for reason, count in sorted(self._dropped.items()))
        newly, self._dropped_before = (
            self.dropped_count - self._dropped_before, self.dropped_count)
        if newly:
            return Health(Level.WARN, (
                f'{newly} message(s) dropped in the last second: see who else publishes on '
                'pos_in_cam_frame, and check reach_cm'), values)
        if not self.count_publishers('pos_in_cam_frame'):
            return Health(Level.WARN, 'nobody publishes positions: start camera_publisher', values)
        return Health(Level.OK, 'positions are transformed', values)


def main(args: Optional[List[str]] = None) -> int:
    """Run the node until it is told to end."""
    return run('robot_base_publisher', RobotBasePublisher, args)
