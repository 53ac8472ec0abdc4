# Copyright 2026 The camera_to_base authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0
# Unless required by applicable law or agreed to in writing, software distributed under the License
# is distributed on an "AS IS" BASIS, WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express
# or implied. See the License for the specific language governing permissions and limitations under
# the License.

"""Receives a camera driver's pictures from a topic, and uses the newest one."""

import math
import time
from typing import Any, Callable, Dict, Optional, Union

from builtin_interfaces.msg import Time
from camera_to_base.errors import (
    FrameSourceError, InvalidValueError, Level, Reason, TopicTypeError)
from camera_to_base.settings import CameraSettings
from camera_to_base.sources import (
    frame_from_compressed_message, frame_from_image_message, LOST_AFTER_S, ReaderFacts,
    ReaderState, ReaderStatus, SilenceLimit, source_reason, stamp_reason)
import numpy as np
from rclpy.event_handler import QoSRequestedIncompatibleQoSInfo, SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import qos_policy_name_from_kind, QoSPolicyKind, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription
from sensor_msgs.msg import CompressedImage, Image

# A raw picture of this size comes in thousands of packets, which a busy machine drops.
_LARGE_BYTES = 4_000_000


class ImageTopic(ReaderStatus):
    """
    Converts the pictures on the topic `image` or `image/compressed` to frames.

    A picture that cannot be used is logged, counted and skipped. The subscription is reliable if
    the driver is, unless the parameters `qos_overrides` choose.

    :param node: The node that subscribes and logs.
    :param on_frame: Called with each good frame, shape (h, w, 3), uint8, BGR; its capture time
        according to the stamp, in s of time.monotonic(); and the stamp.
    :param damage: Returns why a frame is damaged, or None if it is not.
    :param compressed: Subscribe to `image/compressed`.
    :param max_age_s: Greatest age of a picture on arrival, according to its stamp.
    """

    def __init__(
        self,
        node: Node,
        on_frame: Callable[[np.ndarray, float, Time], None],
        damage: Callable[[np.ndarray], Optional[Reason]] = lambda frame: None,
        compressed: bool = False,
        max_age_s: float = math.inf,
    ) -> None:
        super().__init__()
        self._node = node
        self._on_frame = on_frame
        self._damage = damage
        self._max_age_s = max_age_s
        self._decode = frame_from_compressed_message if compressed else frame_from_image_message
        self._silence_limit = SilenceLimit()
        self._refused_at = -LOST_AFTER_S
        self._mismatch: Optional[FrameSourceError] = None
        self._last_number: Optional[int] = None
        self._last_bytes = 0
        self._message_type = CompressedImage if compressed else Image
        self._topic = 'image/compressed' if compressed else 'image'
        # A large picture comes in many packets: on a busy machine most pictures are lost unless
        # both ends are reliable.
        self._subscription = self._subscribe(
            ReliabilityPolicy.BEST_AVAILABLE, QoSOverridingOptions([QoSPolicyKind.RELIABILITY]))
        self.topic_name: str = self._subscription.topic_name
        self.name = self.topic_name
        reliability = node.get_parameter(f'{self._override_name}.reliability').value
        self._may_change = reliability == ReliabilityPolicy.BEST_AVAILABLE.name.lower()

    @property
    def reader(self) -> ReaderStatus:
        """The camera's status, which is this object itself."""
        return self

    @property
    def reason(self) -> Optional[Reason]:
        """Why no good frame arrives; None if one does."""
        return source_reason(self, self.name)

    @property
    def longest_silence_s(self) -> float:
        """See :class:`ReaderStatus`; a driver may publish less than one picture a second."""
        return self._silence_limit.seconds

    def configure(self, settings: CameraSettings) -> None:
        """Use the new limit of the age; the driver has its own settings."""
        self._max_age_s = settings.limits.max_frame_age_s

    def close(self) -> None:
        """Unsubscribe from the topic."""
        self._node.destroy_subscription(self._subscription)

    @property
    def _override_name(self) -> str:
        return f'qos_overrides.{self.topic_name}.subscription'

    def _subscribe(
        self, reliability: ReliabilityPolicy, options: Optional[QoSOverridingOptions] = None
    ) -> Subscription:
        # Depth 1: only the newest picture is of use.
        return self._node.create_subscription(
            self._message_type, self._topic, self._on_message,
            QoSProfile(depth=1, reliability=reliability),
            event_callbacks=SubscriptionEventCallbacks(incompatible_qos=self._on_mismatch),
            qos_overriding_options=options)

    def _on_message(self, message: Union[Image, CompressedImage], info: Dict[str, Any]) -> None:
        arrived_at = _arrived_at(info)
        self._last_bytes = len(message.data)
        self._count_replaced(info)
        try:
            frame = self._decode(message)
        except InvalidValueError as error:
            self._refuse(error)
            return
        self._count(reconnects=self.state is ReaderState.LOST)
        self._note_frame(arrived_at)
        self._silence_limit.note(arrived_at)
        stamp = message.header.stamp
        age_ns = self._age_ns(stamp, arrived_at)
        damage = self._damage(frame) or self._stamp_reason(stamp, age_ns)
        self._note_damage(damage)
        if damage is None:
            self._on_frame(frame, arrived_at - max(0, age_ns) / 1e9, stamp)

    def _error_of(self, facts: ReaderFacts, silent_s: float) -> Optional[FrameSourceError]:
        # None while frames arrive.
        if silent_s <= self.longest_silence_s:
            return None
        refused_lately = time.monotonic() - self._refused_at <= LOST_AFTER_S
        return facts.error if refused_lately else self._cause_of_silence()

    def _age_ns(self, stamp: Time, arrived_at: float) -> int:
        # The stamp has the node's clock, which may be a simulation's; the wait is real time.
        waited_ns = int((time.monotonic() - arrived_at) * 1e9)
        return self._node.get_clock().now().nanoseconds - waited_ns - _nanoseconds(stamp)

    def _stamp_reason(self, stamp: Time, age_ns: int) -> Optional[Reason]:
        stamp_ns = _nanoseconds(stamp)
        return stamp_reason(stamp_ns, stamp_ns + age_ns, self._max_age_s)

    def _count_replaced(self, info: Dict[str, Any]) -> None:
        # Some middleware does not number messages; each publisher starts its own numbers.
        number, last = info.get('publication_sequence_number'), self._last_number
        if number is not None and last is not None and number > last:
            self._count(overwritten=number - last - 1)
        self._last_number = number

    def _refuse(self, error: InvalidValueError) -> None:
        self._note_damage(Reason('not_decoded', Level.ERROR, str(error), is_passing=True))
        self._refused_at = time.monotonic()
        error = FrameSourceError(f'cannot use the picture on {self.topic_name}: {error}')
        self._note_error(error)
        self._node.get_logger().error(str(error), throttle_duration_sec=5.0)

    def _on_mismatch(self, event: QoSRequestedIncompatibleQoSInfo) -> None:
        if self._may_change and event.last_policy_kind == QoSPolicyKind.RELIABILITY:
            # The driver is not reliable, and came after this subscription.
            self._may_change = False
            self._node.destroy_subscription(self._subscription)
            self._subscription = self._subscribe(ReliabilityPolicy.BEST_EFFORT)
            return
        policy = qos_policy_name_from_kind(event.last_policy_kind).lower()
        self._mismatch = FrameSourceError(
            f'cannot receive what is published on {self.topic_name}: its {policy} does not match; '
            f'set the parameter {self._override_name}.{policy} as the '
            f"publisher has it, see 'ros2 topic info -v {self.topic_name}'")
        self._node.get_logger().error(str(self._mismatch))

    def _cause_of_silence(self) -> FrameSourceError:
        silence = f'no picture on {self.topic_name}'
        if self._subscription.get_publisher_count() and self._last_bytes > _LARGE_BYTES:
            return FrameSourceError(
                f'{silence}, though a camera driver publishes there: raw pictures of '
                f'{self._last_bytes / 1e6:.0f} MB are lost on the way; use compressed_topic, or a '
                'smaller picture')
        if self._subscription.get_publisher_count():
            are_raw = self._subscription.msg_type is Image
            return FrameSourceError(
                f'{silence}, though a camera driver publishes there: is its camera plugged in?'
                + (' If it is, its pictures are too large to arrive raw: use compressed_topic'
                   if are_raw else ''))
        wanted = f'sensor_msgs/msg/{self._subscription.msg_type.__name__}'
        types = {info.topic_type
                 for info in self._node.get_publishers_info_by_topic(self.topic_name)}
        if types - {wanted}:
            return TopicTypeError(
                f'{silence}: it carries {", ".join(sorted(types))}, not {wanted}; choose the '
                'source that fits, topic or compressed_topic')
        if types and self._mismatch is not None:
            return self._mismatch
        return FrameSourceError(f'{silence}: is the camera driver running?')


def _nanoseconds(stamp: Time) -> int:
    return stamp.sec * 10**9 + stamp.nanosec


def _arrived_at(info: Dict[str, Any]) -> float:
    # A picture waits in the queue while the node is busy. Some middleware does not give its
    # arrival time.
    now = time.time_ns()
    waited_ns = max(0, now - (info.get('received_timestamp') or now))
    return time.monotonic() - waited_ns / 1e9
