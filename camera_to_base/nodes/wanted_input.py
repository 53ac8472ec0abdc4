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

"""A subscription that exists only while its result is wanted."""

from typing import Callable, Optional

from camera_to_base.ros import Heartbeat
from rclpy.node import Node
from rclpy.subscription import Subscription

_PERIOD_S = 1.0


class WantedInput:
    """
    Subscribes while somebody wants the result, so that the publisher has no work otherwise.

    :param node: The node that subscribes.
    :param heartbeat: Its heartbeat.
    :param is_wanted: Whether the result has a subscriber.
    :param subscribe: Makes the subscription.
    """

    def __init__(
        self, node: Node, heartbeat: Heartbeat, is_wanted: Callable[[], bool],
        subscribe: Callable[[], Subscription],
    ) -> None:
        self._node, self._is_wanted, self._subscribe = node, is_wanted, subscribe
        self._subscription: Optional[Subscription] = None
        heartbeat.every(_PERIOD_S, self._check)

    def _check(self) -> None:
        if self._is_wanted() and self._subscription is None:
            self._subscription = self._subscribe()
        elif not self._is_wanted() and self._subscription is not None:
            self._node.destroy_subscription(self._subscription)
            self._subscription = None
